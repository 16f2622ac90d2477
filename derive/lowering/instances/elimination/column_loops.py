"""The elimination of a joint with a large block, in loops over the rows of the next joint.

Each row of the next joint is a column z of L^-1 S, where S is the coupling block. Written out, forward substitution and
the products of columns are most of the text of a step, which short paths execute once or twice for each time that the
processor has to fetch it; in loops, all columns have one text. Half of the rows of z come before the last pivots, so
that processors have something to do while they divide.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce

from derive.ir.expressions import Expr, Number, Operation, Operator, ScalarRef
from derive.ir.indices import constant, variable
from derive.ir.statements import ForEach, InstanceItem, Let, Require, Requirement, ReturnCode, StoreElement
from derive.lowering.instances.elimination.block_body import TEXT, Target
from derive.lowering.ldlt import VANISHING

COLUMN, BEFORE = "next_row", "row_before"
"""The variables of the loops: over the rows of the next joint, and over those up to this row."""
ONE = Number(Fraction(1))


@dataclass(frozen=True)
class Places:
    """The places of elements in the step of a joint; names of rows and columns are variables of loops.

    diagonal, rights: the elements whose sums are the block of the joint and its right-hand side; update, right_update:
    those of what the joint before subtracts, and then of what the joint subtracts from the next one; coupling: that of
    S; column, right: those of L^-1 times S and times the right-hand side; factor: those of L and, on the diagonal,
    of D^-1; is_first: whether there is no joint before.
    """

    diagonal: Callable[[int, int], Sequence[Target]]
    rights: Callable[[int], Sequence[Target]]
    update: Callable[[int | str, int | str], Target]
    right_update: Callable[[int | str], Target]
    coupling: Callable[[int, int | str], Target]
    column: Callable[[int, int | str], Target]
    right: Callable[[int], Target]
    factor: Callable[[int, int], Target]
    is_first: bool


def elimination_in_loops(size: int, at: Places) -> tuple[InstanceItem, ...]:
    """The elimination of a joint."""
    body: list[InstanceItem] = []

    def named(name: str, value: Expr) -> Expr:
        body.append(Let(name, value))
        return ScalarRef(name)

    half = (size - 1) // 2
    lower: list[list[Expr]] = []
    inverses: list[Expr] = []
    rights: list[Expr] = []
    for i in range(size):
        whole = [_total(at.diagonal(i, j)) for j in range(i + 1)]
        whole[i] = named(f"whole{i}", whole[i])
        own = whole if at.is_first else [_minus(of, at.update(j, i)) for j, of in enumerate(whole)]
        left: list[Expr] = []  # what remains of a row, whose pivot is the last one
        lower.append([])
        for j in range(i):
            left.append(named(f"left{i}{j}", _without(own[j], lower[j], left)))
            lower[i].append(named(f"l{i}{j}", _product(left[j], inverses[j])))
            body.append(StoreElement(at.factor(i, j), lower[i][j]))
        if i in (half, size - 1):
            body.append(_rows(size, at, lower, 0 if i == half else half + 1))
        right = _total(at.rights(i))
        right = right if at.is_first else _minus(right, at.right_update(i))
        rights.append(named(f"right{i}", _without(right, lower[i], rights)))
        body.append(StoreElement(at.right(i), rights[i]))
        pivot = named(f"pivot{i}", _without(own[i], lower[i], left))
        margin = _product(Number(Fraction(VANISHING)), whole[i])
        body.append(Require(Requirement.POSITIVE, _minus(pivot, margin), ReturnCode.PIVOT, TEXT))
        inverses.append(named(f"inverse{i}", Operation(Operator.DIV, (ONE, pivot))))
        body.append(StoreElement(at.factor(i, i), inverses[i]))
    return *body, _updates(size, at)


def _rows(size: int, at: Places, lower: Sequence[Sequence[Expr]], first: int) -> ForEach:
    """The loop over the columns of L^-1 S that computes their rows from one on, as far as rows of L are given."""
    body: list[InstanceItem] = []
    z: list[Expr] = [at.column(k, COLUMN) for k in range(first)]
    for i in range(first, len(lower)):
        body.append(Let(f"z{i}", _without(at.coupling(i, COLUMN), lower[i], z)))
        z.append(ScalarRef(f"z{i}"))
        body.append(StoreElement(at.column(i, COLUMN), z[i]))
    return _over_columns(size, body)


def _updates(size: int, at: Places) -> ForEach:
    """The loop over the rows of the next joint that computes what the joint subtracts from each."""
    rows = range(size)
    scaled = [Let(f"scaled{k}", _product(at.column(k, COLUMN), at.factor(k, k))) for k in rows]
    z = [ScalarRef(let.name) for let in scaled]
    right = StoreElement(at.right_update(COLUMN), _total([_product(z[k], at.right(k)) for k in rows]))
    entry = StoreElement(at.update(BEFORE, COLUMN), _total([_product(z[k], at.column(k, BEFORE)) for k in rows]))
    before = ForEach(BEFORE, constant(0), variable(COLUMN, 1, 1), (entry,), short=True)
    return _over_columns(size, [*scaled, right, before])


def _over_columns(size: int, body: Sequence[InstanceItem]) -> ForEach:
    return ForEach(COLUMN, constant(0), constant(size), tuple(body), short=True)


def _product(a: Expr, b: Expr) -> Expr:
    return Operation(Operator.MUL, (a, b))


def _minus(a: Expr, b: Expr) -> Expr:
    return Operation(Operator.SUB, (a, b))


def _total(terms: Sequence[Expr]) -> Expr:
    return reduce(lambda a, b: Operation(Operator.ADD, (a, b)), terms)


def _without(value: Expr, one: Sequence[Expr], other: Sequence[Expr]) -> Expr:
    """A value less the products of two rows, as far as both go."""
    return reduce(_minus, map(_product, one, other), value)
