"""How a body moves: coordinates, rotation, moving frame, moments; what planar and spatial motion have in common."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby

import sympy as sp

from derive.mechanics.motion.kinematics import ONE, Field, MovingFrame
from derive.mechanics.motion.moments import Moments, total
from derive.mechanics.sums import Series, Vectors, exchanged, written_out
from derive.mechanics.symbols import MASS, I
from derive.mechanics.terms import Coordinate, EquationOfMotion, Intermediate

__all__ = ["MASS", "Motion"]


@dataclass(frozen=True)
class Motion:
    """How a body with some number of shapes moves: coordinates, rotation tensor Q, moving frame, and moments.

    `definitions` are d1, D2, d3, J in terms of the shape integrals; `sums` stand in one row alone or hold
    accelerations, and are written out; `products` gives names to products of rates. `turns` are the tensors e_k x, in
    the inertial and in the body base. `identities` are the reasons of terms that cancel in any body, by row and name.
    """

    coordinates: tuple[Coordinate, ...]
    rows: tuple[EquationOfMotion, ...]
    rates: tuple[sp.Expr, ...]
    alpha: tuple[sp.Symbol, ...]
    rotation: sp.Matrix
    rotation_definitions: tuple[Intermediate, ...]
    frame: MovingFrame
    moments: Moments
    definitions: tuple[Intermediate, ...]
    sums: dict[sp.Symbol, sp.Expr]
    products: dict[sp.Expr, sp.Symbol]
    turns: tuple[tuple[sp.Matrix, sp.Matrix], ...]
    identities: dict[tuple[str, str], str]

    @property
    def alphadot(self) -> tuple[sp.Symbol, ...]:
        """The rates of the shapes."""
        return tuple(row.v for row in self.rows[len(self.rows) - len(self.alpha) :])

    @property
    def position(self) -> Field:
        """x of (1)."""
        return {ONE: sp.Matrix([c.q for c in self.coordinates[: self.rotation.rows]]), **self.frame.position}

    @property
    def velocity(self) -> Field:
        """xdot."""
        return {ONE: sp.Matrix([row.v for row in self.rows[: self.rotation.rows]]), **self.frame.velocity}

    @property
    def acceleration(self) -> Field:
        """xddot of (5)."""
        return {ONE: sp.Matrix([row.a for row in self.rows[: self.rotation.rows]]), **self.frame.acceleration}

    @property
    def translations(self) -> tuple[Field, ...]:
        """delta x for unit variations of c."""
        unit = sp.eye(self.rotation.rows)
        return tuple({ONE: unit[:, k]} for k in range(unit.rows))

    def product(self, a: Field, b: Field) -> sp.Expr:
        """int rho a . b over the body, for a generic index i if a or b holds PHI."""
        return total(a, b, self.moments)

    def summed(self, expr: sp.Expr) -> sp.Expr:
        """An expression with the sums that have no name of their own written out."""
        return sp.expand(expr.xreplace(self.sums))


def definitions_of(series: Iterable[Series], vectors: Vectors, n: int) -> tuple[Intermediate, ...]:
    """The series written out for each of n shapes, moment by moment; zeros still inside."""
    found: list[Intermediate] = []
    for section, group in groupby(series, lambda s: s.section):
        members = tuple(group)
        for i in range(1, n + 1) if members[0].indexed else (0,):
            for s in members:
                symbol, doc = exchanged(s.symbol, {I: i}), s.described(i)
                found.append(Intermediate(symbol, written_out(s, i, vectors), section, "appendix", doc))
    return tuple(found)


def sums_of(series: Iterable[Series], vectors: Vectors, n: int) -> dict[sp.Symbol, sp.Expr]:
    """The series written out, each in those before it."""
    found: dict[sp.Symbol, sp.Expr] = {}
    for s in series:
        for i in range(1, n + 1) if s.indexed else (0,):
            found[exchanged(s.symbol, {I: i})] = sp.expand(written_out(s, i, vectors).xreplace(found))
    return found
