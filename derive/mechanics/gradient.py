"""Derivatives of the generic equations with respect to the shapes' coordinates, rates and accelerations.

A total or a contraction changes by its table: d S_l / d alpha_j = C5_lj. Where such a derivative is summed again, as in
sum alpha_l C5_lj, the sum is recognised as a contraction that is there already, or becomes a new one.
"""

from __future__ import annotations

import sympy as sp

from derive.mechanics.indexed_equations import Contraction, GenericEquations, is_indexed
from derive.mechanics.series import PARITY, family, swapped

DOTS = {"alpha": "", "alphadot": "dot", "alphaddot": "ddot"}


class Gradient:
    """Derivatives of expressions of one model; `contractions` are its own and those that derivatives need besides."""

    def __init__(self, equations: GenericEquations) -> None:
        self.totals = {sp.Symbol(t.name): t for t in equations.totals}
        self.contractions = list(equations.contractions)

    def of_scalar(self, expr: sp.Expr, vector: str) -> sp.Expr:
        """d expr / d vector_i, as an expression of index i, of an expression in totals."""
        factors = ((total, expr.diff(symbol)) for symbol, total in self.totals.items() if expr.has(symbol))
        return sp.expand(sum((factor * self._of_sum(total.term, vector) for total, factor in factors), sp.S.Zero))

    def of_row(self, expr: sp.Expr, vector: str) -> tuple[sp.Expr, sp.Expr]:
        """d expr_i / d vector_j, split into a part in tables (i, j) and a part on the diagonal, in index i."""
        full = sp.S.Zero
        for contraction in self._in(expr):
            factor = expr.diff(sp.Symbol(contraction.name))
            for name, entry in contraction.sums:
                full += factor * _of_ij(entry) if name == vector else 0
        return sp.expand(full), sp.expand(expr.diff(sp.Symbol(f"{vector}_i")))

    def _in(self, expr: sp.Expr) -> list[Contraction]:
        return [c for c in self.contractions if expr.has(sp.Symbol(c.name))]

    def _of_sum(self, term: sp.Expr, vector: str) -> sp.Expr:
        """d (sum over l of term_l) / d vector_i."""
        found = sp.expand(term).diff(sp.Symbol(f"{vector}_i"))
        for contraction in self._in(term):
            factor = sp.expand(term.diff(sp.Symbol(contraction.name)))
            for name, entry in contraction.sums:
                if name == vector:
                    found += self._contracted(factor, entry)
        return found

    def _contracted(self, factor: sp.Expr, entry: str) -> sp.Expr:
        """sum over l of factor_l entry_li, where `entry` is written for i and j: l stands first, i second."""
        weight, symbol = factor.as_coeff_Mul()
        if not (symbol.is_Symbol and is_indexed(symbol)):
            raise ArithmeticError(
                f"the derivative of a sum has the factor {factor}, which is no sequence over the shapes"
            )
        vector = family(symbol.name)
        turned = swapped(entry)
        for c in self.contractions:
            if c.sums == ((vector, turned),):
                return weight * (sp.Symbol(c.name) - c.base)
            if c.sums == ((vector, entry),):
                return weight * PARITY[family(entry)] * (sp.Symbol(c.name) - c.base)
        head, *indices = entry.split("_")
        rest = [part for part in indices if part not in ("i", "j")]
        name = "_".join([f"{head}{DOTS[vector]}", "i", *rest])
        kept = "_".join([head, "i", "j", *rest])
        doc = f"sum over the shapes of {vector}_j {kept}"
        self.contractions.append(Contraction(name, sp.S.Zero, ((vector, kept),), doc))
        sign = 1 if turned == kept else PARITY[head]
        return weight * sign * sp.Symbol(name)


def _of_ij(entry: str) -> sp.Expr:
    """An entry as a symbol whose indices are in the order i, j."""
    parts = entry.split("_")
    if parts.index("i") < parts.index("j"):
        return sp.Symbol(entry)
    return PARITY[parts[0]] * sp.Symbol(swapped(entry))
