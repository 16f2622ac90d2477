"""Expressions of a Kernel: exact numbers, names, elements of arrays, and operations on them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True)
class Num:
    """An exact number."""

    value: Fraction


@dataclass(frozen=True)
class Ref:
    """The value of an element of an argument or of an earlier `Let`, by its name."""

    name: str


@dataclass(frozen=True)
class Op:
    """An operation: add, sub, mul, div (two operands), neg, sin, cos, sqrt (one)."""

    kind: str
    args: tuple[Expr, ...]


@dataclass(frozen=True)
class At:
    """Element offset + stride * index of an array, by the name of the loop that counts the index."""

    array: str
    index: str
    stride: int = 1
    offset: int = 0


@dataclass(frozen=True)
class Entry:
    """Entry (i, j) of a packed table, in a `Pairs`."""

    table: str


Leaf = Num | Ref | At | Entry
Expr = Leaf | Op


@dataclass(frozen=True)
class Let:
    """Name a value."""

    name: str
    expr: Expr


def walk(expr: Expr) -> Iterator[Expr]:
    """An expression and all its parts, operands first."""
    if isinstance(expr, Op):
        for arg in expr.args:
            yield from walk(arg)
    yield expr
