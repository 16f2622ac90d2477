"""The full second-order motion of a planar body: nothing of the displacement field is dropped. Beyond the paper.

The Psi_ij of u = sum alpha_i Phi_i + 1/2 sum alpha_i alpha_j Psi_ij are combinations of fields theta_p,
Psi_ij = sum z_pij theta_p. So

    u = sum alpha_i Phi_i + sum beta_p theta_p,   beta_p = 1/2 sum z_pij alpha_i alpha_j,

is a displacement of first order in the larger family of fields Phi_1 .. Phi_N, theta_1 .. theta_P, whose shape
integrals are c1 to c8, with amplitudes beta_p that depend on the others:

    delta beta_p = sum dbeta_pi delta alpha_i,   betaddot_p = sum dbeta_pi alphaddot_i + sum z_pij alphadot_i alphadot_j

with dbeta_pi = sum z_pij alpha_j. The equations are those of the larger family with these amplitudes put in, where the
row of alpha_i is what the rows of the beta_p add to it, since the virtual displacement of alpha_i moves them along.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.symbols import Family, quantity
from derive.mechanics.terms import Intermediate, Term
from derive.roles import Source

if TYPE_CHECKING:
    from derive.mechanics.motion.body_motion import Motion
    from derive.mechanics.typed_symbol import Symbol


def field_weight(p: int, i: int, j: int) -> sp.Symbol:
    """The symbol of the field weight z_pij = z_pji."""
    return quantity(Family.FIELD_WEIGHT, shapes=(p, *sorted((i, j))))


@dataclass(frozen=True)
class ProjectedTerms:
    """Terms in the amplitudes of the shapes, and what vanishes in them by the row and the acceleration there."""

    terms: tuple[Term, ...]
    absent: Mapping[tuple[str, sp.Expr], list[Symbol]]


@dataclass(frozen=True)
class DependentAmplitudes:
    """The amplitudes of the fields theta_p, of which there may be none, as functions of those of the shapes.

    motion: the motion in the amplitudes of the shapes; of_fields: the motion in the larger family of fields.
    """

    motion: Motion
    of_fields: Motion

    @property
    def numbers(self) -> range:
        """The numbers p of the fields."""
        return range(1, len(self.of_fields.alpha) - len(self.motion.alpha) + 1)

    @property
    def definitions(self) -> tuple[Intermediate, ...]:
        """The definitions of dbeta_pi, of beta_p, of its rate, and of its second derivative without the alphaddot_i."""
        alpha, rates = self.motion.alpha, self.motion.alphadot
        result = []

        def define(symbol: sp.Symbol, expr: sp.Expr, doc: str) -> None:
            result.append(Intermediate(symbol, expr, "beta", Source.SECOND_ORDER, doc))

        for p in self.numbers:
            weights = [[field_weight(p, i, j) for j in self._shapes] for i in self._shapes]
            for i, row in zip(self._shapes, weights, strict=True):
                define(self._tangent(p, i), _dot(row, alpha), f"derivative of beta_{p} by alpha_{i}")
            tangents = self._tangents(p)
            define(self._beta(p), _dot(tangents, alpha) / 2, f"amplitude of theta_{p}")
            define(self._beta(p, 1), _dot(tangents, rates), f"rate of beta_{p}")
            bias = sp.Add(*(_dot(row, rates) * rate for row, rate in zip(weights, rates, strict=True)))
            define(self._beta(p, 2), sp.expand(bias), f"second derivative of beta_{p} without accelerations")
        return tuple(result)

    def put_in(self, expr: sp.Expr, vanishing: Container[sp.Basic] = ()) -> sp.Expr:
        """Substitute the amplitudes of the shapes into an expression of the larger family.

        vanishing: symbols that are zero, by which nothing is multiplied.
        """
        if not self.numbers:
            return expr
        parts: list[sp.Expr] = []
        for summand in sp.Add.make_args(expr):
            if not any(symbol in vanishing for symbol in summand.free_symbols):
                parts += self._summands(summand, vanishing)
        return sp.Add(*parts)

    def _summands(self, product: sp.Expr, vanishing: Container[sp.Basic]) -> Iterator[sp.Expr]:
        """The summands of a product of the larger family, multiplied out.

        A product of symbols contains at most one acceleration, whose sum is multiplied out here: SymPy takes several
        times as long, as it looks for powers and fractions to expand.
        """
        factors = sp.Mul.make_args(product)
        known, sums = self._replaced
        if not all(f.is_Atom or (f.is_Pow and f.base.is_Atom and f.base not in sums) for f in factors):
            every = {a: sp.Add(*(t * x for t, x in of if t not in vanishing)) for a, of in sums.items()}
            yield from sp.Add.make_args(sp.expand(product.xreplace(known | every)))
            return
        accelerations = [f for f in factors if f in sums]
        assert len(accelerations) <= 1, "the equations are linear in the accelerations"
        beside = [known.get(f) or f.xreplace(known) for f in factors if f not in sums]
        if not accelerations:
            yield sp.Mul(*beside)
        for tangent, acceleration in sums[accelerations[0]] if accelerations else ():
            if tangent not in vanishing:
                yield sp.Mul(*beside, tangent, acceleration)

    @cached_property
    def _replaced(self) -> tuple[dict[sp.Basic, sp.Expr], dict[sp.Basic, list[tuple[sp.Expr, sp.Expr]]]]:
        """The amplitudes of the fields and their rates; and their accelerations as sums of products of two factors."""
        n = len(self.motion.alpha)
        known: dict[sp.Basic, sp.Expr] = {}
        sums: dict[sp.Basic, list[tuple[sp.Expr, sp.Expr]]] = {}
        for p, row in zip(self.numbers, self.of_fields.rows[-len(self.numbers) :], strict=True):
            known |= {self.of_fields.alpha[n + p - 1]: self._beta(p), row.v: self._beta(p, 1)}
            products = [*zip(self._tangents(p), self.motion.alphaddot, strict=True), (self._beta(p, 2), sp.S.One)]
            sums[row.a] = products
        return known, sums

    def projected(self, terms: Iterable[Term], vanishing: Container[sp.Basic]) -> ProjectedTerms:
        """The terms of the larger family, where the rows of its fields are projected on the rows of the shapes.

        vanishing: the symbols that are zero. Products with them are left out before they are multiplied out, unless a
        term vanishes altogether; the factors of accelerations that they are parts of have them in `absent`.
        """
        if not self.numbers:
            return ProjectedTerms(tuple(terms), {})
        rows = {str(a): p for p, a in zip(self.numbers, self.of_fields.alpha[len(self.motion.alpha) :], strict=True)}
        kept: list[Term] = []
        absent: dict[tuple[str, sp.Expr], list[Symbol]] = {}
        moved: dict[tuple[str, str], list[tuple[sp.Symbol, Term, sp.Expr]]] = {}
        whole = cache(self.put_in)
        for term in terms:
            expr, factors = self.put_in(term.expr, vanishing), self._absent_factors(term.expr, vanishing)
            targets: list[tuple[str, sp.Expr]] = [(term.row, sp.S.One)]
            if term.row in rows:
                tangents = self._tangents(rows[term.row])
                targets = [(str(alpha), tangent) for alpha, tangent in zip(self.motion.alpha, tangents, strict=True)]
                for row, tangent in targets:
                    moved.setdefault((row, term.name), []).append((tangent, term, expr))
            else:
                kept.append(replace(term, expr=expr if expr != 0 else self.put_in(term.expr)))
            for row, tangent in targets:
                own = [tangent] if tangent in vanishing else []
                for factor, symbols in factors:
                    absent.setdefault((row, factor), []).extend([*symbols, *own])
        for (row, name), parts in moved.items():
            total = sp.Add(
                *(t * summand for t, _, expr in parts if t not in vanishing for summand in sp.Add.make_args(expr))
            )
            if total == 0:  # the reasons are in the products that vanish
                total = sp.Add(*(t * summand for t, term, _ in parts for summand in sp.Add.make_args(whole(term.expr))))
            kept.append(Term(row, f"{name}, second order", Source.SECOND_ORDER, total))
        return ProjectedTerms(tuple(kept), absent)

    def _absent_factors(self, expr: sp.Expr, vanishing: Container[sp.Basic]) -> list[tuple[sp.Expr, list[Symbol]]]:
        """The accelerations in the summands of an expression of the larger family, and what vanishes beside them."""
        result: list[tuple[sp.Expr, list[Symbol]]] = []
        accelerations = {row.a: 0 for row in self.of_fields.rows}
        accelerations |= {
            row.a: p for p, row in zip(self.numbers, self.of_fields.rows[-len(self.numbers) :], strict=True)
        }
        for summand in sp.Add.make_args(expr):
            gone = [symbol for symbol in summand.free_symbols if symbol in vanishing]
            for symbol in summand.free_symbols & accelerations.keys():
                if not (p := accelerations[symbol]):
                    result.append((symbol, gone))
                    continue
                for tangent, of_shape in zip(self._tangents(p), self.motion.alphaddot, strict=True):
                    result.append((of_shape, [*gone, tangent] if tangent in vanishing else gone))
        return result

    @property
    def _shapes(self) -> range:
        return range(1, len(self.motion.alpha) + 1)

    def _tangent(self, p: int, i: int) -> sp.Symbol:
        return quantity(Family.FIELD_TANGENT, shapes=(p, i))

    def _tangents(self, p: int) -> list[sp.Symbol]:
        return [self._tangent(p, i) for i in self._shapes]

    def _beta(self, p: int, derivative: int = 0) -> sp.Symbol:
        return quantity(Family.FIELD_AMPLITUDE, derivative=derivative, shapes=(p,))


def _dot(a: Iterable[sp.Expr], b: Iterable[sp.Expr]) -> sp.Expr:
    return sp.Add(*(x * y for x, y in zip(a, b, strict=True)))
