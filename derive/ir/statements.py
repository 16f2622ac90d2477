"""Statements of a Kernel: in straight line, over the modes of a body, and over the instances of a mechanism.

A loop states what it computes; `expansion.py` says with which operations in which order, in plain statements. The set
of statements is closed: `Statement` is their union, and whatever distinguishes statements ends in `assert_never`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum, IntEnum
from typing import assert_never

from derive.ir.expressions import Element, Ends, Expr, Operator
from derive.ir.indices import ElementIndex
from derive.ir.packing import Packing


class ReturnCode(IntEnum):
    """The code that a generated function returns: 0 means success, positive codes are recoverable."""

    OK = 0
    PIVOT = 1
    NOT_FINITE = 2

    @property
    def meaning(self) -> str:
        """The code in words."""
        match self:
            case ReturnCode.OK:
                return "success"
            case ReturnCode.PIVOT:
                return "a pivot vanished"
            case ReturnCode.NOT_FINITE:
                return "a value is not finite or not positive"
            case _:
                assert_never(self)


class Requirement(Enum):
    """A requirement on a value; a NaN meets neither."""

    POSITIVE = "positive"
    FINITE = "finite"


# Statements in straight line


@dataclass(frozen=True)
class Let:
    """Name a value."""

    name: str
    expr: Expr


@dataclass(frozen=True)
class Store:
    """Write element `index` of an output."""

    output: str
    index: int
    expr: Expr


@dataclass(frozen=True)
class Require:
    """Return from the function with `code` unless the value meets the requirement."""

    kind: Requirement
    expr: Expr
    code: ReturnCode
    text: str


ScalarStatement = Let | Store | Require
"""A statement in straight line."""


# Statements that run over the modes


@dataclass(frozen=True)
class StoreLocal:
    """Write element i of a local array, in a `Map`."""

    array: str
    expr: Expr


@dataclass(frozen=True)
class StoreStrided:
    """Write element offset + stride * i of an output, in a `Map`."""

    output: str
    offset: int
    stride: int
    expr: Expr


MapItem = Let | StoreLocal | StoreStrided
"""A statement in the body of a `Map`."""


@dataclass(frozen=True)
class Map:
    """The body for i = 0 .. count - 1, independent of each other."""

    count: int
    body: tuple[MapItem, ...]


@dataclass(frozen=True)
class Sum:
    """name = base + sum over i of term."""

    name: str
    base: Expr
    term: Expr


@dataclass(frozen=True)
class Accumulate:
    """Sums over i = 0 .. count - 1. Element i goes to lane i mod 4; lanes are added as (0 + 1) + (2 + 3), then base."""

    count: int
    lets: tuple[Let, ...]
    sums: tuple[Sum, ...]


@dataclass(frozen=True)
class Product:
    """The sum over j of sign * matrix_ij vector_j; the sign is 1 or -1."""

    vector: str
    table: str
    sign: int = 1


@dataclass(frozen=True)
class MatVecTerm:
    """Local array name_i = base_i + products; no base is zero.

    The products follow each other: all columns j of the first, then all of the second.
    """

    name: str
    base: str
    sums: tuple[Product, ...]


@dataclass(frozen=True)
class MatVec:
    """Matrix-vector products of packed matrices, block by block."""

    packing: Packing
    terms: tuple[MatVecTerm, ...]


@dataclass(frozen=True)
class MatrixStore:
    """output[offset + stride * j + i] = expr for all i, j; on the diagonal `diagonal` is added."""

    packing: Packing
    output: str
    offset: int
    stride: int
    expr: Expr
    diagonal: Expr | None


@dataclass(frozen=True)
class PackSource:
    """A matrix in the parameters: entries for i <= j (i < j, if odd) by rows, `components` together."""

    table: str
    array: str
    component: int
    components: int
    parity: int


@dataclass(frozen=True)
class Pack:
    """Fill an output with the packed matrices, from their sources."""

    packing: Packing
    output: str
    sources: tuple[PackSource, ...]


@dataclass(frozen=True)
class Clear:
    """Set all elements of an output to zero, or `count` of them from the element `first` on."""

    output: str
    count: int
    first: int = 0


@dataclass(frozen=True)
class RequireFinite:
    """Return from the function with `code` unless all elements of an argument are finite."""

    argument: str
    count: int
    code: ReturnCode
    text: str


@dataclass(frozen=True)
class Cholesky:
    """The Cholesky factor L of a matrix given by its entries i <= j, into an output from `offset` on, by columns.

    The diagonal holds 1/L_ii. The function returns with `code` when a pivot is not positive.
    """

    output: str
    offset: int
    source: str
    count: int
    code: ReturnCode
    text: str


@dataclass(frozen=True)
class TriangularSolve:
    """Overwrite local arrays y by L^-1 y, or by L^-T y if `transposed`; `factor` is what `Cholesky` wrote."""

    factor: str
    count: int
    arrays: tuple[str, ...]
    transposed: bool


Loop = Map | Accumulate | MatVec | MatrixStore | Pack | Clear | RequireFinite | Cholesky | TriangularSolve


# Statements that run over the instances of a mechanism


@dataclass(frozen=True)
class Work:
    """Declare a local array of `count` elements; `cleared`: they begin as zeros.

    spacing: the distance of the components of an instance, if the array holds one component of all instances after the
    other.
    """

    array: str
    count: int
    cleared: bool = False
    spacing: int = 0


@dataclass(frozen=True)
class Entry:
    """Name an integer, an element of a constant array of integers; other indices count from it."""

    name: str
    array: str
    index: ElementIndex


@dataclass(frozen=True)
class StoreElement:
    """Write an element of an output or of a local array; with an operator, the result of its old value and `expr`."""

    target: Element | Ends
    expr: Expr
    operator: Operator | None = None


@dataclass(frozen=True)
class ForEach:
    """The body for a variable from `start` to `stop`, which is left out, in order, or from the end if `backward`.

    independent: the iterations write elements of their own, which no iteration reads, and may run in any order.
    short: a loop inside of another one, whose iterations batches have in a straight line.
    """

    variable: str
    start: ElementIndex
    stop: ElementIndex
    body: tuple[InstanceItem, ...]
    backward: bool = False
    independent: bool = False
    short: bool = False


InstanceItem = Let | Require | Entry | StoreElement | Work | ForEach
"""A statement in the body of a `ForEach`; an array that it declares there is one of the iteration."""


def inside(loop: ForEach) -> Iterator[InstanceItem]:
    """All statements in the body of a loop, also those in loops inside."""
    for item in loop.body:
        yield item
        if isinstance(item, ForEach):
            yield from inside(item)


InstanceStatement = Work | StoreElement | Entry | ForEach
Statement = ScalarStatement | Loop | InstanceStatement
