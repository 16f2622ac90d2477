"""Folding, exact numbers and what goes to setup."""

from __future__ import annotations

from fractions import Fraction

import casadi as ca
import pytest
import sympy as sp

from derive.ir.expressions import Number, Operation, Operator, ScalarRef
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.graph import Constants, Graph, read_expressions

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
    assert lowered(X * (C * D + 1), constants) == Operation(Operator.MUL, (ScalarRef("x"), ScalarRef("constant_1")))
    assert list(constants.hoisted.values()) == ["inverse_c", "constant_1"]


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
