"""The loads of trees on rows: those in joints, which inputs may give, and springs and dampers along their axes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from derive.algebra import sp
from derive.lowering.trees.exact_numbers import Exact, exact
from derive.mechanics.multibody.space.joints import Freedom, SpatialEliminatedJoint
from derive.mechanics.multibody.space.mechanism import SpatialActionInstance, SpatialMechanism
from derive.mechanics.symbols import Family, identity
from derive.spec.model.spatial_forces import (
    SpatialForce,
    SpatialJointForce,
    SpatialJointTorque,
    SpatialSpring,
    SpatialTorque,
)

AT_MARKERS = (SpatialForce, SpatialTorque)
"""The actions at markers, which act on links and not on rows."""


@dataclass(frozen=True)
class RowLoad:
    """A load on a row, `sign` times a value: a number, an input, or a function of the time."""

    row: int
    sign: int
    value: sp.Expr
    name: str


@dataclass(frozen=True)
class RowSpring:
    """A spring with a damper on a row: `sign` times its coordinate is the motion, and `rest` that without a force."""

    row: int
    coordinate: int
    sign: int
    stiffness: Exact
    damping: Exact
    rest: Exact


@dataclass(frozen=True)
class RowLoads:
    """The loads and the springs of a tree."""

    loads: tuple[RowLoad, ...]
    springs: tuple[RowSpring, ...]

    @property
    def any(self) -> bool:
        """Whether there is any."""
        return bool(self.loads or self.springs)


def row_loads(mechanism: SpatialMechanism) -> RowLoads:
    """The loads of a mechanism whose actions are all in joints, see `refused_actions`."""
    loads, springs = [], []
    known = {c.symbol: c.value for c in mechanism.constants}
    for action in mechanism.forces:
        if isinstance(action.element, AT_MARKERS) or acts_between_frames(mechanism, action):
            continue
        joint, freedom = _joint(mechanism, action)
        assert joint is not None
        row, coordinate = place_in(mechanism, joint, freedom)
        element = action.element
        if isinstance(element, SpatialSpring):
            along = 1 if element.first == joint.joint.first else -1
            k, d, rest = (exact(value, known) for value in _spring(action))
            springs.append(RowSpring(row, coordinate, along * joint.sign, k, d, rest))
        else:
            loads.append(RowLoad(row, joint.sign, sp.sympify(action.values["value"]), element.name))
    return RowLoads(tuple(loads), tuple(springs))


def refused_actions(mechanism: SpatialMechanism) -> Iterator[str]:
    """Yield the names of actions that loops along trees do not have."""
    for action in mechanism.forces:
        if isinstance(action.element, AT_MARKERS) or acts_between_frames(mechanism, action):
            continue
        joint, freedom = _joint(mechanism, action)
        if joint is None or _motion(joint, freedom) is None:
            yield action.element.name


def acts_between_frames(mechanism: SpatialMechanism, action: SpatialActionInstance) -> bool:
    """Whether an action is a spring between marker frames: neither on a row, nor on a rotation that counts turns."""
    if not isinstance(action.element, SpatialSpring):
        return False
    own, freedom = _joint(mechanism, action)
    if own is not None and _motion(own, freedom) is not None:
        return False
    joint = mechanism.joint_of(action)
    if joint is None or action.element.kind != "rotational":
        return True
    counts = isinstance(joint, SpatialEliminatedJoint) or joint.drive is not None or joint.type.is_screw
    return not (counts and joint.type.leaves(joint.type.removed(joint.joint), Freedom.ROTATION))


def _spring(action: SpatialActionInstance) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """The stiffness and the damping of a spring along or about the axis of its joint, and where it is at rest."""
    k, d = action.values["stiffness"], action.values["damping"]
    if isinstance(k, sp.MatrixBase):
        return k[2, 2], d[2, 2], sp.S.Zero
    return k, d, action.values["rest"]


def _joint(mechanism: SpatialMechanism, action: SpatialActionInstance) -> tuple[SpatialEliminatedJoint | None, Freedom]:
    """The joint of an action that acts along or about its axis alone, and along or about."""
    element = action.element
    if isinstance(element, SpatialJointForce | SpatialJointTorque):
        joint = mechanism.joints_by_name[element.joint]
        freedom = Freedom.ROTATION if isinstance(element, SpatialJointTorque) else Freedom.DISPLACEMENT
        return (joint if isinstance(joint, SpatialEliminatedJoint) else None), freedom
    between = mechanism.joint_of(action) if isinstance(element, SpatialSpring) else None
    if isinstance(element, SpatialSpring) and isinstance(between, SpatialEliminatedJoint):
        slides = between.type.free(between.joint) == ("z",)
        if element.kind == ("bushing" if slides else "rotational"):
            return between, Freedom.DISPLACEMENT if slides else Freedom.ROTATION
    return None, Freedom.ROTATION


def _motion(joint: SpatialEliminatedJoint, freedom: Freedom) -> str | None:
    """The motion of a joint about or along z, if it leaves that one."""
    if joint.type.is_screw and freedom is Freedom.DISPLACEMENT:
        return None
    motion = "rz" if freedom is Freedom.ROTATION else "z"
    leaves = joint.type.leaves(joint.type.removed(joint.joint), freedom)
    return motion if leaves and motion in (joint.type.free(joint.joint) or ()) else None


def place_in(mechanism: SpatialMechanism, joint: SpatialEliminatedJoint, freedom: Freedom) -> tuple[int, int]:
    """The indices of the row and of the coordinate of a joint about or along z."""
    of = mechanism.instances_by_name[joint.own.body].coordinates
    rows = of.rows
    family = Family.ANGLE if freedom is Freedom.ROTATION else Family.GUIDE
    own = [i for i, c in enumerate(of.coordinates) if identity(c.q).family is family]
    (number,) = own if len(own) == 1 else [i for i in own if identity(of.coordinates[i].q).components == (3,)]
    names = [row.name for row in mechanism.rows]
    coordinates = [c.q for c in mechanism.coordinates]
    return names.index(rows[number].name), coordinates.index(of.coordinates[number].q)
