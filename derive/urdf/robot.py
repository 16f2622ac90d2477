"""A robot as its URDF describes it: links with their inertia, and joints, which make a tree of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

Vector = npt.NDArray[np.float64]
Matrix = npt.NDArray[np.float64]


class JointKind(Enum):
    """The types of joints, with the names that they have in a URDF."""

    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"
    FIXED = "fixed"
    FLOATING = "floating"
    PLANAR = "planar"

    @property
    def turns(self) -> bool:
        """Whether its only motion is a rotation."""
        return self in (JointKind.REVOLUTE, JointKind.CONTINUOUS)

    @property
    def has_one_motion(self) -> bool:
        """Whether it has one relative motion, which an actuator moves."""
        return self.turns or self is JointKind.PRISMATIC


@dataclass(frozen=True, eq=False)
class Placement:
    """The position and the rotation matrix of a frame in another one."""

    position: Vector
    rotation: Matrix

    def of(self, inner: Placement) -> Placement:
        """The placement of a frame that `inner` places in this one."""
        position = self.position + self.rotation @ inner.position
        return Placement(np.round(position, 15), without_noise(self.rotation @ inner.rotation))


def without_noise(rotation: Matrix) -> Matrix:
    """A rotation matrix in which rounding errors of zeros and ones are gone."""
    whole = np.round(rotation)
    return np.where(abs(rotation - whole) < 1e-15, whole, rotation) + 0.0  # no negative zeros


HERE = Placement(np.zeros(3), np.eye(3))
"""The placement of a frame in itself."""


@dataclass(frozen=True)
class Origin:
    """The placement of a frame as it is written: a position, and rotations about the fixed axes x, y and z in turn."""

    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def placement(self) -> Placement:
        """Its position and its rotation matrix."""
        rotation = Rotation.from_euler("xyz", self.rpy).as_matrix() if any(self.rpy) else np.eye(3)
        return Placement(np.array(self.xyz), without_noise(rotation))


@dataclass(frozen=True)
class Inertia:
    """Mass, the centre of mass with the axes of the tensor, and the entries xx, xy, xz, yy, yz, zz of the tensor."""

    origin: Origin
    mass: float
    tensor: tuple[float, float, float, float, float, float]

    @property
    def matrix(self) -> Matrix:
        """The tensor of inertia about the centre of mass along the axes of the link."""
        xx, xy, xz, yy, yz, zz = self.tensor
        own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        rotation = self.origin.placement.rotation
        return np.asarray(rotation @ own @ rotation.T)


@dataclass(frozen=True)
class LinkShape:
    """A shape of a link: the tag in its <geometry>, with its attributes as text; no tag where there is no geometry."""

    origin: Origin
    form: str
    attributes: Mapping[str, str]
    line: int


@dataclass(frozen=True)
class Link:
    """A link: a rigid body, or a frame alone where it has no inertia; its shapes for pictures and for collisions."""

    name: str
    inertia: Inertia | None
    line: int
    visuals: tuple[LinkShape, ...] = ()
    collisions: tuple[LinkShape, ...] = ()


@dataclass(frozen=True)
class Limits:
    """Limits of a joint: positions, rad or m, effort, N m or N, and speed; None of those that are not given."""

    lower: float | None
    upper: float | None
    effort: float | None
    velocity: float | None


@dataclass(frozen=True)
class Mimic:
    """The motion of a joint follows that of another one: multiplier * motion + offset."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True)
class RobotJoint:
    """A joint: its frame in that of the parent link, which is that of the child link where the joint has not moved."""

    name: str
    kind: JointKind
    parent: str
    child: str
    origin: Origin
    axis: tuple[float, float, float]
    limits: Limits | None
    damping: float
    friction: float
    mimic: Mimic | None
    line: int

    @property
    def direction(self) -> Vector:
        """The unit vector of its axis in its frame."""
        axis = np.array(self.axis)
        return np.asarray(axis / math.hypot(*self.axis))  # of which no square is too small for a number

    def moved(self, position: float) -> Placement:
        """The placement of the child in the frame of a joint with one motion, at a position, rad or m."""
        if self.kind.turns:
            return Placement(np.zeros(3), Rotation.from_rotvec(position * self.direction).as_matrix())
        return Placement(position * self.direction, np.eye(3))


@dataclass(frozen=True)
class Robot:
    """A robot, with the link that is the root of its tree.

    unread: what is not read of the file, with its number. roundings: by how much angles of the file differ from the
    right angles that they are taken for, rad.
    """

    name: str
    root: str
    links: dict[str, Link]
    joints: dict[str, RobotJoint]
    unread: dict[str, int]
    roundings: tuple[float, ...] = ()

    @cached_property
    def joints_of_parents(self) -> Mapping[str, Sequence[RobotJoint]]:
        """The joints on each link that carries others, in the order of the file."""
        result: dict[str, list[RobotJoint]] = {}
        for joint in self.joints.values():
            result.setdefault(joint.parent, []).append(joint)
        return result

    def joints_behind(self, link: str) -> Sequence[RobotJoint]:
        """The joints whose parent is this link, in the order of the file."""
        return self.joints_of_parents.get(link, ())

    @cached_property
    def locked(self) -> Mapping[str, float]:
        """The joints without motion, with the position in which they stay: fixed ones, and those that follow these."""
        locked = {joint.name: 0.0 for joint in self.joints.values() if joint.kind is JointKind.FIXED}
        before = -1
        while len(locked) > before:
            before = len(locked)
            for joint in self.joints.values():
                if joint.mimic and joint.name not in locked and joint.mimic.joint in locked:
                    locked[joint.name] = joint.mimic.multiplier * locked[joint.mimic.joint] + joint.mimic.offset
                elif joint.mimic and joint.mimic.multiplier == 0:
                    locked[joint.name] = joint.mimic.offset
        return locked
