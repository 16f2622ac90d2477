"""Joint elimination: the coordinates that a joint leaves a rigid body behind a marker whose motion is known."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.multibody.coordinates import CoordinateMap, displacement_only, prescribed_motion, rotation_only
from derive.mechanics.multibody.joints.relative_rows import ALONG_AXIS, ROTATION, Axes
from derive.mechanics.multibody.point_motion import Derivatives, PointMotion, added
from derive.spec.model.joints import Joint

if TYPE_CHECKING:
    from derive.mechanics.multibody.joints.joint_type import JointType, Support


def minimal_coordinates(joint_type: JointType, joint: Joint, support: Support) -> CoordinateMap | None:
    """The coordinates of a rigid body that a joint supports; None if the joint eliminates none.

    With a drive they follow the drive, since neither the joint nor the drive is a constraint then.
    """
    rows, at, drive = joint_type.axes.rows, support.marker, support.drive
    if not set(joint_type.removes) <= set(rows):
        return None  # a function of several relative motions
    if joint_type.axes is Axes.OF_BODY_1 and not (at.is_still and support.sign > 0 and at.rotation == 0):
        return None  # axes that move
    kept = [row for row in rows if row not in joint_type.removes and not (drive and row is joint_type.driven)]
    texts = {"joint": joint.name, "attached_to": support.attached_to, "drive": drive.name if drive else ""}
    if not kept:
        moved, rotation = _prescribed(joint_type, joint, support)
        reason = (_DRIVEN if drive else _FIXED).format(**texts)
        return prescribed_motion(support.body, support.motion, moved, rotation, reason)
    if kept == [ROTATION]:
        return rotation_only(support.body, support.motion, at, _ROTATES.format(**texts))
    if kept == [ALONG_AXIS]:
        axis, angle = joint_type.axes.directions(joint)[0], support.sign * sp.Rational(joint.angle)
        return displacement_only(support.body, support.motion, at, axis, angle, _GUIDED.format(**texts))
    return None


_ALL = "this eliminates 3 coordinates and 3 constraints"
_DRIVEN = f"drive {{drive}} prescribes its motion; {_ALL}"
_FIXED = f"joint {{joint}} fixes it to {{attached_to}}; {_ALL}"
_TWO = "this eliminates 2 coordinates and 2 constraints"
_ROTATES = f"joint {{joint}} pins it to {{attached_to}}, and only its rotation remains; {_TWO}"
_GUIDED = f"joint {{joint}} guides it, and only its displacement remains; {_TWO}"


def _prescribed(joint_type: JointType, joint: Joint, support: Support) -> tuple[PointMotion, Derivatives]:
    """The motion of the marker of a body without coordinates, and the rotation of the body."""
    at, drive, driven = support.marker, support.drive, joint_type.driven
    constant = sp.Rational(joint.angle), sp.S.Zero, sp.S.Zero
    relative = drive.motion if drive and driven is ROTATION else constant
    rotation = added(at.rotation_derivatives, relative, support.sign)
    if not drive or driven is ROTATION:
        return at, rotation
    axes = zip(joint_type.axes.rows, joint_type.axes.directions(joint), strict=False)
    direction = next(direction for row, direction in axes if row is driven)
    changed = zip((at.position, at.velocity, at.acceleration), drive.motion, strict=True)
    vectors = (sp.ImmutableMatrix(vector + of * direction) for vector, of in changed)
    position, velocity, acceleration = vectors
    return replace(at, definitions=(), position=position, velocity=velocity, acceleration=acceleration), rotation
