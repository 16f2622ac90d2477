"""How a material point of a planar body moves, with the section of the body there: what joints and forces need."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from derive.mechanics import zeros
from derive.mechanics.equations import Coefficient, Definition
from derive.mechanics.kinematics import ONE, RDDOT, RDOT, Field, R
from derive.mechanics.motion import Motion
from derive.mechanics.points import MaterialPoint
from derive.mechanics.symbols import Family, Identity, Symbol


@dataclass(frozen=True)
class PointMotion:
    """Position, velocity and acceleration (columns of 2, inertial base), and the rotation of the section about e3.

    Accelerations are linear in those of the coordinates, whose factors are the columns of the Jacobian.
    """

    definitions: tuple[Definition, ...]
    position: sp.ImmutableMatrix
    velocity: sp.ImmutableMatrix
    acceleration: sp.ImmutableMatrix
    turn: sp.Expr
    spin: sp.Expr
    spin_rate: sp.Expr

    def replaced(self, by: Mapping[sp.Basic, sp.Basic]) -> PointMotion:
        """The same in other symbols; definitions are renamed but stay what they are."""

        def change(expr: sp.Expr) -> sp.Expr:
            return expr.xreplace(by)

        vectors = (v.applyfunc(change) for v in (self.position, self.velocity, self.acceleration))
        scalars = (change(e) for e in (self.turn, self.spin, self.spin_rate))
        return PointMotion(self.definitions, *vectors, *scalars)


def fixed_point(position: sp.Matrix, turn: sp.Expr = sp.S.Zero) -> PointMotion:
    """A point of the ground."""
    still = sp.ImmutableMatrix([0, 0])
    return PointMotion((), sp.ImmutableMatrix(position), still, still, turn, sp.S.Zero, sp.S.Zero)


def point_motion(
    motion: Motion, point: MaterialPoint, turns: tuple[Coefficient, ...], reasons: zeros.Reasons
) -> PointMotion:
    """The motion of a material point from (1) and (5); `turns` are the rotations of the section by each shape."""
    rotation, (generator,), axes = motion.rotation, motion.frame.generators, (1, 2)
    shape_rows = motion.rows[len(motion.rows) - len(motion.alpha) :]
    still = sp.zeros(2, 1)

    def sum_of(factors: tuple[sp.Symbol, ...], vectors: list[sp.Matrix], base: sp.Matrix) -> sp.Matrix:
        return sum((v * a for v, a in zip(vectors, factors, strict=True)), base)

    def symbols(family: Family, derivative: int = 0) -> sp.Matrix:
        named = (Identity(family, components=(k,), derivative=derivative, point=point.name) for k in axes)
        return sp.Matrix([Symbol(known) for known in named])

    def define(vector: sp.Matrix, values: sp.Matrix, doc: str) -> list[Definition]:
        where = point.name
        return [
            Definition(symbol, value, where, "(1)", f"{doc} {where}, along e{k}")
            for k, symbol, value in zip(axes, vector, values, strict=True)
        ]

    shapes = [sp.Matrix(s) for s in point.shapes]
    r, rdot = symbols(Family.RADIUS), symbols(Family.RADIUS, 1)
    s, sdot = symbols(Family.LEVER), symbols(Family.LEVER, 1)
    seen = define(r, sum_of(motion.alpha, shapes, sp.Matrix(point.position)), "r = X + u at")
    seen += define(rdot, sum_of(motion.alphadot, shapes, still), "rate of r at")
    lever = define(s, rotation * r, "Q r at") + define(sdot, rotation * rdot, "Q rdot at")
    kept, known = zeros.drop_definitions((*seen, *lever), reasons)
    accelerations = tuple(row.a for row in shape_rows)
    world = {R: s, RDOT: sdot, RDDOT: rotation * sum_of(accelerations, shapes, still)}

    def vector(field: Field) -> sp.ImmutableMatrix:
        total = field.get(ONE, still)
        for name, tensor in field.items():
            if name != ONE:
                if not (rotation * tensor - tensor * rotation).expand().is_zero_matrix:
                    raise ArithmeticError("turns in the plane commute; this tensor does not")
                total = total + tensor * world[name]
        return sp.ImmutableMatrix(total.expand().applyfunc(lambda e: zeros.drop(e, known)))

    slopes = tuple(c.symbol for c in turns)

    def turned(angle: sp.Symbol, amplitudes: tuple[sp.Symbol, ...]) -> sp.Expr:
        total = sp.Add(angle, *(s * a for s, a in zip(slopes, amplitudes, strict=bool(slopes))))
        return zeros.drop(total, {**known, **zeros.reasons_of(turns)})

    phi, row = motion.coordinates[2].q, motion.rows[2]
    assert generator[1, 0] == 1, "phi is counted about e3"
    return PointMotion(
        definitions=tuple(d for d in kept if not d.zero),
        position=vector(motion.position),
        velocity=vector(motion.velocity),
        acceleration=vector(motion.acceleration),
        turn=turned(phi, motion.alpha),
        spin=turned(row.v, motion.alphadot),
        spin_rate=turned(row.a, accelerations),
    )
