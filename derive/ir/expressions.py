"""Expressions of a Kernel: exact numbers, named scalars, elements of arrays, and operations on them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from typing import Literal

LoopIndex = Literal["i", "j"]
"""The index of a loop over the modes: i, and j of the outer loop over the columns of a matrix."""


class Operator(Enum):
    """The operator of an Operation; the values are the names that messages and generated files use."""

    ADD = "add"
    SUB = "sub"
    MUL = "mul"
    DIV = "div"
    NEG = "neg"
    SIN = "sin"
    COS = "cos"
    SQRT = "sqrt"
    EXP = "exp"
    LOG = "log"
    TANH = "tanh"
    SIGN = "sign"
    ATAN2 = "atan2"
    MIN = "fmin"
    MAX = "fmax"
    LESS = "less"
    NOT_GREATER = "not_greater"
    NOT = "not"
    WHEN = "when"

    __hash__ = object.__hash__  # members are equal only to themselves; that of Enum hashes the name each time

    @property
    def binary(self) -> bool:
        """Whether the operator has two operands."""
        return self in BINARY_OPERATORS

    @property
    def vectorises(self) -> bool:
        """Whether compilers vectorise the operator; the others are calls of functions of the C library."""
        return self not in LIBRARY_OPERATORS


BINARY_OPERATORS = frozenset(
    {
        *(Operator.ADD, Operator.SUB, Operator.MUL, Operator.DIV, Operator.ATAN2, Operator.MIN, Operator.MAX),
        *(Operator.LESS, Operator.NOT_GREATER, Operator.WHEN),
    }
)
"""The operators of two operands. LESS and NOT_GREATER compare them, and are 1 or 0; WHEN is the second one where the
first is not 0, and else 0."""

CONDITIONS = frozenset({Operator.LESS, Operator.NOT_GREATER, Operator.NOT})
"""The operators that languages write as conditions; their values are 1 and 0."""

LIBRARY_OPERATORS = frozenset({Operator.SIN, Operator.COS, Operator.EXP, Operator.LOG, Operator.TANH, Operator.ATAN2})
"""The operators that are functions of the C library, and no single instructions."""


@dataclass(frozen=True)
class Number:
    """An exact number."""

    value: Fraction


@dataclass(frozen=True)
class ScalarRef:
    """The value of an element of an argument or of an earlier `Let`, by its name."""

    name: str


@dataclass(frozen=True)
class Operation:
    """An operator applied to its operands, two or one."""

    kind: Operator
    args: tuple[Expr, ...]


@dataclass(frozen=True)
class ArrayAccess:
    """Element offset + stride * index of an array, where `index` is that of a loop over the modes."""

    array: str
    index: LoopIndex
    stride: int = 1
    offset: int = 0


@dataclass(frozen=True)
class MatrixEntry:
    """Entry (i, j) of a packed matrix, in a `MatrixStore`."""

    table: str


@dataclass(frozen=True)
class TableValue:
    """The derivative of an order, 0 for the value itself, of a table of the model at an argument."""

    table: str
    order: int
    argument: Expr


Leaf = Number | ScalarRef | ArrayAccess | MatrixEntry | TableValue
"""A leaf of an expression graph, which has no operands; the argument of a table is no part of the graph."""
Expr = Leaf | Operation


def walk(expr: Expr) -> list[Expr]:
    """An expression and all its parts, operands first."""
    parts: list[Expr] = []
    _add_parts(expr, parts)
    return parts


def _add_parts(expr: Expr, parts: list[Expr]) -> None:
    """Add to one list: generators in generators would pass on each part once for each operation around it."""
    if isinstance(expr, Operation):
        for arg in expr.args:
            _add_parts(arg, parts)
    elif isinstance(expr, TableValue):
        _add_parts(expr.argument, parts)
    parts.append(expr)
