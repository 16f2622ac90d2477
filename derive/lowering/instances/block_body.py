"""The statements of a loop body that computes with small blocks, from CasADi expressions of elements of arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import casadi as ca

from derive.ir.expressions import Element, Ends, Operator, ScalarRef
from derive.ir.statements import InstanceItem, Let, Require, Requirement, ReturnCode, Store, StoreElement
from derive.lowering.flat.body_functions import VANISHING
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.graph import Graph
from derive.lowering.flat.schedule import OutputValue, RequiredValue, Step, StepItem, schedule
from derive.lowering.instances.block_system import packed
from derive.mechanics.symbols import local

Target = Element | Ends
"""An element of an array, or one for each end of a path."""
Block = list[list[ca.SX]]
"""The entries of a block by rows."""
TEXT = "the pivot of a joint vanished"


class BlockBody:
    """The statements of one loop body; `size` is that of the blocks."""

    def __init__(self, size: int) -> None:
        self.size = size
        self.symbols = Symbols(frozenset(), frozenset())
        self.items: list[StepItem] = []
        self.targets: dict[tuple[str, int], tuple[Target, Operator | None]] = {}
        self.loads: list[Let] = []

    def element(self, name: str, of: Target) -> ca.SX:
        """The value of an element, which is loaded under a name."""
        symbol = local(name)
        self.symbols.input(symbol, ScalarRef(name))
        self.loads.append(Let(name, of))
        return self.symbols.values[symbol]

    def store(self, target: Target, value: ca.SX, operator: Operator | None = None) -> None:
        """Write an element."""
        key = (target.array, len(self.targets))
        self.targets[key] = target, operator
        self.items.append(OutputValue(*key, value))

    def positive(self, value: ca.SX) -> None:
        """Require that a pivot is positive."""
        self.items.append(RequiredValue(Requirement.POSITIVE, value, ReturnCode.PIVOT, TEXT))

    def statements(self) -> tuple[InstanceItem, ...]:
        """The statements of the body."""
        result: list[InstanceItem] = [*self.loads]
        for section in schedule(Graph(), self.symbols, (), (Step("", "", "", tuple(self.items)),)):
            for statement in section.body:
                if isinstance(statement, Store):
                    element, operator = self.targets[statement.output, statement.index]
                    result.append(StoreElement(element, statement.expr, operator))
                else:
                    assert isinstance(statement, Let | Require)
                    result.append(statement)
        return tuple(result)

    # ---- blocks ----

    def symmetric(self, name: str, at: Callable[[int], Target]) -> Block:
        """A symmetric block; `at` gives the place of a packed element."""
        every = range(self.size)
        entries = {
            packed(self.size, i, j): self.element(f"{name}{i}{j}", at(packed(self.size, i, j)))
            for i in every
            for j in range(i, self.size)
        }
        return [[entries[packed(self.size, i, j)] for j in every] for i in every]

    def matrix(self, name: str, at: Callable[[int], Target]) -> Block:
        """A square block; `at` gives the place of an element, row by row."""
        every = range(self.size)
        return [[self.element(f"{name}{i}{j}", at(self.size * i + j)) for j in every] for i in every]

    def vector(self, name: str, at: Callable[[int], Target]) -> Block:
        """A column; `at` gives the place of an element."""
        return [[self.element(f"{name}{i}", at(i))] for i in range(self.size)]

    def store_symmetric(self, at: Callable[[int], Target], of: Block, operator: Operator | None = None) -> None:
        """Write a symmetric block."""
        for i in range(self.size):
            for j in range(i, self.size):
                self.store(at(packed(self.size, i, j)), of[i][j], operator)

    def store_rows(self, at: Callable[[int], Target], of: Block, operator: Operator | None = None) -> None:
        """Write a block row by row."""
        for k, value in enumerate(value for row in of for value in row):
            self.store(at(k), value, operator)

    def adjugate(self, d: Block) -> tuple[Block, ca.SX]:
        """The adjugate and the inverse determinant of a symmetric block, whose leading minors must be positive."""
        margin = self.symbols.number(VANISHING)
        if self.size == 1:
            self.positive(d[0][0])
            return [[ca.SX(1)]], 1 / d[0][0]
        if self.size == 2:
            determinant = d[0][0] * d[1][1] - d[0][1] * d[0][1]
            self.positive(d[0][0])
            self.positive(determinant - margin * (d[0][0] * d[1][1]))
            return [[d[1][1], -d[0][1]], [-d[0][1], d[0][0]]], 1 / determinant
        if self.size == 3:
            a = [[ca.SX(0)] * 3 for _ in range(3)]
            a[0][0] = d[1][1] * d[2][2] - d[1][2] * d[1][2]
            a[0][1] = d[0][2] * d[1][2] - d[0][1] * d[2][2]
            a[0][2] = d[0][1] * d[1][2] - d[0][2] * d[1][1]
            a[1][1] = d[0][0] * d[2][2] - d[0][2] * d[0][2]
            a[1][2] = d[0][1] * d[0][2] - d[0][0] * d[1][2]
            a[2][2] = d[0][0] * d[1][1] - d[0][1] * d[0][1]
            determinant = d[0][0] * a[0][0] + d[0][1] * a[0][1] + d[0][2] * a[0][2]
            self.positive(d[0][0])
            self.positive(a[2][2])
            self.positive(determinant - margin * (a[2][2] * d[2][2]))
            return [[a[min(i, j)][max(i, j)] for j in range(3)] for i in range(3)], 1 / determinant
        raise NotImplementedError("blocks of more than three constraints")


def product(a: Block, b: Block) -> Block:
    """The product of two blocks."""
    return [[_sum(row[k] * b[k][j] for k in range(len(b))) for j in range(len(b[0]))] for row in a]


def transposed(a: Block) -> Block:
    """The transpose of a block."""
    return [list(column) for column in zip(*a, strict=True)]


def scaled(factor: ca.SX, a: Block) -> Block:
    """A factor times a block."""
    return [[factor * value for value in row] for row in a]


def plus(a: Block, *others: Block) -> Block:
    """A sum of blocks."""
    for b in others:
        a = [[x + y for x, y in zip(*rows, strict=True)] for rows in zip(a, b, strict=True)]
    return a


def minus(a: Block, *others: Block) -> Block:
    """A difference of blocks."""
    for b in others:
        a = [[x - y for x, y in zip(*rows, strict=True)] for rows in zip(a, b, strict=True)]
    return a


def _sum(values: Iterable[ca.SX]) -> ca.SX:
    first, *others = values
    for other in others:
        first = first + other
    return first
