"""The joints in space: masks of relative rows, with names for the usual ones."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from derive.mechanics.multibody.space.rows import (
    DISTANCE,
    DRIVEN_DISPLACEMENT,
    DRIVEN_ROTATION,
    RELATIVE_MOTIONS,
    RelativeFunction,
    masked,
)
from derive.registry import Registry
from derive.spec.model.keys import Key, declared_keys
from derive.spec.model.spatial_scene import SpatialJoint

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


@dataclass(frozen=True)
class SpatialJointType:
    """A type of joint between two marker frames. All types are in SPATIAL_JOINTS.

    doc: its function, in a clause. removes: the relative motions that vanish; None of a joint whose table says so.
    driven: the relative motion that a drive may prescribe. keeps_distance: whether the distance of the markers is what
    it keeps.
    """

    doc: str
    removes: tuple[str, ...] | None
    driven: Freedom | None = None
    keeps_distance: bool = False

    @property
    def keys(self) -> tuple[Key, ...]:
        """The keys of the table of a joint besides `kind`, `between` and `start`."""
        return (*((_KEYS["removes"],) if self.removes is None else ()), *((_KEYS["distance"],) * self.keeps_distance))

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
        return (DISTANCE,) if self.keeps_distance else masked(self.removed(joint))


_POINT = ("x", "y", "z")

SPATIAL_JOINTS: Registry[SpatialJointType] = Registry(
    "joint in space",
    {
        "fixed": SpatialJointType("the frames coincide", (*_POINT, "rx", "ry", "rz")),
        "revolute": SpatialJointType("rotation about z", (*_POINT, "rx", "ry"), Freedom.ROTATION),
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
)
