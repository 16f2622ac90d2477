"""Joints whose constraints are no sums of what each body contributes, since factors of the one depend on the other.

These are joints whose axes move with a body, or that remove functions of several relative motions.
"""

from __future__ import annotations

from dataclasses import replace

from derive.algebra import sp
from derive.mechanics.multibody.constraints import constraints
from derive.mechanics.multibody.joints.joint_type import PrescribedMotion
from derive.mechanics.multibody.joints.relative_rows import Axes
from derive.mechanics.multibody.kinds import JointInstance
from derive.mechanics.multibody.point_motion import PointMotion, RelativeMotion, fixed_point
from derive.mechanics.symbols import local
from derive.mechanics.terms import Constraint
from derive.spec.model.markers import GROUND

OTHER_SYMBOLS = tuple(local(f"other_{what}") for what in ("x1", "x2", "v1", "v2", "angle", "speed"))
"""The symbols of the position, the velocity, the rotation and the angular velocity of a marker that may move."""
_HERE = fixed_point(sp.Matrix([0, 0]))
OTHER = PointMotion(
    definitions=(),
    position=sp.ImmutableMatrix(OTHER_SYMBOLS[0:2]),
    velocity=sp.ImmutableMatrix(OTHER_SYMBOLS[2:4]),
    acceleration=_HERE.acceleration,
    rotation=OTHER_SYMBOLS[4],
    angular_velocity=OTHER_SYMBOLS[5],
    angular_acceleration=sp.S.Zero,
)
"""Any motion of a marker, without acceleration."""
_NONE = (sp.S.Zero, sp.S.Zero, sp.S.Zero)


def varies(joint: JointInstance) -> bool:
    """Whether the factors of one body in the constraints of a joint may depend on the motion of the other one."""
    axes = joint.type.axes
    rows = {*joint.type.removes, *((joint.type.driven,) if joint.drive else ())}
    return (axes is not Axes.INERTIAL and joint.joint.first.body != GROUND) or not rows <= {*axes.rows}


def at_rest(drive: PrescribedMotion | None) -> PrescribedMotion | None:
    """A drive that prescribes no motion, so that its constraint is the relative motion itself."""
    return drive and replace(drive, motion=_NONE)


def prescribed_alone(joint: JointInstance) -> tuple[Constraint, ...]:
    """The constraints of a joint and of its drive with nothing but the motion that the drive prescribes."""
    _, conditions = constraints(joint.joint, joint.type, RelativeMotion(_HERE, OTHER), joint.drive, ())
    motions = [*(_NONE for _ in joint.type.removes), *((joint.drive.motion,) if joint.drive else ())]
    return tuple(
        replace(c, position=sp.expand(-g), rate=sp.expand(-gdot), bias=sp.expand(-gddot))
        for c, (g, gdot, gddot) in zip(conditions, motions, strict=True)
    )
