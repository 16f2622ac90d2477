"""Expressions of model constants become constants of setup, each of which is named once."""

from __future__ import annotations

from fractions import Fraction

import pytest

from derive.ir.expressions import Expr, Operator, ScalarRef, walk
from derive.lowering.flat.graph import Graph
from derive.lowering.flat.setup_constants import Constants


def test_shared_constants_are_named_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each of these uses the one before it twice: their number as a tree is 2^16."""
    constants = Constants(frozenset({"c"}))
    graph, named = Graph(constants), list[Expr]()
    name = constants.name
    monkeypatch.setattr(constants, "name", lambda expr: named.append(expr) or name(expr))
    c, x = graph.leaf(ScalarRef("c")), graph.leaf(ScalarRef("x"))
    node = c
    for _ in range(16):
        node = graph.apply(Operator.ADD, graph.apply(Operator.MUL, node, node), c)
    for _ in range(3):
        graph.apply(Operator.MUL, x, node)
    assert len(named) == len(constants.hoisted) <= 32


def test_setup_itself_computes_functions_of_numbers() -> None:
    """They have no name there: what setup computes is not a constant of another setup."""
    graph = Graph()
    sine = graph.apply(Operator.SIN, graph.number(Fraction(207, 100)))
    product = graph.expr(graph.apply(Operator.MUL, sine, graph.leaf(ScalarRef("p_c"))))
    assert {e.name for e in walk(product) if isinstance(e, ScalarRef)} == {"p_c"}
