"""Derivatives of the generic equations with respect to the shapes' coordinates, rates and accelerations.

A total or a contraction changes by its table: d S_l / d alpha_j = C5_lj. Where such a derivative is summed again, as in
sum alpha_l C5_lj, the sum is recognised as an existing table sum, or becomes a new one.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.sums import ALPHA, ALPHADDOT, ALPHADOT, PARITY, TableSum, canonical, exchanged, swapped
from derive.mechanics.symbols import Family, I, J, is_indexed, quantity

if TYPE_CHECKING:
    from derive.mechanics.typed_symbol import Symbol

SUMS = {
    Family.C5: Family.C5_SUM,
    Family.C7: Family.C7_SUM,
    Family.C8: Family.C8_SUM,
    Family.C9: Family.C9_SUM,
    Family.C10: Family.C10_SUM,
}
"""The name of the sum of a table over one of its indices with rates or accelerations."""

AMPLITUDE_SUMS = SUMS | {Family.C7: Family.C7_AMPLITUDES, Family.C10: Family.C10_AMPLITUDES}
"""The name of the sum of a table over one of its indices with amplitudes; `c7` and `c10` name the tables themselves."""

DERIVATIVES = {ALPHA: 0, ALPHADOT: 1, ALPHADDOT: 2}


class Gradient:
    """Derivatives of expressions of one model; `table_sums` are those of the model and those that its
    derivatives need in addition.

    `factor` is the variable of differentiation: ALPHA, ALPHADOT or ALPHADDOT.
    """

    def __init__(self, equations: IndexedEquations) -> None:
        self.mode_sums = {t.symbol: t for t in equations.mode_sums}
        self.table_sums = list(equations.table_sums)

    def of_scalar(self, expr: sp.Expr, factor: Symbol) -> sp.Expr:
        """d expr / d factor_i, as an expression of index i, of an expression in mode sums."""
        present = expr.free_symbols
        pairs = ((t, derivative(expr, symbol)) for symbol, t in self.mode_sums.items() if symbol in present)
        return sp.expand(sum((weight * self._of_sum(total.term, factor) for total, weight in pairs), sp.S.Zero))

    def of_row(self, expr: sp.Expr, factor: Symbol) -> tuple[sp.Expr, sp.Expr]:
        """d expr_i / d factor_j, split into a part in tables (i, j) and a part on the diagonal, in index i."""
        full = sp.S.Zero
        for contraction in self._in(expr):
            weight = derivative(expr, contraction.symbol)
            for other, entry in contraction.sums:
                full += weight * _of_ij(entry) if other == factor else 0
        return sp.expand(full), sp.expand(derivative(expr, exchanged(factor, {J: I})))

    def _in(self, expr: sp.Expr) -> list[TableSum]:
        present = expr.free_symbols
        return [c for c in self.table_sums if c.symbol in present]

    def _of_sum(self, term: sp.Expr, factor: Symbol) -> sp.Expr:
        """d (sum over l of term_l) / d factor_i."""
        result = derivative(sp.expand(term), exchanged(factor, {J: I}))
        for contraction in self._in(term):
            weight = sp.expand(derivative(term, contraction.symbol))
            for other, entry in contraction.sums:
                if other == factor:
                    result += self._contracted(weight, entry)
        return result

    def _contracted(self, expr: sp.Expr, entry: Symbol) -> sp.Expr:
        """sum over l of expr_l entry_li; `entry` has generic indices, of which l is the first and i the second."""
        weight, symbol = expr.as_coeff_Mul()
        factor = exchanged(symbol, {I: J}) if is_indexed(symbol) else None
        if factor not in DERIVATIVES:
            raise ArithmeticError(
                f"the derivative of a sum has the factor {expr}, which is no sequence over the shapes"
            )
        exchanged_entry, parity = swapped(entry), PARITY[entry.identity.family]
        for c in self.table_sums:
            if c.sums == ((factor, exchanged_entry),):
                return weight * (c.symbol - c.offset)
            if c.sums == ((factor, entry),):
                return weight * parity * (c.symbol - c.offset)
        kept = canonical(entry)
        names, components = AMPLITUDE_SUMS if factor == ALPHA else SUMS, entry.identity.components
        family = names[entry.identity.family]
        new = quantity(family, *components, derivative=DERIVATIVES[factor], shapes=(I,))
        doc = f"sum over the modes of {factor} {kept}"
        self.table_sums.append(TableSum(new, sp.S.Zero, ((factor, kept),), doc))
        return weight * (1 if exchanged_entry == kept else parity) * new


def derivative(expr: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
    """d expr / d symbol of an expression of +, * and integer powers, for which SymPy takes several times as long."""
    if expr.is_Symbol:
        return sp.S.One if expr == symbol else sp.S.Zero
    if expr.is_Add:
        return sp.Add(*(derivative(term, symbol) for term in _terms_with(expr).get(symbol, ())))
    if expr.is_Mul:
        factors = expr.args
        changing = (k for k, factor in enumerate(factors) if not factor.is_Rational)
        changes = ((k, change) for k in changing if (change := derivative(factors[k], symbol)) is not sp.S.Zero)
        return sp.Add(*(sp.Mul(*factors[:k], change, *factors[k + 1 :]) for k, change in changes))
    if expr.is_Pow and expr.exp.is_Integer:
        change = derivative(expr.base, symbol)
        return sp.S.Zero if change is sp.S.Zero else expr.exp * expr.base ** (expr.exp - 1) * change
    return expr.diff(symbol)


@lru_cache(maxsize=256)
def _terms_with(expr: sp.Expr) -> dict[sp.Basic, list[sp.Expr]]:
    """The terms of a sum by their symbols: it is differentiated by many of them."""
    result: dict[sp.Basic, list[sp.Expr]] = {}
    for term in expr.args:
        for symbol in term.free_symbols:
            result.setdefault(symbol, []).append(term)
    return result


def _of_ij(entry: Symbol) -> sp.Expr:
    """An entry as a symbol whose indices are in the order i, j."""
    kept = canonical(entry)
    return kept if kept == entry else PARITY[entry.identity.family] * kept
