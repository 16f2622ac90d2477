"""The terms of the equations of motion by the values of M and h that they are part of, for the maps of sources."""

from __future__ import annotations

import sympy as sp

from derive.ir.model import ModelTerm
from derive.ir.patterns import Pattern
from derive.mechanics.equations import Equations
from derive.mechanics.sums import exchanged
from derive.mechanics.symbols import I, J


def model_terms(equations: Equations, pattern: Pattern) -> tuple[ModelTerm, ...]:
    """Each term of the equations with its values; `pattern` is that of the mass matrix M, lower triangle.

    A term with accelerations is a part of M, any other a part of h. With sums over the modes, the last equation stands
    for those of all modes, so that its terms are part of all values of these.
    """
    names = [row.name for row in equations.rows]
    accelerations = {row.a: k for k, row in enumerate(equations.rows)}
    # The equation that stands for those of all modes, if there is one; otherwise beyond the last.
    of_modes = len(names) - (equations.indexed and equations.modes > 0)
    entries = [tuple(sorted((min(i, of_modes), min(j, of_modes)))) for i, j in pattern.entries]
    sums = _sums(equations)
    result = []
    for term in equations.terms:
        row = names.index(term.row)
        columns = {k for a, k in accelerations.items() if a in _symbols(term.expr, sums)}
        pairs = {(min(row, column), max(row, column)) for column in columns}
        mass = tuple(k for k, entry in enumerate(entries) if entry in pairs)
        count = equations.modes if row == of_modes else 1
        force = () if columns else tuple(range(row, row + count))
        result.append(ModelTerm(term.row, term.name, term.equation, mass, force))
    return tuple(result)


def _sums(equations: Equations) -> dict[sp.Symbol, sp.Expr]:
    """What is added up in each sum over the modes."""
    if not equations.indexed:
        return {}
    result = {t.symbol: t.term for t in equations.mode_sums}
    return result | {
        c.symbol: sp.Add(*(exchanged(factor, {J: I}) * entry for factor, entry in c.sums)) for c in equations.table_sums
    }


def _symbols(expr: sp.Expr, sums: dict[sp.Symbol, sp.Expr]) -> set[sp.Symbol]:
    """All symbols in an expression and in the sums that it is made of."""
    result, fresh = set(), set(expr.free_symbols)
    while fresh:
        result |= fresh
        fresh = {s for f in fresh if f in sums for s in sums[f].free_symbols} - result
    return result
