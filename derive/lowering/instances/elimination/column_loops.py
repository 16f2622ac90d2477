"""The end of the elimination of a joint with a large block, in loops over the rows of the next joint.

Each row of the next joint is a column z of L^-1 S, where S is the coupling block. Written out, forward substitution and
the products of columns are most of the text of a step, which short paths execute once or twice for each text that the
processor has to fetch; in loops, all columns have one text.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import Protocol

from derive.ir.expressions import Expr, Operation, Operator, ScalarRef
from derive.ir.indices import constant, variable
from derive.ir.statements import ForEach, InstanceItem, Let, StoreElement
from derive.lowering.instances.elimination.block_body import Target

COLUMN, BEFORE = "next_row", "row_before"
"""The variables of the loops: over the rows of the next joint, and over those up to this row."""


class Places(Protocol):
    """The places of elements in the step of a joint; names of rows and columns are variables of loops."""

    def coupling(self, row: int, column: int | str) -> Target:
        """The element of the block of a joint and the next one."""

    def factor(self, row: int, column: int) -> Target:
        """The element of L, or on the diagonal of D^-1."""

    def column(self, row: int, column: int | str) -> Target:
        """The element of L^-1 times the coupling block."""

    def right(self, row: int) -> Target:
        """The element of L^-1 times the right-hand side."""

    def update(self, row: str, column: str) -> Target:
        """The element of what the next joint subtracts from its block."""

    def right_update(self, row: str) -> Target:
        """The element of what the next joint subtracts from its right-hand side."""


def over_columns(size: int, at: Places) -> ForEach:
    """The loop over the rows of the next joint: forward substitution, and what the joint subtracts from this row."""
    body: list[InstanceItem] = []

    def named(name: str, value: Expr) -> Expr:
        body.append(Let(name, value))
        return ScalarRef(name)

    z: list[Expr] = []
    for i in range(size):
        left: Expr = at.coupling(i, COLUMN)
        for k in range(i):
            left = Operation(Operator.SUB, (left, _product(at.factor(i, k), z[k])))
        z.append(named(f"z{i}", left))
        body.append(StoreElement(at.column(i, COLUMN), z[i]))
    scaled = [named(f"scaled{i}", _product(z[i], at.factor(i, i))) for i in range(size)]
    body.append(StoreElement(at.right_update(COLUMN), _sum(scaled, [at.right(k) for k in range(size)])))
    entry = StoreElement(at.update(BEFORE, COLUMN), _sum(scaled, [at.column(k, BEFORE) for k in range(size)]))
    body.append(ForEach(BEFORE, constant(0), variable(COLUMN, 1, 1), (entry,)))
    return ForEach(COLUMN, constant(0), constant(size), tuple(body), short=True)


def _product(a: Expr, b: Expr) -> Expr:
    return Operation(Operator.MUL, (a, b))


def _sum(left: Sequence[Expr], right: Sequence[Expr]) -> Expr:
    products = map(_product, left, right)
    return reduce(lambda a, b: Operation(Operator.ADD, (a, b)), products)
