"""The base class of the types of joints: the rows that a joint removes or a drive prescribes, and its drawing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from derive.mechanics.multibody.joints.relative_rows import Axes, RelativeRow
from derive.spec.model.joints import Joint
from derive.spec.model.keys import Key

if TYPE_CHECKING:
    from derive.mechanics.motion.body_motion import Motion
    from derive.mechanics.multibody.point_motion import Derivatives, PointMotion, RelativeMotion
    from derive.mechanics.terms import Intermediate

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
    """The constraints of a joint: g with its first and second time derivative for each row that it removes.

    `driven` is the row that a drive may prescribe, with its derivatives. `definitions` are intermediate quantities of
    both.
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


class JointType:
    """A type of joint between two markers. Subclasses are registered in `registry.JOINTS`.

    doc: the function of the joint, in a clause; axes: the axes along which displacements are resolved; removes: the
    rows that vanish, each with a multiplier; driven: the row that a drive may prescribe; drawing: its symbol.
    Constraints with their derivatives, multipliers, keys and minimal coordinates (`joint_elimination.py`) follow from
    the rows.
    """

    doc: ClassVar[str]
    axes: ClassVar[Axes] = Axes.INERTIAL
    removes: ClassVar[tuple[RelativeRow, ...]]
    driven: ClassVar[RelativeRow | None] = None
    drawing: ClassVar[Drawing]

    def __init_subclass__(cls) -> None:
        """Raise TypeError for a row along other axes than those of the joint, which would silently mean another one."""
        own = (*getattr(cls, "removes", ()), cls.driven)
        foreign = [row.label for axes in Axes if axes is not cls.axes for row in axes.value if row in own]
        if foreign:
            raise TypeError(f"{cls.__name__}: {', '.join(foreign)}: along other axes than {cls.axes.name}")

    @property
    def keys(self) -> tuple[Key, ...]:
        """The keys of the table of a joint besides `kind` and `between`."""
        return (*self.axes.keys, *dict.fromkeys(key for row in self.removes for key in row.keys))

    @property
    def freedom(self) -> int:
        """The number of relative motions that the joint leaves free."""
        return len(self.axes.rows) - len(self.removes)

    @property
    def rigid_first(self) -> bool:
        """Whether the first marker must be on a rigid body or on the ground, which carries the axes of the joint."""
        return self.axes is not Axes.INERTIAL

    def equations(self, joint: Joint, relative: RelativeMotion) -> JointEquations:
        """The rows of a joint from the relative motion of its markers."""
        motion, definitions = self.axes.relative_motion(joint, relative)
        residuals = tuple(row.derivatives(joint, motion) for row in self.removes)
        driven = None if self.driven is None else self.driven.derivatives(joint, motion)
        return JointEquations(residuals, driven, definitions)
