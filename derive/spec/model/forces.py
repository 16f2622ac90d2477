"""Forces, torques, springs and bushings of a scene as frozen data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Annotated, ClassVar, Literal

from derive.spec.model.keys import KeyType, key
from derive.spec.model.markers import MarkerRef
from derive.spec.model.quantity import Quantity
from derive.spec.model.time_function import TimeFunction

ForceFrame = Literal["inertial", "body"]

BETWEEN = key(
    KeyType.MARKER_PAIR,
    'Two markers, such as ["ground.bearing", "crank.hub"].',
    name="between",
    example='["ground.bearing", "crank.hub"]',
)
"""The markers of a joint, and of a spring."""


@dataclass(frozen=True)
class Force:
    """A force at a marker."""

    name: str
    at: Annotated[
        MarkerRef, key(KeyType.MARKER, 'Marker at which it acts, such as "rod.right".', example='"rod.right"')
    ]
    components: Annotated[
        tuple[TimeFunction, TimeFunction],
        key(
            KeyType.FUNCTION_PAIR,
            "Components in the frame of the force, N: numbers, or functions of t.",
            "N",
            example="[0, -10]",
        ),
    ]
    frame: Annotated[
        ForceFrame,
        key(
            KeyType.CHOICE,
            "The frame of the components: inertial, or body, which rotates with the section of the body at the marker, "
            "so that the force follows the body.",
        ),
    ] = "inertial"
    kind: ClassVar[str] = "force"

    @property
    def markers(self) -> tuple[MarkerRef]:
        """The marker at which the force acts."""
        return (self.at,)


@dataclass(frozen=True)
class Torque:
    """A torque at a marker."""

    name: str
    at: Annotated[
        MarkerRef, key(KeyType.MARKER, 'Marker at which it acts, such as "crank.hub".', example='"crank.hub"')
    ]
    value: Annotated[
        TimeFunction,
        key(KeyType.FUNCTION, "Torque, N m: a number, or a function of t.", "N m", example="1.5"),
    ]
    against: Annotated[
        MarkerRef | None,
        key(KeyType.MARKER, "Marker at which the reaction acts; by default there is no reaction."),
    ] = None
    kind: ClassVar[str] = "torque"

    @property
    def markers(self) -> tuple[MarkerRef, ...]:
        """The marker at which the torque acts, and the marker of its reaction, if there is one."""
        return (self.at,) if self.against is None else (self.at, self.against)


class _BetweenMarkers:
    """The base class of elements that act between two markers."""

    first: MarkerRef
    second: MarkerRef

    @property
    def markers(self) -> tuple[MarkerRef, MarkerRef]:
        """The two markers between which the element acts."""
        return (self.first, self.second)


@dataclass(frozen=True)
class Spring(_BetweenMarkers):
    """A spring with a damper between two markers."""

    # Its keys are those of its kind in the registry of forces. With the extension x = length - rest its force is
    # stiffness * x + quadratic * x^2 + ... + quintic * x^5 + damping * (rate of the length); for rotational ones the
    # length is the rotation of the second marker against the first.

    name: str
    kind: str
    first: Annotated[MarkerRef, replace(BETWEEN, example='["ground.bearing", "slider.pin"]')]
    second: MarkerRef
    stiffness: Quantity
    damping: Quantity = Fraction(0)
    rest: Quantity = Fraction(0)
    quadratic: Quantity = Fraction(0)
    cubic: Quantity = Fraction(0)
    quartic: Quantity = Fraction(0)
    quintic: Quantity = Fraction(0)


@dataclass(frozen=True)
class Bushing(_BetweenMarkers):
    """Linear springs with dampers between two markers: along both axes of the section at the first, and about e3.

    The forces are stiffness * (displacement - rest) + damping * (rate), where displacement and rate are those of the
    second marker relative to the first, in the frame of the section there; the torque likewise with the rotation.
    """

    name: str
    first: MarkerRef
    second: MarkerRef
    stiffness_x: Quantity = Fraction(0)
    stiffness_y: Quantity = Fraction(0)
    stiffness_rotation: Quantity = Fraction(0)
    damping_x: Quantity = Fraction(0)
    damping_y: Quantity = Fraction(0)
    damping_rotation: Quantity = Fraction(0)
    rest_x: Quantity = Fraction(0)
    rest_y: Quantity = Fraction(0)
    rest_rotation: Quantity = Fraction(0)
    kind: ClassVar[str] = "bushing"


@dataclass(frozen=True)
class CustomForce:
    """A force, torque or spring of a kind that is registered from outside the package.

    `markers` are the markers at which it acts; `values` are the values of the keys of the kind.
    """

    name: str
    kind: str
    markers: tuple[MarkerRef, ...]
    values: Mapping[str, object] = field(default_factory=dict, hash=False)


SceneForce = Force | Torque | Spring | Bushing | CustomForce
