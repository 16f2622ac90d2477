"""Expressions of a Kernel: exact numbers, named scalars, elements of arrays, and operations on them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from typing import Literal

LoopIndex = Literal["i", "j"]
"""The index of a loop over the modes: i, and j of the outer loop over the columns of a matrix."""


class Operator(Enum):
    """What an Operation computes; the values are the names that messages and generated files use."""

    ADD = "add"
    SUB = "sub"
    MUL = "mul"
    DIV = "div"
    NEG = "neg"
    SIN = "sin"
    COS = "cos"
    SQRT = "sqrt"

    @property
    def binary(self) -> bool:
        """Whether it has two operands."""
        return self in (Operator.ADD, Operator.SUB, Operator.MUL, Operator.DIV)

    @property
    def function(self) -> bool:
        """Whether languages write it as the call of a function of one operand."""
        return self in (Operator.SIN, Operator.COS, Operator.SQRT)


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


Leaf = Number | ScalarRef | ArrayAccess | MatrixEntry
Expr = Leaf | Operation


def walk(expr: Expr) -> Iterator[Expr]:
    """An expression and all its parts, operands first."""
    if isinstance(expr, Operation):
        for arg in expr.args:
            yield from walk(arg)
    yield expr
