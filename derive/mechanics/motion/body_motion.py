"""The motion of a body in the plane or in space: coordinates, rotation, moving frame and moments."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby

import sympy as sp

from derive.mechanics import zeros
from derive.mechanics.motion.kinematics import ONE, Field, MovingFrame
from derive.mechanics.motion.moments import Moments, total
from derive.mechanics.sums import (
    ALPHA,
    ALPHADDOT,
    ALPHADOT,
    AbsentPart,
    IndexedSum,
    Vectors,
    exchanged,
    expanded_sum,
)
from derive.mechanics.symbols import MASS, Family, I
from derive.mechanics.terms import Coordinate, EquationOfMotion, Intermediate, Reason

__all__ = ["MASS", "Motion"]


@dataclass(frozen=True)
class Motion:
    """The motion of a body with some number of shapes: coordinates, rotation tensor Q, moving frame, and moments.

    `moment_sums` define d1, D2, d3, J in terms of the shape integrals; `row_sums` occur in a single equation or contain
    accelerations, and are expanded in place; `products` gives names to products of velocities, which `named` defines.
    `rotation_generators` are the tensors e_k x, in the inertial and in the body frame. `identities` are the reasons of
    terms that cancel in any body, by row and name.
    """

    coordinates: tuple[Coordinate, ...]
    rows: tuple[EquationOfMotion, ...]
    rates: tuple[sp.Expr, ...]
    alpha: tuple[sp.Symbol, ...]
    rotation: sp.Matrix
    rotation_definitions: tuple[Intermediate, ...]
    frame: MovingFrame
    moments: Moments
    named: tuple[Intermediate, ...]
    moment_sums: tuple[IndexedSum, ...]
    row_sums: tuple[IndexedSum, ...]
    products: dict[sp.Expr, sp.Symbol]
    rotation_generators: tuple[tuple[sp.Matrix, sp.Matrix], ...]
    identities: dict[tuple[str, str], str]

    @property
    def alphadot(self) -> tuple[sp.Symbol, ...]:
        """The generalised velocities of the shapes."""
        return tuple(row.v for row in self.rows[len(self.rows) - len(self.alpha) :])

    @property
    def position(self) -> Field:
        """The position x of (1)."""
        return {ONE: sp.Matrix([c.q for c in self.coordinates[: self.rotation.rows]]), **self.frame.position}

    @property
    def velocity(self) -> Field:
        """The velocity xdot."""
        return {ONE: sp.Matrix([row.v for row in self.rows[: self.rotation.rows]]), **self.frame.velocity}

    @property
    def acceleration(self) -> Field:
        """The acceleration xddot of (5)."""
        return {ONE: sp.Matrix([row.a for row in self.rows[: self.rotation.rows]]), **self.frame.acceleration}

    @property
    def translations(self) -> tuple[Field, ...]:
        """The virtual displacements delta x for unit variations of c."""
        unit = sp.eye(self.rotation.rows)
        return tuple({ONE: unit[:, k]} for k in range(unit.rows))

    @property
    def definitions(self) -> tuple[Intermediate, ...]:
        """The named products, and the moments for each shape function; entries that vanish are still included."""
        return self.definitions_without(zeros.Reasons())[0]

    def definitions_without(self, reasons: zeros.Reasons) -> tuple[tuple[Intermediate, ...], zeros.Reasons]:
        """The definitions without their vanishing parts, and the reasons of all symbols that vanish.

        reasons: the reasons of the symbols that vanish; the result contains those of the vanished moments as well.
        """
        known, result = dict(reasons), list(self.named)
        for s, i in _every(self.moment_sums, len(self.alpha)):
            symbol = exchanged(s.symbol, {I: i})
            expr, vanished = expanded_sum(s, i, self._vectors, known)
            zero = None
            if expr == 0:
                known[symbol] = zeros.behind([entry for entry, _ in vanished], known)
                zero = str(Reason(known[symbol], "it vanishes identically"))
            result.append(Intermediate(symbol, expr, s.section, s.source, s.described(i), zero))
        return tuple(result), known

    def product(self, a: Field, b: Field) -> sp.Expr:
        """The integral int rho a . b over the body, for a generic index i if a or b holds PHI."""
        return total(a, b, self.moments)

    def sums_without(self, vanishing: Iterable[sp.Basic] = ()) -> ExpandedSums:
        """The sums without a name of their own, expanded, without the parts that vanish.

        A sum that refers to an earlier one contains its expansion. One whose parts all vanish keeps them, so that they
        are known where it occurs.
        """
        exprs: dict[sp.Symbol, sp.Expr] = {}
        absent: dict[sp.Symbol, tuple[AbsentPart, ...]] = {}
        earlier: set[tuple[Family, int]] = set()
        known = {*vanishing}
        for s in self.row_sums:
            entries = (*(entry for _, entry in s.sums), *([s.offset] if s.offset else []))
            refers = any((e.identity.family, e.identity.derivative) in earlier for e in entries)
            for i in range(1, len(self.alpha) + 1) if s.indexed else (0,):
                symbol = exchanged(s.symbol, {I: i})
                expr, gone = expanded_sum(s, i, self._vectors, known)
                if expr == 0:
                    known.add(symbol)
                    expr, gone = expanded_sum(s, i, self._vectors)
                exprs[symbol] = sp.expand(expr.xreplace(exprs)) if refers else expr
                absent[symbol] = tuple(gone)
            earlier.add((s.symbol.identity.family, s.symbol.identity.derivative))
        return ExpandedSums(exprs, absent)

    @cached_property
    def _vectors(self) -> Vectors:
        """The symbols of the factors of sums, shape by shape."""
        alphaddot = tuple(row.a for row in self.rows[len(self.rows) - len(self.alpha) :])
        return {ALPHA: self.alpha, ALPHADOT: self.alphadot, ALPHADDOT: alphaddot}


@dataclass(frozen=True)
class ExpandedSums:
    """The expanded sums over the shapes by their symbols, and the vanishing parts that they leave out."""

    exprs: Mapping[sp.Symbol, sp.Expr]
    absent: Mapping[sp.Symbol, tuple[AbsentPart, ...]]

    def put_in(self, expr: sp.Expr) -> sp.Expr:
        """Replace the sums in an expression by their expansions; the result is expanded."""
        known = self.exprs.get(expr)
        if known is not None:
            return known
        return sp.expand(expr.xreplace(self.exprs)) if expr.free_symbols & self.exprs.keys() else expr


def _every(indexed_sums: Iterable[IndexedSum], n: int) -> Iterator[tuple[IndexedSum, int]]:
    """Yield each sum with the number of each shape, moment by moment; with 0 if it is not indexed by a shape."""
    for _, group in groupby(indexed_sums, lambda s: s.section):
        members = tuple(group)
        for i in range(1, n + 1) if members[0].indexed else (0,):
            for s in members:
                yield s, i
