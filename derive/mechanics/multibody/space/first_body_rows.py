"""The accelerations that joints of deformable bodies forbid, in components along the axes of their first bodies.

A joint that removes all displacements has them in the inertial frame, and three rotations as products of the axes of
both markers. What it forbids is also a relative acceleration along the axes of its first body, where the factors of
this body are those of its marker in its own frame: minus one for each mode that is a unit motion. Those of the second
body are its own ones times one rotation tensor. With three rotations, the second derivatives of the rotation vectors
replace the angular accelerations, so that the factors of modes are the constants of the markers.

The rows are the constraints times a regular matrix, and have the same accelerations. The multipliers follow from those
of the rows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.axes import SPACE
from derive.mechanics.motion.products import product
from derive.mechanics.motion.vectors import cross, dot
from derive.mechanics.multibody.space.frame_motion import fixed_axes
from derive.mechanics.multibody.space.rows import COINCIDENT, derived, row_variables
from derive.mechanics.symbols import local
from derive.mechanics.terms import Constraint, EquationOfMotion, Intermediate, OwnAxes, load_symbols

if TYPE_CHECKING:
    from derive.mechanics.multibody.space.frame_motion import FrameMotion
    from derive.mechanics.multibody.space.joints import SpatialJointInstance


def rows_along_first(joint: SpatialJointInstance) -> int:
    """The number of constraints of a joint that have such rows, which are its first ones: 0, 3 or 6."""
    rows = joint.rows
    if rows[:SPACE] != COINCIDENT or joint.drive is not None:
        return 0
    rotations = rows[SPACE:]
    turns = len(rotations) == SPACE and all(derived(row).turns for row in rotations)
    return SPACE + len(rotations) if turns else SPACE


@cache
def turned_axes() -> tuple[tuple[sp.Symbol, ...], ...]:
    """The factors of the second body in its own ones: three rows of displacements, and three of rotations."""
    axes = range(1, SPACE + 1)
    return tuple(tuple(local(name, i, j) for j in axes) for name in ("between", "between_vectors") for i in axes)


@cache
def row_reactions() -> tuple[sp.Symbol, ...]:
    """The multipliers of the rows along the axes of the first body."""
    return tuple(local("row_reaction", k) for k in range(1, 2 * SPACE + 1))


def factors_along_own_axes(frame: FrameMotion) -> list[dict[str, sp.Expr]]:
    """The factors of the rows of a body in the acceleration of its marker and in that of its rotation vector.

    All are along the axes of the body, also those of the translation of its origin; none of a frame with known motion.
    """
    own = _own(frame)
    twists = {v.row: v.twist for v in frame.virtual if any(v.twist)}
    loads = load_symbols()
    result: list[dict[str, sp.Expr]] = [{} for _ in loads]
    for row, work in own.work:
        of = [sp.expand(work).coeff(load) for load in loads]
        turning = twists.get(row) or product(frame.inverse_tangent, sp.Matrix(of[SPACE:]))
        for k, factor in enumerate((*of[:SPACE], *turning)):
            if factor != 0:
                result[k][row] = factor
    return result


def _own(frame: FrameMotion) -> OwnAxes:
    """The motion of a frame along the axes of its body; along the inertial ones if that is no body with coordinates."""
    if frame.own is not None:
        return frame.own
    return OwnAxes(fixed_axes(), (), frame.acceleration, frame.angular_acceleration, frame.axes, frame.angular_velocity)


@dataclass(frozen=True)
class JointAlongFirst:
    """A joint with rows along the axes of its first body.

    constraints: with the bias of these rows, and without their factors; definitions: what they contain;
    reactions: the multipliers of the joint from those of its rows.
    """

    definitions: tuple[Intermediate, ...]
    constraints: tuple[Constraint, ...]
    reactions: tuple[sp.Expr, ...]


def joint_along_first(
    joint: SpatialJointInstance, first: FrameMotion, second: FrameMotion, rows: tuple[EquationOfMotion, ...]
) -> JointAlongFirst:
    """The rows of a joint for the motions of both of its markers; `rows` are those of its bodies."""
    _, plain = joint.constraints(first, second, None, rows)
    count = rows_along_first(joint)
    made: list[Intermediate] = []
    one, two = _own(first), _own(second)
    between, doc = product(one.Q.T, two.Q), "axes of the second body along the first ones"
    turned = _named(made, turned_axes()[:SPACE], between, doc)
    bias = [*(product(turned, sp.Matrix(two.acceleration)) - sp.Matrix(one.acceleration))]
    own = row_reactions()
    reactions = [*product(one.Q, sp.Matrix(own[:SPACE]))]
    if count > SPACE:
        back = first.inverse_tangent
        _named(made, turned_axes()[SPACE:], product(back, product(turned, second.tangent)), "rates of rotation vectors")
        columns, acceleration = _rotations(joint, one, two, turned, made)
        bias += [*product(back, acceleration)]
        moment = product(back.T, sp.Matrix(own[SPACE:]))
        reactions += [dot(column, moment) for column in columns]
    changed = zip(plain, bias, strict=False)
    held = (replace(c, position=sp.S.Zero, rate=sp.S.Zero, bias=b, jacobian=(), frames=None) for c, b in changed)
    reactions += own[count : len(plain)]
    return JointAlongFirst(tuple(made), (*held, *plain[count:]), tuple(reactions))


def _rotations(
    joint: SpatialJointInstance, one: OwnAxes, two: OwnAxes, turned: sp.Matrix, made: list[Intermediate]
) -> tuple[list[sp.Matrix], sp.Matrix]:
    """The columns of the inverse of the factors in the relative angular acceleration, and what the latter lacks.

    With the second frame at rest in the first one but for the angular velocity W between them, each axis a of it has
    the acceleration W x (W x a) = W (W . a) - W^2 a, which is not zero where W is not: the rows forbid W, too.
    """
    of = row_variables()

    def named(name: str, values: sp.Matrix, doc: str) -> sp.Matrix:
        names = [[local(name, i, j) for j in range(1, values.cols + 1)] for i in range(1, values.rows + 1)]
        return _named(made, names, values, doc)

    own = named("first_axes", sp.Matrix(one.axes), "axes of the first marker in its body")
    other = named("second_axes", product(turned, sp.Matrix(two.axes)), "axes of the second marker in the first body")
    spin = named("first_spin", sp.Matrix(one.angular_velocity), "angular velocity of the first marker")
    relative = named("relative_spin", product(turned, sp.Matrix(two.angular_velocity)) - spin, "relative one")
    along = named("spin_along", product(relative.T, other), "relative angular velocity along the second axes")
    values = dict(zip((*of.first.A, *of.second.A), (*own, *other), strict=True))
    turning = dict(zip((*of.first.A, *of.second.A), (*own, *product(relative, along)), strict=True))
    rows = [derived(row) for row in joint.rows[SPACE:]]
    factors = named("across", sp.Matrix([[*row.m2.xreplace(values)] for row in rows]), "factors of the acceleration")
    square = dot(relative, relative)
    drift = [sp.factor_terms(row.g.xreplace(turning)) - square * row.g.xreplace(values) for row in joint.rows[SPACE:]]
    a, b, c = (factors[k, :].T for k in range(SPACE))
    columns = [cross(b, c), cross(c, a), cross(a, b)]
    (inverse,) = named("inverse_across", sp.Matrix([1 / dot(a, columns[0])]), "inverse of their determinant")
    columns = [column * inverse for column in columns]
    missing = sum((column * d for column, d in zip(columns, drift, strict=True)), sp.zeros(SPACE, 1))
    between = product(turned, sp.Matrix(two.angular_acceleration)) - sp.Matrix(one.angular_acceleration)
    return columns, between - cross(spin, relative) + missing


def _named(made: list[Intermediate], names: object, values: sp.Matrix, doc: str) -> sp.Matrix:
    """Names for the entries of a matrix, with their definitions."""
    symbols = sp.Matrix(names)
    made += [Intermediate(s, value, "joint", "(6)", doc) for s, value in zip(symbols, values, strict=True)]
    return symbols
