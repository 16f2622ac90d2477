"""The revolute joint: two markers coincide, and the bodies rotate freely against each other."""

from __future__ import annotations

from typing import ClassVar

from derive.mechanics.multibody.coordinates import CoordinateMap, prescribed_motion, rotation_only
from derive.mechanics.multibody.joints.joint_type import (
    Drawing,
    DrivenCoordinate,
    JointEquations,
    JointType,
    Multiplier,
    Support,
)
from derive.mechanics.multibody.point_motion import RelativeMotion, added
from derive.spec.model.scene import Joint


class Revolute(JointType):
    """Two constraints: the difference of the markers vanishes along e1 and e2 of the inertial frame."""

    doc = "the markers coincide"
    freedom = 1
    multipliers = (
        Multiplier("1", "{markers} coincide along e1", "m", "N"),
        Multiplier("2", "{markers} coincide along e2", "m", "N"),
    )
    driven: ClassVar[DrivenCoordinate] = DrivenCoordinate("rad", "rad/s", "N m", "drive {drive} turns {second}")
    drawing = Drawing(circles=(((0.0, 0.0), 1.0),))

    def equations(self, joint: Joint, relative: RelativeMotion) -> JointEquations:
        """The markers coincide; a drive prescribes the relative rotation."""
        return JointEquations((relative.component(0), relative.component(1)), relative.rotation)

    def minimal_coordinates(self, joint: Joint, support: Support) -> CoordinateMap:
        """The rotation alone; nothing with a drive."""
        at, name = support.marker, support.body
        if drive := support.drive:
            rotation = added(at.rotation_derivatives, drive.motion, support.sign)
            reason = f"drive {drive.name} prescribes its motion: no coordinates and no constraints, in place of 3 and 3"
            return prescribed_motion(name, support.motion, at, rotation, reason)
        kept = "its rotation alone, in place of 3 coordinates and 2 constraints"
        reason = f"joint {joint.name} holds a point of it to {support.attached_to}: {kept}"
        return rotation_only(name, support.motion, at, reason)
