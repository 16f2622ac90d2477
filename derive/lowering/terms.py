"""The source map of the terms of the equations of motion: the values of M and h to which each term contributes."""

from __future__ import annotations

from derive.algebra import sp
from derive.ir.model import ModelTerm
from derive.ir.patterns import Pattern
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.sums import of_index
from derive.mechanics.symbols import I, J


def model_terms(equations: Equations, pattern: Pattern) -> tuple[ModelTerm, ...]:
    """The terms of the equations with the indices of the values of M and h to which they contribute.

    pattern: that of the lower triangle of the mass matrix M. A term with accelerations contributes to M, any other to
    h. In indexed equations the last one stands for the equations of all modes, so that its terms contribute to all of
    their values.
    """
    names = [row.name for row in equations.rows]
    accelerations = {row.a: k for k, row in enumerate(equations.rows)}
    # The row of the indexed equation of the modes; beyond the last row if there is none.
    of_modes = len(names) - (isinstance(equations, IndexedEquations) and equations.modes > 0)
    entries = [tuple(sorted((min(i, of_modes), min(j, of_modes)))) for i, j in pattern.entries]
    sums = _sums(equations)
    result = []
    for term in equations.terms:
        row = names.index(term.row)
        columns = {accelerations[s] for s in _symbols(term.expr, sums) & accelerations.keys()}
        pairs = {(min(row, column), max(row, column)) for column in columns}
        mass = tuple(k for k, entry in enumerate(entries) if entry in pairs)
        count = equations.modes if row == of_modes else 1
        force = () if columns else tuple(range(row, row + count))
        result.append(ModelTerm(term.row, term.name, term.equation, mass, force))
    return tuple(result)


def _sums(equations: Equations) -> dict[sp.Symbol, sp.Expr]:
    """The summand of each sum over the modes, by the symbol of the sum; empty if the equations are not indexed."""
    if not isinstance(equations, IndexedEquations):
        return {}
    result = {t.symbol: t.term for t in equations.mode_sums}
    return result | {
        c.symbol: sp.Add(*(of_index(factor, I, J) * entry for factor, entry in c.sums)) for c in equations.table_sums
    }


def _symbols(expr: sp.Expr, sums: dict[sp.Symbol, sp.Expr]) -> set[sp.Symbol]:
    """All symbols in an expression and in the summands of its sums."""
    result, new = set(), set(expr.free_symbols)
    while new:
        result |= new
        new = {s for f in new if f in sums for s in sums[f].free_symbols} - result
    return result
