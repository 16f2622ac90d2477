"""The motion of a material point of a planar body with the section there, and the relative motion of two points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, TypeAlias

from derive.algebra import sp
from derive.mechanics import zeros
from derive.mechanics.motion.kinematics import ONE, RDDOT, RDOT, Field, R
from derive.mechanics.motion.material_points import (
    KEPT,
    MaterialPoint,
    acceleration_of_rates,
    radius_and_rate,
    tangent_vectors,
)
from derive.mechanics.symbols import Family, Identity
from derive.mechanics.terms import Intermediate, ModelConstant

if TYPE_CHECKING:
    from derive.mechanics.motion.body_motion import Motion
    from derive.mechanics.typed_symbol import Symbol

Derivatives: TypeAlias = "tuple[sp.Expr, sp.Expr, sp.Expr]"
"""A quantity with its first and second time derivative."""


@dataclass(frozen=True)
class PointMotion:
    """Position, velocity and acceleration (columns of 2, inertial frame), and the rotation of the section about e3.

    Accelerations are linear in the accelerations of the coordinates, whose factors are the columns of the Jacobian.
    """

    definitions: tuple[Intermediate, ...]
    position: sp.ImmutableMatrix
    velocity: sp.ImmutableMatrix
    acceleration: sp.ImmutableMatrix
    rotation: sp.Expr
    angular_velocity: sp.Expr
    angular_acceleration: sp.Expr

    @property
    def rotation_derivatives(self) -> Derivatives:
        """The rotation of the section with its derivatives."""
        return self.rotation, self.angular_velocity, self.angular_acceleration

    @property
    def is_still(self) -> bool:
        """Whether the point does not move."""
        return not any((*self.velocity, *self.acceleration, self.angular_velocity, self.angular_acceleration))

    def replaced(self, by: Mapping[sp.Basic, sp.Basic]) -> PointMotion:
        """Return the motion in other symbols; `definitions` do not change."""

        def change(expr: sp.Expr) -> sp.Expr:
            return expr.xreplace(by)

        vectors = (v.applyfunc(change) for v in (self.position, self.velocity, self.acceleration))
        scalars = (change(e) for e in self.rotation_derivatives)
        return PointMotion(self.definitions, *vectors, *scalars)


def fixed_point(position: sp.Matrix) -> PointMotion:
    """A point of the ground."""
    still = sp.ImmutableMatrix([0, 0])
    return PointMotion((), sp.ImmutableMatrix(position), still, still, sp.S.Zero, sp.S.Zero, sp.S.Zero)


@lru_cache(KEPT)
def point_motion(motion: Motion, point: MaterialPoint, rotations: tuple[ModelConstant, ...]) -> PointMotion:
    """The motion of a material point from (1) and (5).

    rotations: the rotations of the section by each shape and, at second order, by products of two amplitudes.
    """
    rotation, (generator,), axes = motion.rotation, motion.frame.generators, (1, 2)
    still = sp.zeros(2, 1)

    def symbols(family: Family, derivative: int = 0) -> sp.Matrix:
        named = (Identity(family, components=(k,), derivative=derivative, point=point.name) for k in axes)
        return sp.Matrix([known.symbol for known in named])

    def define(vector: sp.Matrix, values: sp.Matrix, doc: str) -> list[Intermediate]:
        where = point.name
        return [
            Intermediate(symbol, value, where, "(1)", f"{doc} {where}, along e{k}")
            for k, symbol, value in zip(axes, vector, values, strict=True)
        ]

    def tangent(shape: int, k: int) -> Symbol:
        return Identity(Family.TANGENT, (shape,), (k,), point=point.name).symbol

    tangents = tangent_vectors(motion, point, tangent)
    at_point, rate = radius_and_rate(motion, point, tangents.vectors)
    r, rdot = symbols(Family.RADIUS), symbols(Family.RADIUS, 1)
    s, sdot = symbols(Family.LEVER), symbols(Family.LEVER, 1)
    seen = [Intermediate(symbol, value, point.name, "(6)", doc) for symbol, value, doc in tangents.definitions]
    seen += define(r, at_point, "r = X + u at") + define(rdot, rate, "time derivative of r at")
    lever = define(s, rotation * r, "Q r at") + define(sdot, rotation * rdot, "Q rdot at")
    kept, known = zeros.drop_definitions((*seen, *lever), zeros.reasons_of(point.coefficients))
    amplitudes = motion.alpha, motion.alphadot, motion.alphaddot
    rddot = sum((v * a for v, a in zip(tangents.vectors, motion.alphaddot, strict=True)), still)
    world = {R: s, RDOT: sdot, RDDOT: rotation * (rddot + acceleration_of_rates(motion, point))}

    def vector(field: Field) -> sp.ImmutableMatrix:
        total = field.get(ONE, still)
        for name, tensor in field.items():
            if name != ONE:
                _check_commuting(sp.ImmutableMatrix(rotation), sp.ImmutableMatrix(tensor))
                total = total + tensor * world[name]
        return sp.ImmutableMatrix(total.expand().applyfunc(lambda e: zeros.drop(e, known)))

    vanishing = {**known, **zeros.reasons_of(rotations)}

    def rotated(angle: sp.Symbol, derivative: int) -> sp.Expr:
        return zeros.drop(angle + _deformation(rotations, amplitudes, derivative), vanishing)

    phi, row = motion.coordinates[2].q, motion.rows[2]
    assert generator[1, 0] == 1, "phi is counted about e3"
    return PointMotion(
        definitions=tuple(d for d in kept if not d.zero),
        position=vector(motion.position),
        velocity=vector(motion.velocity),
        acceleration=vector(motion.acceleration),
        rotation=rotated(phi, 0),
        angular_velocity=rotated(row.v, 1),
        angular_acceleration=rotated(row.a, 2),
    )


@lru_cache(KEPT)
def _check_commuting(rotation: sp.ImmutableMatrix, tensor: sp.ImmutableMatrix) -> None:
    """Raise ArithmeticError unless a tensor commutes with the rotation of a body."""
    if not (rotation * tensor - tensor * rotation).expand().is_zero_matrix:
        raise ArithmeticError("rotations in the plane commute; this tensor does not")


def _deformation(
    rotations: tuple[ModelConstant, ...], amplitudes: Sequence[Sequence[sp.Symbol]], derivative: int
) -> sp.Expr:
    """A derivative of the rotation of a section by deformation; amplitudes: with their rates and accelerations."""
    alpha, rates, accelerations = amplitudes
    total = sp.S.Zero
    for c in rotations:
        first, *second = (i - 1 for i in c.symbol.identity.shapes)
        if not second:
            total += c.symbol * amplitudes[derivative][first]
            continue
        i, j = first, second[0]
        product = (
            alpha[i] * alpha[j],
            rates[i] * alpha[j] + alpha[i] * rates[j],
            accelerations[i] * alpha[j] + 2 * rates[i] * rates[j] + alpha[i] * accelerations[j],
        )
        total += c.symbol * product[derivative]
    return sp.expand(total)


@dataclass(frozen=True)
class RelativeMotion:
    """The motion of a second point relative to a first: displacement (columns of 2) and rotation, with derivatives."""

    first: PointMotion
    second: PointMotion

    @property
    def displacement(self) -> tuple[sp.Matrix, sp.Matrix, sp.Matrix]:
        """The displacement from the first point to the second, in the inertial frame."""
        first, second = self.first, self.second
        return (
            sp.Matrix(second.position - first.position),
            sp.Matrix(second.velocity - first.velocity),
            sp.Matrix(second.acceleration - first.acceleration),
        )

    @property
    def rotation(self) -> Derivatives:
        """The rotation of the second section relative to the first."""
        return added(self.second.rotation_derivatives, self.first.rotation_derivatives, -1)

    def component(self, k: int) -> Derivatives:
        """The displacement along axis k of the inertial frame, counted from 0."""
        position, velocity, acceleration = self.displacement
        return position[k], velocity[k], acceleration[k]


def added(a: Derivatives, b: Derivatives, sign: int = 1) -> Derivatives:
    """The sum a + sign b, with derivatives."""
    return a[0] + sign * b[0], a[1] + sign * b[1], a[2] + sign * b[2]
