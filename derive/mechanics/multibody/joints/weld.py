"""The weld: two markers coincide, and the bodies do not rotate against each other."""

from __future__ import annotations

import sympy as sp

from derive.mechanics.multibody.coordinates import CoordinateMap, prescribed_motion
from derive.mechanics.multibody.joints.joint_type import (
    ANGLE,
    Drawing,
    JointEquations,
    JointType,
    Multiplier,
    Support,
    offset,
)
from derive.mechanics.multibody.point_motion import RelativeMotion
from derive.spec.model.scene import Joint


class Weld(JointType):
    """Three constraints: the markers coincide, and the rotations differ by a constant angle."""

    doc = "the markers coincide and the relative rotation is constant"
    keys = (ANGLE,)
    freedom = 0
    multipliers = (
        Multiplier("1", "{markers} coincide along e1", "m", "N"),
        Multiplier("2", "{markers} coincide along e2", "m", "N"),
        Multiplier("turn", "{markers} turn together", "rad", "N m"),
    )
    drawing = Drawing(lines=(((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)),))

    def equations(self, joint: Joint, relative: RelativeMotion) -> JointEquations:
        """The markers coincide, and the relative rotation is the angle of the joint."""
        return JointEquations((relative.component(0), relative.component(1), offset(relative.rotation, joint.angle)))

    def minimal_coordinates(self, joint: Joint, support: Support) -> CoordinateMap:
        """Nothing: the body follows its support."""
        angle = support.sign * sp.Rational(joint.angle)
        rotation, *derivatives = support.marker.rotation_derivatives
        eliminated = "no coordinates and no constraints, in place of 3 and 3"
        reason = f"joint {joint.name} fixes it to {support.attached_to}: {eliminated}"
        at = support.marker
        return prescribed_motion(support.body, support.motion, at, (rotation + angle, *derivatives), reason)
