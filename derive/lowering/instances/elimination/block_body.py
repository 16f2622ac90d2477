"""The statements of a loop body that computes with small blocks, from CasADi expressions of elements of arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import casadi as ca

from derive.ir.expressions import Element, Ends, Operator, ScalarRef
from derive.ir.statements import InstanceItem, Let, Require, Requirement, ReturnCode, Store, StoreElement
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.graph import Graph
from derive.lowering.flat.schedule import OutputValue, RequiredValue, Step, StepItem, schedule
from derive.lowering.instances.elimination.block_system import packed
from derive.lowering.ldlt import VANISHING
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

    def inverse(self, d: Block, scales: Sequence[ca.SX], exact: bool) -> Factors | Adjugate:
        """A form in which systems with a symmetric block can be solved; its pivots must be positive.

        scales: the diagonal before other joints were eliminated; a pivot must be more than its rounding errors.
        exact: whether to factorise it: joints that close loops make blocks in which cofactors cancel. The adjugate
        takes one division in place of one for each row.
        """
        return self._adjugate(d, scales) if has_adjugate(self.size, exact) else self._factors(d, scales)

    def _factors(self, d: Block, scales: Sequence[ca.SX]) -> Factors:
        margin = self.symbols.number(VANISHING)
        work = [list(row) for row in d]
        lower: Block = [[ca.SX(0)] * self.size for _ in range(self.size)]
        inverses = []
        for k in range(self.size):
            self.positive(work[k][k] - margin * scales[k])
            inverses.append(1 / work[k][k])
            for i in range(k + 1, self.size):
                lower[i][k] = work[i][k] * inverses[k]
                for j in range(k + 1, i + 1):
                    work[i][j] = work[i][j] - lower[j][k] * work[i][k]
        return Factors(lower, inverses)

    def _adjugate(self, d: Block, scales: Sequence[ca.SX]) -> Adjugate:
        """The determinants of the leading blocks are the products of the pivots."""
        margin = self.symbols.number(VANISHING)
        first = d[0][0]
        self.positive(first - margin * scales[0])
        if self.size == 1:
            return Adjugate([[ca.SX(1)]], 1 / first)
        second = d[0][0] * d[1][1] - d[0][1] * d[0][1]
        self.positive(second - margin * (first * scales[1]))
        if self.size == 2:
            return Adjugate([[d[1][1], -d[0][1]], [-d[0][1], d[0][0]]], 1 / second)
        a = [[ca.SX(0)] * 3 for _ in range(3)]
        a[0][0] = d[1][1] * d[2][2] - d[1][2] * d[1][2]
        a[0][1] = d[0][2] * d[1][2] - d[0][1] * d[2][2]
        a[0][2] = d[0][1] * d[1][2] - d[0][2] * d[1][1]
        a[1][1] = d[0][0] * d[2][2] - d[0][2] * d[0][2]
        a[1][2] = d[0][1] * d[0][2] - d[0][0] * d[1][2]
        a[2][2] = second
        determinant = d[0][0] * a[0][0] + d[0][1] * a[0][1] + d[0][2] * a[0][2]
        self.positive(determinant - margin * (second * scales[2]))
        return Adjugate([[a[min(i, j)][max(i, j)] for j in range(3)] for i in range(3)], 1 / determinant)


@dataclass(frozen=True)
class Adjugate:
    """The adjugate of a block, and the inverse of its determinant."""

    adjugate: Block
    inverse: ca.SX

    def part(self, right: Block) -> Block:
        """The solutions of a system without the factor `inverse`, so that nothing waits for the division."""
        return product(self.adjugate, right)

    @staticmethod
    def forward(right: Block) -> Block:
        """The first part of a solution, here none."""
        return right

    def middle(self, right: Block) -> Block:
        """The second part of a solution, with a symmetric block: here all of it."""
        return self.solve(right)

    @property
    def block(self) -> Block:
        """The inverse, a symmetric block."""
        return scaled(self.inverse, self.adjugate)

    @staticmethod
    def of_block(block: Block) -> Adjugate:
        """The inverse from its entries."""
        return Adjugate(block, ca.SX(1))

    def solve(self, right: Block) -> Block:
        """The solutions of a system with the block for the columns of `right`."""
        return scaled(self.inverse, self.part(right))


@dataclass(frozen=True)
class Factors:
    """The factors L D L^T of a block: L below its unit diagonal, and the inverses of D."""

    lower: Block
    inverses: list[ca.SX]

    @property
    def block(self) -> Block:
        """A symmetric block with L beside its diagonal, and the inverses of D on it."""
        n = range(len(self.inverses))
        return [[self.inverses[i] if i == j else self.lower[max(i, j)][min(i, j)] for j in n] for i in n]

    @staticmethod
    def of_block(block: Block) -> Factors:
        """The factors from such a block."""
        return Factors(block, [row[k] for k, row in enumerate(block)])

    def forward(self, right: Block) -> Block:
        """L^-1 times the columns of `right`."""
        x = [list(row) for row in right]
        for i in range(len(x)):
            for k in range(i):
                x[i] = [value - self.lower[i][k] * other for value, other in zip(x[i], x[k], strict=True)]
        return x

    def middle(self, right: Block) -> Block:
        """D^-1 times the columns of `right`."""
        return [[value * inverse for value in row] for row, inverse in zip(right, self.inverses, strict=True)]

    def backward(self, right: Block) -> Block:
        """L^-T times the columns of `right`; what is known last is subtracted last, and a sum waits for one product."""
        x = [list(row) for row in right]
        for i in reversed(range(len(x))):
            for k in reversed(range(i + 1, len(x))):
                x[i] = [value - self.lower[k][i] * other for value, other in zip(x[i], x[k], strict=True)]
        return x

    def solve(self, right: Block) -> Block:
        """The solutions of a system with the block for the columns of `right`, by substitution."""
        return self.backward(self.middle(self.forward(right)))


def has_adjugate(size: int, exact: bool) -> bool:
    """Whether systems with blocks are solved by their adjugates."""
    return size <= 3 and not exact


def product(a: Block, b: Block) -> Block:
    """The product of two blocks."""
    return [[_sum(row[k] * b[k][j] for k in range(len(b))) for j in range(len(b[0]))] for row in a]


def diagonal(a: Block) -> list[ca.SX]:
    """The entries on the diagonal of a block."""
    return [row[k] for k, row in enumerate(a)]


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
