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

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.symbols import Family, quantity
from derive.mechanics.terms import Intermediate, Term
from derive.roles import Source

if TYPE_CHECKING:
    from derive.mechanics.motion.body_motion import Motion


def field_weight(p: int, i: int, j: int) -> sp.Symbol:
    """The symbol of the field weight z_pij = z_pji."""
    return quantity(Family.FIELD_WEIGHT, shapes=(p, *sorted((i, j))))


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
            tangents = [self._tangent(p, i) for i in self._shapes]
            define(self._beta(p), _dot(tangents, alpha) / 2, f"amplitude of theta_{p}")
            define(self._beta(p, 1), _dot(tangents, rates), f"rate of beta_{p}")
            bias = sp.Add(*(_dot(row, rates) * rate for row, rate in zip(weights, rates, strict=True)))
            define(self._beta(p, 2), sp.expand(bias), f"second derivative of beta_{p} without accelerations")
        return tuple(result)

    def put_in(self, expr: sp.Expr) -> sp.Expr:
        """Substitute the amplitudes of the shapes into an expression of the larger family."""
        if not self.numbers:
            return expr
        n, result = len(self.motion.alpha), {}
        for p, row in zip(self.numbers, self.of_fields.rows[-len(self.numbers) :], strict=True):
            tangents = [self._tangent(p, i) for i in self._shapes]
            result[self.of_fields.alpha[n + p - 1]] = self._beta(p)
            result[row.v] = self._beta(p, 1)
            result[row.a] = _dot(tangents, self.motion.alphaddot) + self._beta(p, 2)
        return sp.expand(expr.xreplace(result))

    def projected(self, terms: Iterable[Term]) -> tuple[Term, ...]:
        """The terms of the larger family, where the rows of its fields are projected on the rows of the shapes."""
        rows = {str(a): p for p, a in zip(self.numbers, self.of_fields.alpha[len(self.motion.alpha) :], strict=True)}
        kept: list[Term] = []
        moved: dict[tuple[str, str], list[sp.Expr]] = {}
        for term in terms:
            expr = self.put_in(term.expr)
            if term.row not in rows:
                kept.append(replace(term, expr=expr))
                continue
            for i, alpha in zip(self._shapes, self.motion.alpha, strict=True):
                moved.setdefault((str(alpha), term.name), []).append(self._tangent(rows[term.row], i) * expr)
        added = (
            Term(row, f"{name}, second order", Source.SECOND_ORDER, sp.expand(sp.Add(*exprs)))
            for (row, name), exprs in moved.items()
        )
        return (*kept, *added)

    @property
    def _shapes(self) -> range:
        return range(1, len(self.motion.alpha) + 1)

    def _tangent(self, p: int, i: int) -> sp.Symbol:
        return quantity(Family.FIELD_TANGENT, shapes=(p, i))

    def _beta(self, p: int, derivative: int = 0) -> sp.Symbol:
        return quantity(Family.FIELD_AMPLITUDE, derivative=derivative, shapes=(p,))


def _dot(a: Iterable[sp.Expr], b: Iterable[sp.Expr]) -> sp.Expr:
    return sp.Add(*(x * y for x, y in zip(a, b, strict=True)))
