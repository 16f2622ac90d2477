"""The elimination of joints that may be redundant, in any graph: with a proximal term, and refined.

The factorisation is kept, since the solution for one right-hand side gives the next, see `derive.lowering.proximal`.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from derive.ir.expressions import Element, Operator
from derive.ir.indices import constant
from derive.ir.statements import InstanceItem, InstanceStatement, StoreElement, Work
from derive.lowering.instances.elimination.block_body import (
    Block,
    BlockBody,
    Factors,
    diagonal,
    plus,
    product,
    transposed,
)
from derive.lowering.instances.elimination.block_system import (
    COUPLING,
    DIAGONAL,
    FLOOR,
    FORCE,
    KNOWN,
    ONE,
    RIGHT,
    Blocks,
)
from derive.lowering.instances.elimination.graph_elimination import (
    JOINT,
    NEIGHBOUR,
    at,
    each_joint,
    each_neighbour,
    each_pair,
)
from derive.lowering.instances.places import Places
from derive.lowering.proximal import LEAST, PROXIMAL, REFINEMENTS

FACTOR, FACTORS, WEIGHT, SUM = "factor", "factors", "weight", "right"
"""The local arrays of the blocks after the elimination of their first joint, of the factors of each joint's block, of
the weights of its constraints, and of the right-hand side."""


def with_proximal_term(
    of: Blocks, places: Places, has_known: bool, idle: Sequence[int]
) -> tuple[InstanceStatement, ...]:
    """The elimination of all joints and the reactions of least norm, with the arrays and arguments of `in_graph`.

    idle: the elements of the diagonals of constraints without coordinates, whose weight is 1.
    """
    system = _Proximal(of, places)
    works = [
        Work(FACTOR, of.coupling_spacing * of.size**2, spacing=of.coupling_spacing),
        Work(FACTORS, of.spacing * of.packed, spacing=of.spacing),
        Work(WEIGHT, of.spacing * of.size, spacing=of.spacing),
        Work(SUM, of.spacing * of.size, spacing=of.spacing),
    ]
    ones = [StoreElement(Element(WEIGHT, constant(element)), ONE) for element in idle]
    result: list[InstanceStatement] = [*(work for work in works if work.count)]
    result += [each_joint(of, system.assembled(has_known)), *ones, each_joint(of, system.factorised())]
    for refinement in range(1 + REFINEMENTS):
        result.append(each_joint(of, system.right(refinement > 0)))
        result.append(each_joint(of, system.forward()))
        result += [each_joint(of, system.backward(), backward=True)] if of.couplings else []
    return tuple(result)


class _Proximal:
    """The loops over the joints of a system."""

    def __init__(self, of: Blocks, places: Places) -> None:
        self.of, self.places, self.n = of, places, of.spacing

    def assembled(self, has_known: bool) -> tuple[InstanceItem, ...]:
        """The weights and the right-hand side of a joint."""
        body, n = BlockBody(self.of.size), self.n
        names = [*RIGHT, *([KNOWN] if has_known else [])]
        body.store_rows(at(SUM, n, JOINT), plus(*(body.vector(f"{name}_", at(name, n, JOINT)) for name in names)))
        floors = _entries(plus(*(body.vector(f"{name}_", at(name, n, JOINT)) for name in FLOOR)))
        least, weights = body.symbols.number(LEAST), diagonal(self._block(body))
        weights = [ca.fmax(weight, least * floor) for weight, floor in zip(weights, floors, strict=True)]
        body.store_rows(at(WEIGHT, n, JOINT), [[weight] for weight in weights])
        return body.statements()

    def factorised(self) -> tuple[InstanceItem, ...]:
        """The factors of the block of a joint, and what its elimination subtracts from the others."""
        of, n, blocks = self.of, self.n, self.of.coupling_spacing
        head = BlockBody(of.size)
        weights = _entries(head.vector("weight", at(WEIGHT, n, JOINT)))
        term = head.symbols.number(PROXIMAL)
        block = self._block(head)
        for k, weight in enumerate(weights):
            block[k][k] = block[k][k] + term * weight
        head.store_symmetric(at(FACTORS, n, JOINT), head.inverse(block, weights, exact=True).block)
        inner = BlockBody(of.size)
        s = inner.matrix("s", at(COUPLING, blocks, NEIGHBOUR))
        y = self._factors(inner).solve(s)
        inner.store_rows(at(FACTOR, blocks, NEIGHBOUR), y)
        inner.store_symmetric(at(DIAGONAL[0], n, "other"), product(transposed(s), y), Operator.SUB)
        return (
            *head.statements(),
            *each_neighbour(of, self.places, inner.statements()),
            *each_pair(of, self.places, FACTOR),
        )

    def right(self, is_refined: bool) -> tuple[InstanceItem, ...]:
        """The right-hand side of a joint, with the proximal term of the reactions before; these begin as zeros."""
        body, n = BlockBody(self.of.size), self.n
        right = body.vector("right", at(SUM, n, JOINT))
        if is_refined:
            term = body.symbols.number(PROXIMAL)
            weights = _entries(body.vector("weight", at(WEIGHT, n, JOINT)))
            before = _entries(body.vector("before", at(FORCE, n, JOINT)))
            right = plus(right, [[term * weight * x] for weight, x in zip(weights, before, strict=True)])
        body.store_rows(at(RIGHT[0], n, JOINT), right)
        return body.statements()

    def forward(self) -> tuple[InstanceItem, ...]:
        """The forward substitution; the solution begins as what is left of the right-hand side."""
        head, n = BlockBody(self.of.size), self.n
        right = head.vector("right", at(RIGHT[0], n, JOINT))
        head.store_rows(at(FORCE, n, JOINT), self._factors(head).solve(right))
        inner = BlockBody(self.of.size)
        s = inner.matrix("s", at(COUPLING, self.of.coupling_spacing, NEIGHBOUR))
        w = inner.vector("w", at(FORCE, n, JOINT))
        inner.store_rows(at(RIGHT[0], n, "other"), product(transposed(s), w), Operator.SUB)
        return (*head.statements(), *each_neighbour(self.of, self.places, inner.statements()))

    def backward(self) -> tuple[InstanceItem, ...]:
        """The reactions of a joint from those of its neighbours."""
        body, n = BlockBody(self.of.size), self.n
        y = body.matrix("y", at(FACTOR, self.of.coupling_spacing, NEIGHBOUR))
        body.store_rows(at(FORCE, n, JOINT), product(y, body.vector("f", at(FORCE, n, "other"))), Operator.SUB)
        return tuple(each_neighbour(self.of, self.places, body.statements()))

    def _block(self, body: BlockBody) -> Block:
        return plus(*(body.symmetric(f"{name}_", at(name, self.n, JOINT)) for name in DIAGONAL))

    def _factors(self, body: BlockBody) -> Factors:
        return Factors.of_block(body.symmetric("a", at(FACTORS, self.n, JOINT)))


def _entries(column: Block) -> list[ca.SX]:
    """The entries of a column."""
    return [value for (value,) in column]
