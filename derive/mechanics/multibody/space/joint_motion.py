"""The motion of a joint in space that gears couple and outputs show: a coordinate, that of a drive, or a function."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from derive.algebra import sp
from derive.mechanics.multibody.space.constraints import RowMotion, lead, row_motion, row_values
from derive.mechanics.multibody.space.forces import CountedRotation, MarkerLoad, none
from derive.mechanics.multibody.space.joints import Freedom, SpatialEliminatedJoint, SpatialJointInstance
from derive.mechanics.multibody.space.rows import DISPLACEMENTS, SCREW, TURN
from derive.mechanics.symbols import Family, identity
from derive.mechanics.terms import Constraint
from derive.spec.model.instances import identifier
from derive.spec.model.markers import MarkerRef
from derive.spec.model.spatial_scene import SpatialJoint

if TYPE_CHECKING:
    from derive.mechanics.multibody.kinds import BodyInstance
    from derive.mechanics.multibody.space.frame_motion import FrameMotion
    from derive.mechanics.terms import EquationOfMotion

Rows: TypeAlias = "tuple[EquationOfMotion, ...]"
At: TypeAlias = "Callable[[MarkerRef], FrameMotion]"


@dataclass(frozen=True)
class JointMotion:
    """The motion of a joint, which a gear couples: its value with the derivatives, and whether it counts turns.

    loads: those of a unit torque about, or of a unit force along, the axis of the joint on both of its bodies.
    """

    freedom: Freedom
    motion: RowMotion
    counted: bool
    loads: tuple[MarkerLoad, MarkerLoad]


def joint_motion(
    joint: SpatialJointInstance | SpatialEliminatedJoint, at: At, instances: Mapping[str, BodyInstance], rows: Rows
) -> JointMotion:
    """The motion of the second marker of a joint against the first: a coordinate, that of a drive, or a function."""
    freedom = joint.type.coupled(joint.joint)
    assert freedom is not None, "the specification refuses other joints"
    of: SpatialJoint = joint.joint
    first, second = at(of.first), at(of.second)
    match joint:
        case SpatialEliminatedJoint():
            if freedom is Freedom.ROTATION:
                axis = sp.Matrix(first.axes[:, 2])  # that of the second marker as well
                loads = MarkerLoad(of.first, none(), -axis), MarkerLoad(of.second, none(), axis)
            else:
                loads = _unit_loads(of, row_motion(of, freedom.motion, first, second, None, ()))
            return JointMotion(freedom, _of_coordinate(joint, freedom, instances), True, loads)
        case SpatialJointInstance():
            motion = row_motion(of, freedom.motion, first, second, None, rows)
            return JointMotion(freedom, motion, freedom is Freedom.DISPLACEMENT, _unit_loads(of, motion))


def counted_rotation(
    joint: SpatialJointInstance | SpatialEliminatedJoint, at: At, motion: Callable[[str], JointMotion], first: MarkerRef
) -> CountedRotation | None:
    """The rotation of a joint about z of one of its markers, `first`, with all turns; None where they are not known.

    They are known by the coordinate of a body, by a drive, and on a thread by the displacement.
    """
    from derive.mechanics.time_functions import Wrapped

    of = joint.joint
    if not joint.type.leaves(joint.type.removed(of), Freedom.ROTATION):
        return None
    sign = 1 if first == of.first else -1
    if isinstance(joint, SpatialEliminatedJoint):
        turned = motion(of.name).motion
        return CountedRotation(sign * turned.value, sign * turned.rate)
    if joint.drive and joint.type.driven is Freedom.ROTATION:
        values = row_values(of, at(of.first), at(of.second), None)
        apart = joint.drive.motion[0] - TURN.g.xreplace(values)
        return CountedRotation(sign * (apart - Wrapped(apart, sp.S.One)), None)
    if joint.type.is_screw:
        values, pitch = row_values(of, at(of.first), at(of.second), None), lead(of)
        apart, turned, within = (row.g.xreplace(values) for row in (DISPLACEMENTS["z"], TURN, SCREW))
        return CountedRotation(sign * (apart - pitch * turned - within) / pitch, None)
    return None


def drive_constraint(joint: SpatialEliminatedJoint, of: JointMotion, rows: Rows) -> Constraint:
    """The constraint that a coordinate of a joint follows the drive."""
    assert joint.drive is not None
    name, (position, rate, second) = joint.drive.name, joint.drive.motion
    row = of.freedom.row
    return Constraint(
        name=identifier(name),
        shown=name,
        of=joint.joint.name,
        doc=row.doc.format(
            drive=name, markers=f"{joint.joint.first} and {joint.joint.second}", second=joint.joint.second.body,
            joint=joint.joint.name,
        ),
        unit=row.unit,
        force_unit=row.force_unit,
        position=of.motion.value - position,
        rate=of.motion.rate - rate,
        bias=of.motion.bias - second,
        jacobian=tuple((r.name, of.motion.factors[r.name]) for r in rows if r.name in of.motion.factors),
    )  # fmt: skip


def _of_coordinate(joint: SpatialEliminatedJoint, freedom: Freedom, instances: Mapping[str, BodyInstance]) -> RowMotion:
    """The motion of a joint that has eliminated coordinates: of body 2 against body 1, whichever it supports."""
    sign = joint.sign
    if joint.drive and not joint.keeps_coordinate:
        position, rate, second = (sp.sympify(of) for of in joint.drive.motion)
        return RowMotion(position, rate, second, {})
    family = Family.ANGLE if freedom is Freedom.ROTATION else Family.GUIDE
    own = instances[joint.own.body].coordinates
    (number,) = (i for i, c in enumerate(own.coordinates) if identity(c.q).family is family)
    row = own.rows[number]
    return RowMotion(sign * own.coordinates[number].q, sign * row.v, sp.S.Zero, {row.name: sp.Integer(sign)})


def _unit_loads(joint: SpatialJoint, motion: RowMotion) -> tuple[MarkerLoad, MarkerLoad]:
    """The loads of a unit multiplier of the motion of a joint on its two bodies."""
    f1, m1, f2, m2 = motion.loads
    return MarkerLoad(joint.first, f1, m1), MarkerLoad(joint.second, f2, m2)
