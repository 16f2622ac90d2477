"""Assignments: SymPy expressions become statements with targets: straight-line code, or bodies of loops over modes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TypeAlias

from derive.algebra import sp
from derive.ir.expressions import Element, Expr, Leaf, MatrixEntry, Number, ScalarRef
from derive.ir.indices import variable
from derive.ir.statements import Let, Require, Statement, Store, StoreLocal, StoreStrided
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.graph import Graph
from derive.lowering.flat.schedule import OutputValue, Step, schedule
from derive.mechanics.symbols import identity, is_indexed
from derive.mechanics.typed_symbol import Symbol

Target = Symbol | Store | Require
"""The target of a scalar: a symbol that is known from then on, or a statement whose expression is replaced."""

Scalar: TypeAlias = "tuple[Target, sp.Expr]"
"""A scalar: its target and its value."""

IndexedStore: TypeAlias = "tuple[StoreLocal | StoreStrided, sp.Expr]"
"""The target of an expression in index i, and the expression."""

Assignment = Let | Store | Require | StoreLocal | StoreStrided
"""A statement that assigns or checks the value of one expression."""

NOTHING = Number(Fraction(0))
"""The placeholder for the expression of a target, until the value replaces it."""


def assignments(scheduled: Iterable[Statement], targets: Sequence[Assignment]) -> Iterator[Assignment]:
    """The statements of a schedule, each `Store` k with target k in its place."""
    return (_targeted(item, targets) for item in scheduled)


def map_body(
    rows: Sequence[IndexedStore], known: Mapping[sp.Symbol, Number | ScalarRef], temporaries: Iterator[str]
) -> tuple[Let | StoreLocal | StoreStrided, ...]:
    """The body of a loop over i; `known` are the leaves of scalars, `temporaries` are names for unnamed values."""
    symbols = Symbols(early=frozenset(known), late=frozenset())
    for symbol in sorted(free_symbols(e for _, e in rows), key=str):
        symbols.input(symbol, _element(symbol) if is_indexed(symbol) else known[symbol])
    stored = tuple(OutputValue("", k, symbols(expr)) for k, (_, expr) in enumerate(rows))
    step = Step("loop", "", "", stored)
    (section,) = schedule(Graph(), symbols, (), (step,), temporaries)
    body = assignments(section.body, [target for target, _ in rows])
    return tuple(item for item in body if isinstance(item, Let | StoreLocal | StoreStrided))


def pair_expression(expr: sp.Expr, known: Mapping[sp.Symbol, Number | ScalarRef], temporaries: Iterator[str]) -> Expr:
    """An expression of i and j as a single kernel expression, without intermediate names."""
    symbols = Symbols(early=frozenset(known), late=frozenset())
    for symbol in sorted(expr.free_symbols, key=str):
        symbols.input(symbol, _pair_leaf(symbol) if is_indexed(symbol) else known[symbol])
    step = Step("pair", "", "", (OutputValue("", 0, symbols(expr)),))
    (section,) = schedule(Graph(), symbols, (), (step,), temporaries)
    (item,) = section.body
    assert isinstance(item, Store)
    return item.expr


def free_symbols(exprs: Iterable[sp.Expr]) -> set[sp.Symbol]:
    """All symbols in some expressions."""
    return {s for e in exprs for s in sp.sympify(e).free_symbols}


def _element(symbol: sp.Symbol) -> Element:
    return Element(identity(symbol).array, variable("i"))


def _pair_leaf(symbol: sp.Symbol) -> Leaf:
    return MatrixEntry(identity(symbol).array) if len(identity(symbol).shapes) == 2 else _element(symbol)


def _targeted(item: Statement, targets: Sequence[Assignment]) -> Assignment:
    """A statement of a schedule, with its target replaced by the target of the scalar."""
    if not isinstance(item, Store):
        assert isinstance(item, Let | Require)
        return item
    match targets[item.index]:
        case Let(name):
            return Let(name, item.expr)
        case Store(output, index):
            return Store(output, index, item.expr)
        case Require(kind, _, code, text):
            return Require(kind, item.expr, code, text)
        case StoreLocal(name):
            return StoreLocal(name, item.expr)
        case StoreStrided(output, offset, stride):
            return StoreStrided(output, offset, stride, item.expr)
    raise AssertionError("a target is a statement that assigns a value")
