"""Joints whose constraints are no sums of what each body contributes, since factors of the one depend on the other.

These are joints whose axes move with a body, or that remove functions of several relative motions.
"""

from __future__ import annotations

from dataclasses import replace

from derive.algebra import sp
from derive.lowering.instances.classes.dimension import AnyJoint, of_joint
from derive.mechanics.multibody.joints.joint_type import PrescribedMotion
from derive.mechanics.multibody.joints.relative_rows import Axes
from derive.mechanics.multibody.space.joints import SpatialJointInstance
from derive.mechanics.multibody.space.rows import COINCIDENT
from derive.mechanics.terms import Constraint
from derive.spec.model.markers import GROUND

_NONE = (sp.S.Zero, sp.S.Zero, sp.S.Zero)


def varies(joint: AnyJoint) -> bool:
    """Whether the factors of one body in the constraints of a joint may depend on the motion of the other one.

    In space those of all rows do but of the inertial components of a displacement.
    """
    if isinstance(joint, SpatialJointInstance):
        return not {*joint.rows} <= {*COINCIDENT}
    axes = joint.type.axes
    rows = {*joint.type.removes, *((joint.type.driven,) if joint.drive else ())}
    return (axes is not Axes.INERTIAL and joint.joint.first.body != GROUND) or not rows <= {*axes.rows}


def at_rest(drive: PrescribedMotion | None) -> PrescribedMotion | None:
    """A drive that prescribes no motion, so that its constraint is the relative motion itself."""
    return drive and replace(drive, motion=_NONE)


def drive_of(joint: AnyJoint) -> PrescribedMotion | None:
    """The drive in the constraints that a varying joint computes: at rest in the plane, where its motion is added.

    In space the constraint of a rotation is the sine of its difference from the motion that the drive prescribes.
    """
    return joint.drive if isinstance(joint, SpatialJointInstance) else at_rest(joint.drive)


def prescribed_alone(joint: AnyJoint) -> tuple[Constraint, ...]:
    """The constraints of a joint and of its drive with nothing but what `drive_of` leaves of the prescribed motion."""
    of = of_joint(joint)
    _, conditions = joint.constraints(of.still, of.other, joint.drive, ())
    motions = [_NONE for _ in conditions]
    if joint.drive and drive_of(joint) != joint.drive:
        motions[-1] = joint.drive.motion
    return tuple(
        replace(c, position=sp.expand(-g), rate=sp.expand(-gdot), bias=sp.expand(-gddot))
        for c, (g, gdot, gddot) in zip(conditions, motions, strict=True)
    )
