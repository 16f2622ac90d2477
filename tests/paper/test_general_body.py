"""(15) and (20) for any body in space against the derivation, row by row, with free shape integrals."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import pytest
import sympy as sp

from derive.mechanics.bodies.spatial_tables import DOCS
from derive.mechanics.body import Body, ExactValues
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import derive_body
from derive.mechanics.motion.spatial import PAIRS, quaternion_rates, rotation_of, symbols_of_rotation
from derive.mechanics.motion.vectors import skew
from derive.mechanics.symbols import Family, pair, parameter, quantity
from derive.mechanics.tables import CoefficientTable, TableKind
from derive.mechanics.terms import ModelConstant
from paper.printed_general import General, PrintedVector, axial, equation_15, first, gram, tensor
from plain_symbols import plain

if TYPE_CHECKING:
    from derive.mechanics.typed_symbol import Symbol

ROTATION = plain(symbols_of_rotation())
MEAN = "a condition of the test"


def values(n: int, mean: bool) -> dict[Symbol, sp.Expr]:
    """The shape integrals of the derivation in terms of the free moments; (17), (19) and a centred
    reference if asked for."""
    found: dict[Symbol, sp.Expr] = {}
    shapes = range(1, n + 1)
    nothing = 0 if mean else 1
    for k in range(3):
        found[quantity(Family.C1, k + 1)] = nothing * first(0)[k]
        found |= {quantity(Family.C2, k + 1, shapes=(i,)): nothing * first(i)[k] for i in shapes}
        found |= {quantity(Family.C6, k + 1, shapes=(i,)): nothing * axial(0, i)[k] for i in shapes}
        found |= {pair(Family.C7, i, j, k + 1): axial(i, j)[k] for i in shapes for j in shapes if i < j}
    for a, b in PAIRS:
        found[quantity(Family.C3, a, b)] = _symmetric(0, 0)[a - 1, b - 1]
        for i in shapes:
            found[quantity(Family.C4, a, b, shapes=(i,))] = _symmetric(i, 0)[a - 1, b - 1]
            found |= {pair(Family.C5, i, j, a, b): _symmetric(i, j)[a - 1, b - 1] for j in shapes if i <= j}
    found |= {pair(Family.C8, i, j): gram(i, j).trace() for i in shapes for j in shapes if i <= j}
    return found


def _symmetric(p: int, q: int) -> sp.Matrix:
    full = tensor(p, q)
    return (full + full.T) / 2


@cache
def derived(n: int, mean: bool = False) -> Equations:
    integrals = tuple(
        ModelConstant(symbol, value, "", "", "", MEAN if value == 0 else None)
        for symbol, value in values(n, mean).items()
    )
    tables = tuple(CoefficientTable(family, TableKind.FULL, *doc) for family, doc in DOCS.items())
    return derive_body(Body("general", "", "", 3, n, parameter("m"), tables, ExactValues(integrals))).expanded()


def expanded_sum(eq: Equations, expr: sp.Expr) -> sp.Expr:
    """All but the rotation tensor, which both sides keep as nine symbols; in plain symbols."""
    for definition in reversed(eq.definitions):
        if definition.section != "Q":
            expr = expr.xreplace({definition.symbol: definition.expr})
    return plain(sp.expand(expr.xreplace({c.symbol: c.value for c in eq.coefficients})))


@cache
def derived_rows(n: int, mean: bool = False) -> dict[str, tuple[sp.Expr, ...]]:
    eq = derived(n, mean)
    rows = {row.name: expanded_sum(eq, eq.sum_of(row.name)) for row in eq.rows}
    vectors = {"c": tuple(rows[f"c{k}"] for k in (1, 2, 3)), "pi": tuple(rows[f"pi{k}"] for k in (1, 2, 3))}
    return vectors | {f"alpha{i}": (rows[f"alpha{i}"],) for i in range(1, n + 1)}


@cache
def expanded_once(expr: sp.Expr) -> sp.Expr:
    return sp.expand(expr)


def differing(terms: tuple[PrintedVector, ...], rows: dict[str, tuple[sp.Expr, ...]]) -> set[str]:
    """The rows that are not the sums of their terms; monomials of what is expanded cancel without being expanded."""
    different = set()
    for row, found in rows.items():
        of_row = [t.expr for t in terms if t.row == row]
        for k, expected in enumerate(found):
            printed = (expanded_once(expr[k]) for expr in of_row)
            if sp.Add(*printed, *sp.Add.make_args(-expanded_once(expected))) != 0:
                different.add(row)
    return different


@pytest.mark.parametrize("n", [0, 1, 2, pytest.param(3, marks=pytest.mark.long)])
def test_equations_are_15(n: int) -> None:
    assert differing(equation_15(General(n), ROTATION), derived_rows(n)) == set()


@pytest.mark.parametrize("index", range(len(equation_15(General(2), ROTATION))))
@pytest.mark.parametrize("sign", [0, pytest.param(-1, marks=pytest.mark.long)])
def test_a_changed_term_of_15_is_noticed(index: int, sign: int) -> None:
    terms = list(equation_15(General(2), ROTATION))
    changed = terms[index]
    terms[index] = PrintedVector(changed.row, changed.text, sign * changed.expr)
    assert differing(tuple(terms), derived_rows(2)) == {changed.row}


@pytest.mark.parametrize("n", [1, 2, pytest.param(3, marks=pytest.mark.long)])
def test_mean_conditions_give_20(n: int) -> None:
    """(20) is (15) without d1 and c2, and with d3 = - c7 alpha, since c6 vanishes: the remark under (19)."""
    nothing = {s: 0 for p in range(n + 1) for s in first(p)}
    for i in range(1, n + 1):
        g = gram(0, i)
        nothing |= {g[a, b]: g[b, a] for a in range(3) for b in range(a)}
    terms = equation_15(General(n), ROTATION)
    mean = tuple(PrintedVector(t.row, t.text, t.expr.applyfunc(lambda e: e.xreplace(nothing))) for t in terms)
    gone = {t.text for t in mean if t.expr.applyfunc(sp.expand).is_zero_matrix}
    assert {"Q . [w x (w x d1)]", "Q . [wdot x d1]", "d1 x (Q^c . cddot)", "cddot . (Q . c2)"} <= gone
    rows = {row: tuple(e.xreplace(nothing) for e in found) for row, found in derived_rows(n, mean=True).items()}
    assert differing(mean, rows) == set()
    assert all(v.reason for v in derived(n, mean=True).vanished)
    assert not any(derived(n, mean=True).mass[i, j] for i in range(3) for j in range(3, 6 + n))


def test_quaternion_turns_as_omega_says() -> None:
    """Q^T Qdot = omega x on the unit sphere, and qdot keeps it there."""
    e, w = sp.symbols("e0:4"), sp.symbols("omega1:4")
    rates = quaternion_rates(e, w)
    assert sp.expand(sum(a * b for a, b in zip(e, rates, strict=True))) == 0
    q = rotation_of(e)
    qdot = sum((q.diff(a) * b for a, b in zip(e, rates, strict=True)), sp.zeros(3, 3))
    on_sphere = {e[0] ** 2: 1 - e[1] ** 2 - e[2] ** 2 - e[3] ** 2}

    def reduced(expr: sp.Expr) -> sp.Expr:
        return sp.rem(sp.expand(expr), e[0] ** 2 - on_sphere[e[0] ** 2], e[0])

    assert (q.T * qdot - skew(w)).applyfunc(reduced) == sp.zeros(3, 3)
    assert (q.T * q - sp.eye(3)).applyfunc(reduced) == sp.zeros(3, 3)
