"""Expressions of a Kernel: exact numbers, named scalars, elements of arrays, and operations on them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from fractions import Fraction

from derive.ir.indices import LANES, ElementIndex, constant


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

VECTOR_OPERATORS = frozenset({Operator.ADD, Operator.SUB, Operator.MUL, Operator.DIV, Operator.NEG})
"""The operators that vectors have."""

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
class Element:
    """An element of an array.

    state: the variable of the loop over the states of a batch, if the array has a value for each of them, and "" if
    not. A scalar with a value for each state has no index.
    """

    array: str
    index: ElementIndex | None
    state: str = ""


@dataclass(frozen=True)
class Ends:
    """An element of an array for each end of a path, in a loop over both ends, whose variable is 0 and 1."""

    array: str
    first: ElementIndex
    second: ElementIndex
    variable: str

    def of(self, end: int) -> Element:
        """The element of an end."""
        return Element(self.array, self.second if end else self.first)


@dataclass(frozen=True)
class LaneSum:
    """The sum of four lanes in an array, (0 + 1) + (2 + 3), from an index on.

    Its additions are counted with those to the lanes.
    """

    array: str
    first: int

    @property
    def expr(self) -> Expr:
        """The sum as an operation on elements."""
        first, second, third, fourth = (Element(self.array, constant(self.first + k)) for k in range(LANES))
        pairs = Operation(Operator.ADD, (first, second)), Operation(Operator.ADD, (third, fourth))
        return Operation(Operator.ADD, pairs)


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


Leaf = Number | ScalarRef | Element | Ends | LaneSum | MatrixEntry | TableValue
"""A leaf of an expression graph, which has no operands; the argument of a table is no part of the graph."""
Expr = Leaf | Operation


def mapped(expr: Expr, leaf: Callable[[Leaf], Expr]) -> Expr:
    """An expression with its leaves replaced; of a table, its argument."""
    match expr:
        case Operation():
            return Operation(expr.kind, tuple(mapped(arg, leaf) for arg in expr.args))
        case TableValue():
            return replace(expr, argument=mapped(expr.argument, leaf))
        case _:
            return leaf(expr)


def walk(expr: Expr) -> list[Expr]:
    """An expression and all its parts, operands first."""
    parts: list[Expr] = []
    _add_parts(expr, parts)
    return parts


_WITH_PARTS = (Operation, TableValue)


def _add_parts(expr: Expr, parts: list[Expr]) -> None:
    """Add to one list: generators in generators would pass on each part once for each operation around it."""
    if isinstance(expr, Operation):
        for arg in expr.args:
            if isinstance(arg, _WITH_PARTS):
                _add_parts(arg, parts)
            else:
                parts.append(arg)
    elif isinstance(expr, TableValue):
        _add_parts(expr.argument, parts)
    parts.append(expr)
