"""The joints in space: masks of relative rows, with names for the usual ones."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from typing import TYPE_CHECKING

from derive.mechanics.multibody.space.constraints import spatial_constraints
from derive.mechanics.multibody.space.rows import (
    DISPLACEMENTS,
    DISTANCE,
    DRIVEN_DISPLACEMENT,
    DRIVEN_ROTATION,
    RELATIVE_MOTIONS,
    SCREW,
    TURN,
    RelativeFunction,
    masked,
)
from derive.registry import Registry
from derive.spec.model.keys import Key, declared_keys
from derive.spec.model.markers import MarkerRef
from derive.spec.model.spatial_scene import SpatialJoint

if TYPE_CHECKING:
    from derive.mechanics.multibody.joints.joint_type import PrescribedMotion
    from derive.mechanics.multibody.space.frame_motion import FrameMotion
    from derive.mechanics.terms import Constraint, EquationOfMotion, Intermediate

_KEYS = {key.name: key for key in declared_keys(SpatialJoint)}


class Freedom(Enum):
    """The single relative motion of a joint that a drive may prescribe: its unit and the row of the drive."""

    ROTATION = "rad"
    DISPLACEMENT = "m"

    @property
    def unit(self) -> str:
        """The unit of the relative motion."""
        return str(self.value)

    @property
    def row(self) -> RelativeFunction:
        """The row by which a drive prescribes it."""
        return DRIVEN_ROTATION if self is Freedom.ROTATION else DRIVEN_DISPLACEMENT

    @property
    def motion(self) -> RelativeFunction:
        """The relative motion itself, a rotation from -pi to pi."""
        return TURN if self is Freedom.ROTATION else DISPLACEMENTS["z"]


@dataclass(frozen=True)
class SpatialJointType:
    """A type of joint between two marker frames. All types are in SPATIAL_JOINTS.

    doc: its function, in a clause. removes: the relative motions that vanish; None of a joint whose table says so.
    driven: the relative motion that a drive may prescribe. keeps_distance: whether the distance of the markers is what
    it keeps. is_screw: whether the displacement along z is proportional to the rotation about it.
    """

    doc: str
    removes: tuple[str, ...] | None
    driven: Freedom | None = None
    keeps_distance: bool = False
    is_screw: bool = False

    @property
    def keys(self) -> tuple[Key, ...]:
        """The keys of the table of a joint besides `kind`, `between` and `start`."""
        return (
            *((_KEYS["removes"],) if self.removes is None else ()),
            *((_KEYS["distance"],) * self.keeps_distance),
            *((replace(_KEYS["pitch"], required=True),) * self.is_screw),
            *((_KEYS["limits"],) * (self.driven is not None)),
        )

    def removed(self, joint: SpatialJoint) -> tuple[str, ...]:
        """The relative motions that a joint of this type removes, in their order."""
        removes = joint.removes if self.removes is None else self.removes
        return tuple(name for name in RELATIVE_MOTIONS if name in removes)

    def free(self, joint: SpatialJoint) -> tuple[str, ...] | None:
        """The relative motions that are left, in their order; None if they are no subset of the six."""
        removed = self.removed(joint)
        return None if self.keeps_distance else tuple(name for name in RELATIVE_MOTIONS if name not in removed)

    def rows(self, joint: SpatialJoint) -> tuple[RelativeFunction, ...]:
        """The rows that vanish."""
        if self.keeps_distance:
            return (DISTANCE,)
        return (*masked(self.removed(joint)), *((SCREW,) * self.is_screw))

    def coupled(self, joint: SpatialJoint) -> Freedom | None:
        """The relative motion of a joint that a gear couples to that of another one, if there is one."""
        return self.couples(self.removed(joint))

    def couples(self, removed: tuple[str, ...]) -> Freedom | None:
        """The motion that a gear couples where these are removed: a rotation about z wherever z axes are parallel."""
        return Freedom.ROTATION if self.leaves(removed, Freedom.ROTATION) else self.driven

    def leaves(self, removed: tuple[str, ...], motion: Freedom) -> bool:
        """Whether the bodies may move along, or turn about, a common z axis where these motions are removed."""
        free, across = ("rz", {"rx", "ry"}) if motion is Freedom.ROTATION else ("z", {"x", "y"})
        return free not in removed and across <= {*removed}

    def starts(self, removed: tuple[str, ...]) -> tuple[JointStart, ...]:
        """The motions that initial values of a joint may give where these motions are removed."""
        result = []
        if self.leaves(removed, Freedom.ROTATION):
            result.append(JointStart("angle", "angle_rate", Freedom.ROTATION, (2,)))
        if self.leaves(removed, Freedom.DISPLACEMENT) and not self.is_screw:
            result.append(JointStart("displacement", "displacement_rate", Freedom.DISPLACEMENT, (2,)))
        if {"z", "rx", "ry"} <= {*removed} and not {"x", "y"} & {*removed}:
            result.append(JointStart("displacements", "displacement_rates", Freedom.DISPLACEMENT, (0, 1)))
        return tuple(result)


@dataclass(frozen=True)
class JointStart:
    """A motion of a joint with initial values: their keys, and the axes of the first marker that it is along."""

    key: str
    rate: str
    freedom: Freedom
    axes: tuple[int, ...]


_POINT = ("x", "y", "z")

SPATIAL_JOINTS: Registry[SpatialJointType] = Registry(
    "joint in space",
    {
        "fixed": SpatialJointType("the frames coincide", (*_POINT, "rx", "ry", "rz")),
        "revolute": SpatialJointType("rotation about z", (*_POINT, "rx", "ry"), Freedom.ROTATION),
        "screw": SpatialJointType(
            "rotation about z, and displacement along it by the pitch for each turn",
            ("x", "y", "rx", "ry"),
            Freedom.ROTATION,
            is_screw=True,
        ),
        "prismatic": SpatialJointType("displacement along z", ("x", "y", "rx", "ry", "rz"), Freedom.DISPLACEMENT),
        "cylindrical": SpatialJointType("displacement along and rotation about z", ("x", "y", "rx", "ry")),
        "universal": SpatialJointType(
            "the points coincide, and z of the first marker stays normal to x of the second", (*_POINT, "ry")
        ),
        "spherical": SpatialJointType("the points coincide", _POINT),
        "planar": SpatialJointType("displacement along x and y and rotation about z", ("z", "rx", "ry")),
        "point_on_line": SpatialJointType("the second point stays on the z axis of the first marker", ("x", "y")),
        "distance": SpatialJointType("the points keep their distance", (), keeps_distance=True),
        "general": SpatialJointType("`removes` lists the relative motions that vanish", None),
    },
    doc="""The kinds of joints in space by their names, which are the values of `kind` in [joints.NAME].

    `derive.SPATIAL_JOINTS.register(name, member)` adds one of your own, a `derive.extensions.SpatialJointType` with the
    relative motions that it removes.

    Examples:
        >>> import derive
        >>> derive.SPATIAL_JOINTS["cylindrical"].doc
        'displacement along and rotation about z'
        >>> "spherical" in derive.SPATIAL_JOINTS
        True
    """,
)


@dataclass(frozen=True)
class SpatialJointInstance:
    """A joint that is a constraint: its markers are on instances or on the ground."""

    joint: SpatialJoint
    type: SpatialJointType
    drive: PrescribedMotion | None

    @property
    def rows(self) -> tuple[RelativeFunction, ...]:
        """The rows that vanish, that of the drive behind those of the joint."""
        return self._rows(self.drive)

    def _rows(self, drive: PrescribedMotion | None) -> tuple[RelativeFunction, ...]:
        """The rows that vanish with a drive, whose row is the last one, or without."""
        driven = self.type.driven if drive else None
        return (*self.type.rows(self.joint), *((driven.row,) if driven else ()))

    @property
    def multipliers(self) -> int:
        """The number of constraints, one for each row that the joint removes and one for its drive."""
        return len(self.rows)

    def constraints(
        self,
        first: FrameMotion,
        second: FrameMotion,
        drive: PrescribedMotion | None,
        rows: tuple[EquationOfMotion, ...],
    ) -> tuple[tuple[Intermediate, ...], tuple[Constraint, ...]]:
        """The constraints of the joint and of a drive for the motions of its markers, without intermediate quantities.

        rows: those of the bodies whose factors in G are wanted. One of the motions may stand for any: the constraints
        refer to no frames, through which they would act on both.
        """
        conditions = spatial_constraints(self.joint, self._rows(drive), first, second, drive, rows)
        return (), tuple(replace(condition, frames=None) for condition in conditions)


@dataclass(frozen=True)
class SpatialEliminatedJoint:
    """A joint that has eliminated coordinates of the body it supports, and is no constraint.

    `own` is the marker on that body, `known` the other one, whose motion is known. keeps_coordinate: whether the motion
    that a drive prescribes is a coordinate of the body, and the drive a constraint.
    """

    joint: SpatialJoint
    type: SpatialJointType
    drive: PrescribedMotion | None
    own: MarkerRef
    known: MarkerRef
    keeps_coordinate: bool = False

    @property
    def sign(self) -> int:
        """1 if the body that it supports is body 2 of the joint, -1 if it is body 1."""
        return 1 if self.own == self.joint.second else -1
