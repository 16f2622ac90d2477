"""Forces, torques, springs and bushings of a scene as frozen data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import ClassVar, Literal

from derive.spec.model.markers import MarkerRef
from derive.spec.model.quantity import Quantity
from derive.spec.model.time_function import TimeFunction

ForceFrame = Literal["inertial", "body"]


FORCE_FRAMES: tuple[ForceFrame, ...] = ("inertial", "body")
"""The frames that the components of a force may be in."""


@dataclass(frozen=True)
class Force:
    """A force at a marker, with components that are functions of t.

    `frame` is that of the components: the inertial frame, or that of the section of the body at the marker.
    """

    name: str
    at: MarkerRef
    components: tuple[TimeFunction, TimeFunction]
    frame: ForceFrame = "inertial"
    kind: ClassVar[str] = "force"

    @property
    def markers(self) -> tuple[MarkerRef]:
        """The marker at which the force acts."""
        return (self.at,)


@dataclass(frozen=True)
class Torque:
    """A torque at a marker, a function of t; its reaction acts at `against`, if that is given."""

    name: str
    at: MarkerRef
    value: TimeFunction
    against: MarkerRef | None = None
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
    """A spring with a damper between two markers: along the line between them, or `rotational`, about e3.

    `kind` is a name of the registry of forces. With the extension x = length - rest its force is stiffness * x +
    quadratic * x^2 + cubic * x^3 + quartic * x^4 + quintic * x^5 + damping * (rate of the length); for rotational ones
    the length is the rotation of the second marker against the first.
    """

    name: str
    kind: str
    first: MarkerRef
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
