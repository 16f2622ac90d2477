"""The translational joint: a marker moves on a line through another, without relative rotation of the bodies."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from typing import ClassVar

import sympy as sp

from derive.mechanics.multibody.coordinates import CoordinateMap, displacement_only, prescribed_motion
from derive.mechanics.multibody.joints.joint_type import (
    ANGLE,
    Drawing,
    DrivenCoordinate,
    JointEquations,
    JointType,
    Multiplier,
    Support,
    offset,
)
from derive.mechanics.multibody.keys import Key, KeyType
from derive.mechanics.multibody.point_motion import Derivatives, PointMotion, RelativeMotion
from derive.mechanics.quantity import rounded
from derive.mechanics.symbols import element
from derive.mechanics.terms import Intermediate
from derive.spec.model.scene import Joint


class Translational(JointType):
    """Two constraints: no displacement normal to an axis that is fixed in the first body, and a constant rotation."""

    doc = "the second marker stays on a line through the first, and the relative rotation is constant"
    keys = (
        ANGLE,
        Key("axis", KeyType.DIRECTION, "", "Direction of the line of a translational joint in the frame of body 1."),
    )
    freedom = 1
    multipliers = (
        Multiplier("normal", "{second} stays on the line of {joint}", "m", "N"),
        Multiplier("turn", "{markers} turn together", "rad", "N m"),
    )
    intermediates = ("axis_1", "axis_2")
    driven: ClassVar[DrivenCoordinate] = DrivenCoordinate("m", "m/s", "N", "drive {drive} displaces {second}")
    rigid_first = True
    drawing = Drawing(circles=(((0.0, 0.0), 1.0),), guide=True)

    def equations(self, joint: Joint, relative: RelativeMotion) -> JointEquations:
        """The axis rotates with the first body; its normal is e3 x axis."""
        along, definitions = _axis(joint, relative.first)
        normal = sp.Matrix([-along[1], along[0]])
        residuals = _component(relative, normal), offset(relative.rotation, joint.angle)
        return JointEquations(residuals, _component(relative, along), definitions)

    def minimal_coordinates(self, joint: Joint, support: Support) -> CoordinateMap | None:
        """The displacement along a line that does not move; nothing with a drive."""
        at, name, motion = support.marker, support.body, support.motion
        if not at.is_still or support.sign < 0 or at.rotation != 0:
            return None
        axis, angle = unit_axis(joint), support.sign * sp.Rational(joint.angle)
        if drive := support.drive:
            s, v, a = drive.motion
            moved = replace(
                at,
                definitions=(),
                position=sp.ImmutableMatrix(at.position + s * axis),
                velocity=sp.ImmutableMatrix(v * axis),
                acceleration=sp.ImmutableMatrix(a * axis),
            )
            reason = f"drive {drive.name} prescribes its motion: no coordinates and no constraints, in place of 3 and 3"
            return prescribed_motion(name, motion, moved, (angle, sp.S.Zero, sp.S.Zero), reason)
        reason = f"joint {joint.name} guides it: its displacement alone, in place of 3 coordinates and 2 constraints"
        return displacement_only(name, motion, at, axis, angle, reason)


def unit_axis(joint: Joint) -> sp.Matrix:
    """The direction of a translational joint, of length one exactly: a point of the circle that is rational."""
    axis = sp.Matrix([sp.Rational(x) for x in joint.axis])
    length = sp.sqrt(axis.dot(axis))
    if length.is_Rational:
        return axis / length
    angle = math.atan2(*map(float, reversed(joint.axis)))
    half = sp.Rational(Fraction(math.tan(angle / 2)).limit_denominator(10**9))
    return sp.Matrix([1 - half**2, 2 * half]) / (1 + half**2)


def _axis(joint: Joint, first: PointMotion) -> tuple[sp.Matrix, tuple[Intermediate, ...]]:
    """The axis in the inertial frame; where the first body rotates, under names of its own."""
    axis = unit_axis(joint)
    if first.rotation.is_zero:
        return axis, ()
    cos, sin = rounded(sp.cos(first.rotation)), rounded(sp.sin(first.rotation))
    along = sp.Matrix([element(joint.name, "axis", k) for k in (1, 2)])
    values = sp.Matrix([[cos, -sin], [sin, cos]]) * axis
    doc = f"axis of {joint.name} along e"
    return along, tuple(
        Intermediate(symbol, value, joint.name, "(26)", f"{doc}{k}")
        for k, (symbol, value) in enumerate(zip(along, values, strict=True), 1)
    )


def _component(relative: RelativeMotion, direction: sp.Matrix) -> Derivatives:
    """direction . displacement, differentiated with direction' = (angular velocity) e3 x direction."""
    across = sp.Matrix([-direction[1], direction[0]])
    displacement, rate, second = relative.displacement
    _, omega, omegadot = relative.first.rotation_derivatives
    return (
        direction.dot(displacement),
        direction.dot(rate) + omega * across.dot(displacement),
        direction.dot(second)
        + 2 * omega * across.dot(rate)
        + omegadot * across.dot(displacement)
        - omega**2 * direction.dot(displacement),
    )
