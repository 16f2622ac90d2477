"""Folding, exact numbers and what goes to setup."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import casadi as ca
import pytest
import sympy as sp

from derive.ir.expressions import Number, Operation, Operator, ScalarRef
from derive.lowering.flat.casadi_instructions import read_expressions
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.graph import Graph
from derive.lowering.flat.setup_constants import Constants

X, Y, C, D = sp.symbols("x y c d")
NONE: frozenset[sp.Symbol] = frozenset()


def lowered(expr: sp.Expr, constants: Constants) -> object:
    symbols = Symbols(NONE, NONE)
    for symbol in (X, Y, C, D):
        symbols.input(symbol, ScalarRef(symbol.name))
    graph = Graph(constants)
    (node,) = read_expressions(graph, symbols, [symbols(expr)])
    return graph.expr(node)


def coefficients() -> Constants:
    return Constants(frozenset({"c", "d"}))


def num(value: int | Fraction) -> Number:
    return Number(Fraction(value))


@pytest.mark.parametrize(
    ("expr", "expected"),
    [
        (X / 7, Operation(Operator.DIV, (ScalarRef("x"), num(7)))),
        (X / 4, Operation(Operator.MUL, (num(Fraction(1, 4)), ScalarRef("x")))),
        (X * sp.Rational(2, 7), Operation(Operator.MUL, (ScalarRef("x"), num(Fraction(2, 7))))),
        (X**3, Operation(Operator.MUL, (Operation(Operator.MUL, (ScalarRef("x"), ScalarRef("x"))), ScalarRef("x")))),
        (X - Y, Operation(Operator.SUB, (ScalarRef("x"), ScalarRef("y")))),
        (2 * X, Operation(Operator.MUL, (num(2), ScalarRef("x")))),
        (sp.cos(X), Operation(Operator.COS, (ScalarRef("x"),))),
        (sp.sin(X - X), num(0)),
        (C * X, Operation(Operator.MUL, (ScalarRef("c"), ScalarRef("x")))),
    ],
)
def test_numbers_and_powers_stay_exact(expr: sp.Expr, expected: object) -> None:
    found = lowered(expr, coefficients())
    if isinstance(expected, Operation) and expected.kind is Operator.MUL and isinstance(found, Operation):
        assert found.kind is Operator.MUL and set(map(repr, found.args)) == set(map(repr, expected.args))
    else:
        assert found == expected


def test_work_on_coefficients_goes_to_setup_under_a_name() -> None:
    constants = coefficients()
    assert lowered(X / C, constants) == Operation(Operator.MUL, (ScalarRef("x"), ScalarRef("inverse_c")))
    assert lowered(X * (C * D + 1), constants) == Operation(
        Operator.MUL, (ScalarRef("x"), ScalarRef("c_times_d_plus_1"))
    )
    assert list(constants.hoisted.values()) == ["inverse_c", "c_times_d_plus_1"]


@pytest.mark.parametrize(
    ("expr", "name"),
    [
        (X * (2 * C), "c_times_2"),
        (X * (C / 2**44), "c_times_2_pow_minus_44"),
        (X * (sp.Rational(2, 3) - C), "minus_c_plus_2_over_3"),
        (X * (C - D), "c_minus_d"),
        (X * sp.sqrt(C), "sqrt_c"),
    ],
)
def test_constants_are_named_after_their_expressions(expr: sp.Expr, name: str) -> None:
    constants = coefficients()
    lowered(expr, constants)
    assert name in constants.hoisted.values()


def test_two_constants_never_have_one_name() -> None:
    """(c / d) d and c / (d d) have the same words; the second is numbered. So is one that would be too long."""
    constants = Constants(frozenset({"c", "d", "c_over_e", "e", "n" * 50}))
    c, d, e, long = (ScalarRef(name) for name in ("c", "d", "e", "n" * 50))

    def ratio(a: Any, b: Any) -> Operation:
        return Operation(Operator.DIV, (a, b))

    names = [
        constants.name(expr)
        for expr in (
            Operation(Operator.MUL, (ratio(c, d), d)),
            ratio(c, Operation(Operator.MUL, (d, d))),
            ratio(c, e),
            Operation(Operator.MUL, (long, long)),
            ratio(c, d),
            ratio(num(3), d),
        )
    ]
    numbered = ["constant_1", "constant_2", "constant_3"]
    assert names == ["c_over_d_times_d", *numbered, "c_over_d", "inverse_d_times_3"]


def test_a_rounded_number_from_casadi_is_refused() -> None:
    symbols = Symbols(NONE, NONE)
    symbols.input(X, ScalarRef("x"))
    with pytest.raises(ArithmeticError, match="CasADi has rounded"):
        read_expressions(Graph(coefficients()), symbols, [symbols.values[X] * 0.1])


def test_an_operation_without_counterpart_is_refused() -> None:
    symbols = Symbols(NONE, NONE)
    symbols.input(X, ScalarRef("x"))
    with pytest.raises(NotImplementedError, match="no counterpart"):
        read_expressions(Graph(coefficients()), symbols, [ca.tan(symbols.values[X])])
    with pytest.raises(TypeError, match="no lowering for tan"):
        symbols(sp.tan(X))
