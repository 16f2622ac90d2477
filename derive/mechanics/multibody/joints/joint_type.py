"""What a type of joint declares: its keys, constraints, minimal coordinates, multipliers, drive and drawing."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import sympy as sp

from derive.mechanics.motion.body_motion import Motion
from derive.mechanics.multibody.coordinates import CoordinateMap
from derive.mechanics.multibody.keys import Key, KeyType
from derive.mechanics.multibody.point_motion import Derivatives, PointMotion, RelativeMotion
from derive.mechanics.terms import Intermediate
from derive.spec.model.scene import Joint

ANGLE = Key(
    "angle", KeyType.FLOAT, "rad", "Constant rotation of body 2 relative to body 1, rad; not for revolute joints."
)
"""A key of the joints that keep a constant relative rotation."""


@dataclass(frozen=True)
class Multiplier:
    """A constraint of a joint and its multiplier.

    The name is that of the joint with `label` behind it. `doc` is a template with the fields {markers}, {second} (the
    second body) and {joint}. `unit` is that of g, `force_unit` that of the multiplier.
    """

    label: str
    doc: str
    unit: str
    force_unit: str


@dataclass(frozen=True)
class DrivenCoordinate:
    """The relative coordinate of a joint that a drive prescribes: its unit, that of its speed and of the multiplier.

    `doc` is a template with the fields {drive} and {second}.
    """

    unit: str
    speed_unit: str
    force_unit: str
    doc: str


Point = tuple[float, float]


@dataclass(frozen=True)
class Drawing:
    """A symbol at the second marker, in the frame of its body; its unit is half the size of the symbol of a weld.

    `lines` are open polygons, `circles` have a centre and a radius. With a `guide` the symbol is on a line through the
    first marker, along `joint.axis` in the frame of the first body, as long as the second marker moves.
    """

    lines: tuple[tuple[Point, ...], ...] = ()
    circles: tuple[tuple[Point, float], ...] = ()
    guide: bool = False


@dataclass(frozen=True)
class JointEquations:
    """What a joint demands: g with its first and second time derivative for each multiplier, in their order.

    `driven` is the relative coordinate that a drive may prescribe, with its derivatives. `definitions` are
    intermediate quantities of both.
    """

    residuals: tuple[Derivatives, ...]
    driven: Derivatives | None = None
    definitions: tuple[Intermediate, ...] = ()


@dataclass(frozen=True)
class PrescribedMotion:
    """A drive of a joint: its name, and its motion as a function of t with two time derivatives."""

    name: str
    motion: Derivatives


@dataclass(frozen=True)
class Support:
    """A rigid body that a joint connects to a marker whose motion is known.

    `motion` is that of the body, whose origin O is its marker of the joint; `marker` is the known marker, and
    `attached_to` is the text that names the body of the known marker. `sign` is 1 if the body is body 2 of the joint,
    -1 if it is body 1.
    """

    body: str
    motion: Motion
    marker: PointMotion
    attached_to: str
    sign: int
    drive: PrescribedMotion | None


class JointType(ABC):
    """A type of joint between two markers. Subclasses are registered in `registry.JOINTS`.

    doc: what the joint does, in a clause; keys: what its table has besides `kind` and `between`; freedom: the number of
    relative motions it leaves; multipliers: its constraints, in the order of `equations`; intermediates: the labels of
    the definitions it makes, so that no other name of a scene meets them; driven: the coordinate that a drive may
    prescribe; rigid_first: whether its first marker must be on a rigid body or on the ground.
    """

    doc: ClassVar[str]
    keys: ClassVar[tuple[Key, ...]] = ()
    freedom: ClassVar[int]
    multipliers: ClassVar[tuple[Multiplier, ...]]
    intermediates: ClassVar[tuple[str, ...]] = ()
    driven: ClassVar[DrivenCoordinate | None] = None
    rigid_first: ClassVar[bool] = False
    drawing: ClassVar[Drawing]

    @abstractmethod
    def equations(self, joint: Joint, relative: RelativeMotion) -> JointEquations:
        """The constraints of a joint, from the motion of its markers."""

    def minimal_coordinates(self, joint: Joint, support: Support) -> CoordinateMap | None:
        """The coordinates that the joint leaves a rigid body; None if it takes none away.

        With a drive they must follow the drive, since neither the joint nor the drive is a constraint then.
        """
        return None


def offset(rotation: Derivatives, angle: float) -> Derivatives:
    """A relative rotation that differs from a constant angle by nothing: g with its derivatives."""
    return (rotation[0] - sp.Rational(angle), *rotation[1:])
