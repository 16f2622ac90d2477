"""Folding, exact numbers and what goes to setup."""

from __future__ import annotations

import math
import operator
from fractions import Fraction
from typing import Any

import casadi as ca
import pytest
import sympy as sp

from derive.ir.expressions import Expr, Number, Operation, Operator, ScalarRef
from derive.ir.statements import Let, Store
from derive.lowering.flat.casadi_instructions import read_expressions
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.graph import Graph
from derive.lowering.flat.schedule import LONGEST, OutputValue, Step, schedule
from derive.lowering.flat.setup_constants import Constants

X, Y, C, D = sp.symbols("x y c d")
NONE: frozenset[sp.Symbol] = frozenset()


def lowered(expr: sp.Expr, constants: Constants) -> object:
    symbols = Symbols(NONE, NONE)
    for symbol in (X, Y, C, D):
        symbols.input(symbol, ScalarRef(symbol.name))
    graph = Graph(constants)
    (node,) = read_expressions(graph, symbols, [symbols(expr)])
    assert node is not None
    return graph.expr(node)


def coefficients() -> Constants:
    return Constants(frozenset({"c", "d"}))


def num(value: int | Fraction) -> Number:
    return Number(Fraction(value))


def test_a_sum_of_thousands_of_terms_becomes_several_statements() -> None:
    """No expression is so deep that what reads it recursively, such as this package or a compiler, would give up."""
    terms, scale = 3000, {"x": 0.25, "y": 3.0}
    symbols = Symbols(NONE, NONE)
    for symbol in (X, Y):
        symbols.input(symbol, ScalarRef(symbol.name))
    total = ca.SX(0)
    for k in range(1, terms):
        total = total + ca.sin(k * symbols(X)) * symbols(Y)
    step = Step("f", "", "", (OutputValue("f", 0, total),))
    (section,) = schedule(Graph(coefficients()), symbols, (), (step,))
    known: dict[str, float] = dict(scale)
    for statement in section.body:
        assert isinstance(statement, Let | Store) and depth(statement.expr) <= LONGEST
        known[statement.name if isinstance(statement, Let) else "f"] = value(statement.expr, known)
    expected = sum(math.sin(k * scale["x"]) for k in range(1, terms)) * scale["y"]
    assert known["f"] == pytest.approx(expected, rel=1e-12)


def depth(expr: Expr) -> int:
    """How many operations contain each other."""
    return 1 + max(map(depth, expr.args)) if isinstance(expr, Operation) else 0


def value(expr: Expr, known: dict[str, float]) -> float:
    """The number that an expression of a few operators is."""
    match expr:
        case Number(number):
            return float(number)
        case ScalarRef(name):
            return known[name]
        case Operation(kind, args):
            functions = {Operator.ADD: operator.add, Operator.MUL: operator.mul, Operator.SIN: math.sin}
            return functions[kind](*(value(arg, known) for arg in args))
    raise AssertionError(expr)


@pytest.mark.parametrize(
    ("expr", "expected"),
    [
        (X / 7, Operation(Operator.MUL, (num(Fraction(1, 7)), ScalarRef("x")))),
        (X / 4, Operation(Operator.MUL, (num(Fraction(1, 4)), ScalarRef("x")))),
        (X * sp.Rational(2, 7), Operation(Operator.MUL, (ScalarRef("x"), num(Fraction(2, 7))))),
        (X**3, Operation(Operator.MUL, (Operation(Operator.MUL, (ScalarRef("x"), ScalarRef("x"))), ScalarRef("x")))),
        (X - Y, Operation(Operator.SUB, (ScalarRef("x"), ScalarRef("y")))),
        (2 * X, Operation(Operator.MUL, (num(2), ScalarRef("x")))),
        (sp.cos(X), Operation(Operator.COS, (ScalarRef("x"),))),
        (sp.cos(1), ScalarRef("cos_1")),
        (sp.sqrt(2), ScalarRef("sqrt_2")),
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
