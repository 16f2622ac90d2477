"""The rows of a joint: functions of the relative motion of its markers, with their time derivatives.

A row is a function of the displacement from the first marker to the second, along the axes of the joint, and of the
relative rotation. A joint removes rows, which then vanish, and a drive may prescribe another one. Derivatives follow
from the chain rule, so that nobody writes one.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from functools import cache, lru_cache
from typing import TYPE_CHECKING, TypeAlias

from derive.algebra import sp
from derive.mechanics.quantity import rounded
from derive.mechanics.symbols import element
from derive.mechanics.terms import Intermediate
from derive.spec.model.joints import Joint
from derive.spec.model.keys import Key, declared_keys

if TYPE_CHECKING:
    from derive.mechanics.multibody.point_motion import Derivatives, PointMotion, RelativeMotion

ANGLE, AXIS = (key for key in declared_keys(Joint) if key.name in ("angle", "axis"))

FORCE_UNITS = {"m": "N", "rad": "N m"}


@cache
def row_variables() -> sp.Matrix:
    """The variables of the functions of rows: displacement along two axes (m) and relative rotation (rad)."""
    return sp.Matrix([sp.Dummy("d1"), sp.Dummy("d2"), sp.Dummy("theta")])


RowFunction: TypeAlias = "Callable[[Joint, sp.Matrix, sp.Expr], sp.Expr]"
"""A function of a joint, of the displacement (2, 1) along its axes, m, and of the relative rotation, rad."""


@dataclass(frozen=True)
class RelativeRow:
    """A function of the relative motion of two markers, which a joint removes or a drive prescribes.

    The name of the multiplier is that of the joint with `label` behind it. `doc` is a template with the fields
    {markers}, {second} (the second body) and {joint}; `drive_doc` one with {drive} and {second}. `unit` is that of the
    function. keys: those of the joint that the function depends on.
    """

    label: str
    doc: str
    unit: str
    function: RowFunction
    keys: tuple[Key, ...] = ()
    drive_doc: str = ""

    @property
    def force_unit(self) -> str:
        """The unit of the multiplier, whose product with the row is a work."""
        return FORCE_UNITS.get(self.unit, f"J/({self.unit})")

    def derivatives(self, joint: Joint, motion: tuple[Derivatives, ...]) -> Derivatives:
        """The row with two time derivatives; motion: displacement along the axes of the joint, and rotation."""
        g = sp.sympify(self.function(joint, row_variables()[:2, :], row_variables()[2]))
        slopes, curvatures = _slopes(g)
        rate = sum((slope * motion[a][1] for a, slope in slopes), sp.S.Zero)
        second = sum((slope * motion[a][2] for a, slope in slopes), sp.S.Zero)
        second += sum(curvature * motion[a][1] * motion[b][1] for a, b, curvature in curvatures)
        now = {symbol: of[0] for symbol, of in zip(row_variables(), motion, strict=True)}
        return g.xreplace(now), rate.xreplace(now), second.xreplace(now)


@lru_cache(256)
def _slopes(g: sp.Expr) -> tuple[tuple[tuple[int, sp.Expr], ...], tuple[tuple[int, int, sp.Expr], ...]]:
    """The first and second derivatives of a row by its variables that do not vanish, each after its numbers there."""
    slopes = tuple((a, slope) for a, symbol in enumerate(row_variables()) if (slope := g.diff(symbol)) != 0)
    second = ((a, b, slope.diff(symbol)) for a, slope in slopes for b, symbol in enumerate(row_variables()))
    return slopes, tuple(of for of in second if of[2] != 0)


def _displacement(label: str, doc: str, k: int) -> RelativeRow:
    return RelativeRow(label, doc, "m", lambda joint, d, rotation: d[k], (), "drive {drive} displaces {second}")


ALONG_E1 = _displacement("1", "{markers} coincide along e1", 0)
ALONG_E2 = _displacement("2", "{markers} coincide along e2", 1)
ALONG_AXIS = _displacement("along", "{second} does not move along the axis of {joint}", 0)
NORMAL_TO_AXIS = _displacement("normal", "{second} stays on the line of {joint}", 1)
ROTATION = RelativeRow(
    "turn",
    "{markers} turn together",
    "rad",
    lambda joint, d, rotation: rotation - sp.Rational(joint.angle),
    (ANGLE,),
    "drive {drive} turns {second}",
)


class Axes(Enum):
    """The axes along which the displacement between the markers is resolved; the values are their rows.

    They are those of the inertial frame, or the `axis` of the joint and its normal e3 x axis, both fixed in body 1.
    """

    INERTIAL = (ALONG_E1, ALONG_E2)
    OF_BODY_1 = (ALONG_AXIS, NORMAL_TO_AXIS)

    @property
    def rows(self) -> tuple[RelativeRow, ...]:
        """All relative motions in the plane."""
        return (*self.value, ROTATION)

    def directions(self, joint: Joint) -> tuple[sp.Matrix, sp.Matrix]:
        """The two axes in the frame to which they are fixed."""
        along = sp.Matrix([1, 0]) if self is Axes.INERTIAL else unit_axis(joint)
        return along, _across(along)

    def relative_motion(
        self, joint: Joint, relative: RelativeMotion
    ) -> tuple[tuple[Derivatives, ...], tuple[Intermediate, ...]]:
        """The displacement along the axes and the rotation, with two derivatives, and the definitions in them."""
        if self is Axes.INERTIAL:
            return (relative.component(0), relative.component(1), relative.rotation), ()
        along, definitions = _axis_of_body_1(joint, relative.first)
        components = (_component(relative, direction) for direction in (along, _across(along)))
        return (*components, relative.rotation), definitions

    @property
    def keys(self) -> tuple[Key, ...]:
        """The keys of a joint on which its axes depend."""
        return () if self is Axes.INERTIAL else (AXIS,)

    @property
    def intermediates(self) -> tuple[str, ...]:
        """The labels of the definitions of the axes of a joint, which must not coincide with other names of a scene."""
        return () if self is Axes.INERTIAL else ("axis_1", "axis_2")


def unit_axis(joint: Joint) -> sp.Matrix:
    """The axis of a joint as a unit vector with rational components: a rational point of the unit circle."""
    axis = sp.Matrix([sp.Rational(x) for x in joint.axis])
    length = sp.sqrt(axis.dot(axis))
    if length.is_Rational:
        return axis / length
    angle = math.atan2(*map(float, reversed(joint.axis)))
    half = sp.Rational(Fraction(math.tan(angle / 2)).limit_denominator(10**9))
    return sp.Matrix([1 - half**2, 2 * half]) / (1 + half**2)


def _across(direction: sp.Matrix) -> sp.Matrix:
    """The direction e3 x direction."""
    return sp.Matrix([-direction[1], direction[0]])


def _axis_of_body_1(joint: Joint, first: PointMotion) -> tuple[sp.Matrix, tuple[Intermediate, ...]]:
    """The axis in the inertial frame; if the first body rotates, its components are symbols with definitions."""
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
    """The component direction . displacement, differentiated with direction' = (angular velocity) e3 x direction."""
    across = _across(direction)
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
