"""The notations of a rotation in space: a unit quaternion, or an axis and an angle."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import AfterValidator, Field, PlainValidator, WithJsonSchema

from derive.spec.parsing import values
from derive.spec.tables.shared import Example, TomlTable, components, number_schema, plain_or_table

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


Float = Annotated[float, PlainValidator(values.any_float), WithJsonSchema(number_schema())]
Triple = Annotated[tuple[Float, Float, Float], components(("0", "0", "1"), "numbers")]
Quaternion = Annotated[
    tuple[Float, Float, Float, Float], components(("1", "0", "0", "0"), "numbers"), AfterValidator(_unit_quaternion)
]


class RotationTable(TomlTable):
    """A rotation by an angle about an axis."""

    axis: Annotated[
        Triple,
        AfterValidator(_direction),
        Field(description="Direction of the axis, of any length but zero."),
        Example("axis = [0, 0, 1]"),
    ]
    angle: Annotated[Float, Field(description="Rotation angle, rad."), Example("angle = 0.5")]

    def quaternion(self) -> tuple[float, ...]:
        """The unit quaternion, scalar first."""
        length, half = math.hypot(*self.axis), self.angle / 2
        return (math.cos(half), *(math.sin(half) * x / length for x in self.axis))


Rotation = plain_or_table(Quaternion, Annotated[RotationTable, AfterValidator(RotationTable.quaternion)])
