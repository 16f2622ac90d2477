"""The tables of the initial state of a body in space as pydantic models."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag

from derive.spec.model.simulation import SpatialStart
from derive.spec.parsing import values
from derive.spec.tables.markers import Float
from derive.spec.tables.shared import TomlTable, components, few

UNIT_LENGTH = 1e-3
"""The largest departure of the length of a quaternion from 1 that counts as rounding; the quaternion is normalised."""


def _unit_quaternion(value: tuple[float, ...]) -> tuple[float, ...]:
    length = math.hypot(*value)
    if not abs(length - 1.0) <= UNIT_LENGTH:
        raise values.WrongValueError(
            f"a unit quaternion is needed, and the length of this one is {length:.6g}; divide it by that, or write "
            "{ axis = [0, 0, 1], angle = 0.5 }"
        )
    return value


def _direction(value: tuple[float, ...]) -> tuple[float, ...]:
    if not any(value):
        raise values.WrongValueError("[0, 0, 0] is no direction; write one such as [0, 0, 1]")
    return value


Triple = Annotated[tuple[Float, Float, Float], components(("0", "0", "1"), "numbers")]
Quaternion = Annotated[
    tuple[Float, Float, Float, Float], components(("1", "0", "0", "0"), "numbers"), AfterValidator(_unit_quaternion)
]


def _few_amplitudes(value: object) -> object:
    if not isinstance(value, (list, tuple)):
        raise values.WrongValueError(f"a list of numbers is needed, such as [1e-3, 0], not {values.kind_of(value)}")
    few(len(value), 0, values.MAX_MODES, "amplitudes")
    return tuple(value)


Amplitudes = Annotated[
    tuple[Float, ...],
    BeforeValidator(_few_amplitudes),
    Field(json_schema_extra={"maxItems": values.MAX_MODES}),
]


class RotationTable(TomlTable):
    """A rotation by an angle about an axis."""

    axis: Annotated[
        Triple, AfterValidator(_direction), Field(description="Direction of the axis, of any length but zero.")
    ]
    angle: Annotated[Float, Field(description="Rotation angle, rad.")]

    def quaternion(self) -> tuple[float, ...]:
        """The unit quaternion, scalar first."""
        length, half = math.hypot(*self.axis), self.angle / 2
        return (math.cos(half), *(math.sin(half) * x / length for x in self.axis))


def _written_as(value: Any) -> str:
    return "table" if isinstance(value, Mapping) else "plain"


class SpatialStartTable(TomlTable):
    """The initial state of a body in space."""

    position: Annotated[
        Triple, Field(description="Position of the origin of the floating frame in the inertial frame, m.")
    ] = (0.0, 0.0, 0.0)
    rotation: Annotated[
        Annotated[Quaternion, Tag("plain")] | Annotated[RotationTable, Tag("table")],
        Discriminator(_written_as),
        Field(
            description="Rotation of the floating frame: a unit quaternion, scalar first, or an axis and an angle.",
            json_schema_extra={"default": [1, 0, 0, 0]},
        ),
    ] = (1.0, 0.0, 0.0, 0.0)
    velocity: Annotated[Triple, Field(description="Velocity of the origin in the inertial frame, m/s.")] = (
        0.0,
        0.0,
        0.0,
    )
    angular_velocity: Annotated[Triple, Field(description="Angular velocity in the floating frame, rad/s.")] = (
        0.0,
        0.0,
        0.0,
    )
    amplitudes: Annotated[
        Amplitudes, Field(description="Amplitudes of the first modes, m; those of the others are zero.")
    ] = ()
    amplitude_rates: Annotated[
        Amplitudes, Field(description="Rates of the amplitudes of the first modes, m/s; the others are zero.")
    ] = ()

    def start(self) -> SpatialStart:
        """The initial state that the table describes. Raises WrongValueError."""
        rotation = self.rotation
        quaternion = rotation.quaternion() if isinstance(rotation, RotationTable) else _unit_quaternion(tuple(rotation))
        return SpatialStart(
            self.position, quaternion, self.velocity, self.angular_velocity, self.amplitudes, self.amplitude_rates
        )
