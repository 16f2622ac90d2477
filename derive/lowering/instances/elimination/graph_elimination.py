"""The elimination of joints in any graph, along constant arrays of the neighbours of each joint and of their pairs.

The blocks of the joints are factorised as L D L^T, or inverted, which is D without L. Between a joint and a neighbour
is Z = L^-1 S: the elimination subtracts Z^T D^-1 Z from the block of the neighbour. The back substitution multiplies by
L^-T once for each joint, and not once for each neighbour.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import accumulate, chain, combinations

import casadi as ca

from derive.ir.expressions import Element, Operator
from derive.ir.indices import ElementIndex, IndexTerm, constant
from derive.ir.statements import Entry, ForEach, InstanceItem, InstanceStatement, Work
from derive.lowering.instances.elimination.block_body import (
    Adjugate,
    Block,
    BlockBody,
    Factors,
    diagonal,
    plus,
    product,
    transposed,
)
from derive.lowering.instances.elimination.block_system import COUPLING, DIAGONAL, FORCE, KNOWN, RIGHT, Blocks
from derive.lowering.instances.places import Places

FACTOR, INVERSE, SCALE, LOWER = "factor", "inverse", "scale", "lower"
"""The local arrays of D^-1 Z, of the inverse or the factors of one block, of the diagonals before, with which pivots
are compared, and of L below its diagonal."""
JOINT, NEIGHBOUR, PAIR = "joint", "neighbour", "pair"
"""The variables of the loops over joints, their neighbours and pairs of these."""


def in_graph(of: Blocks, places: Places, has_known: bool) -> tuple[InstanceStatement, ...]:
    """The elimination of all joints and the back substitution; has_known: whether there is an array KNOWN.

    The arrays of the first body of a joint take what its bodies contribute together, and what elimination leaves of it.
    The solution begins as D^-1 L^-1 times what is left of the right-hand side.
    """
    return _Graph(of, places).statements(has_known)


class _Graph:
    """The loops over the joints of a system."""

    def __init__(self, of: Blocks, places: Places) -> None:
        self.of, self.places, self.size = of, places, of.size
        self.below = [(i, j) for i in range(of.size) for j in range(i)]

    def statements(self, has_known: bool) -> tuple[InstanceStatement, ...]:
        """All loops, and the arrays that they need."""
        of = self.of
        head, inverse = self._head()
        has_factors = isinstance(inverse, Factors) and bool(self.of.couplings and self.below)
        forward, backward = list[InstanceItem](head), list[InstanceItem]()
        works = [Work(SCALE, of.size * of.spacing, spacing=of.spacing)]
        if self.of.couplings:
            works.append(Work(FACTOR, of.coupling_spacing * of.size**2, spacing=of.coupling_spacing))
            works.append(Work(INVERSE, of.packed))
            forward += each_neighbour(of, self.places, self._neighbour(inverse))
            backward += each_neighbour(of, self.places, self._known())
        if has_factors:
            works.append(Work(LOWER, len(self.below) * of.spacing, spacing=of.spacing))
            backward += self._transposed_factor()
        forward += each_pair(of, self.places, FACTOR)
        loops = [each_joint(of, self._assembled(has_known)), each_joint(of, forward)]
        return (*works, *loops, *([each_joint(of, backward, backward=True)] if backward else []))

    def _own(self, array: str) -> Callable[[int], Element]:
        """The components of a joint in an array."""
        return at(array, self.of.spacing, JOINT)

    def _between(self, array: str) -> Callable[[int], Element]:
        """The components of the block of a joint and a neighbour."""
        return at(array, self.of.coupling_spacing, NEIGHBOUR)

    def _assembled(self, has_known: bool) -> tuple[InstanceItem, ...]:
        """The block and the right-hand side of a joint, and its diagonal before the elimination of other joints."""
        body = BlockBody(self.size)
        block = plus(*(body.symmetric(f"{name}_", self._own(name)) for name in DIAGONAL))
        names = [*RIGHT, *([KNOWN] if has_known else [])]
        right = plus(*(body.vector(f"{name}_", self._own(name)) for name in names))
        body.store_rows(self._own(SCALE), [[value] for value in diagonal(block)])
        body.store_symmetric(self._own(DIAGONAL[0]), block)
        body.store_rows(self._own(RIGHT[0]), right)
        return body.statements()

    def _head(self) -> tuple[tuple[InstanceItem, ...], Factors | Adjugate]:
        """The factors of the block of a joint, with which its neighbours are computed, and how the solution begins."""
        body = BlockBody(self.size)
        block = body.symmetric("d", self._own(DIAGONAL[0]))
        scales = body.vector("scale", self._own(SCALE))
        right = body.vector("r", self._own(RIGHT[0]))
        inverse = body.inverse(block, [value for (value,) in scales], self.of.closes_loops)
        if not self.of.couplings:
            body.store_rows(self._own(FORCE), inverse.solve(right))
            return body.statements(), inverse
        body.store_rows(self._own(FORCE), inverse.middle(inverse.forward(right)))
        body.store_symmetric(lambda k: Element(INVERSE, constant(k)), inverse.block)
        if isinstance(inverse, Factors):
            for k, (i, j) in enumerate(self.below):
                body.store(self._own(LOWER)(k), inverse.lower[i][j])
        return body.statements(), inverse

    def _neighbour(self, inverse: Factors | Adjugate) -> tuple[InstanceItem, ...]:
        """The update of a neighbour by the elimination of a joint; pairs of neighbours read Z in the place of S."""
        body = BlockBody(self.size)
        s = body.matrix("s", self._between(COUPLING))
        factors = inverse.of_block(body.symmetric("a", lambda k: Element(INVERSE, constant(k))))
        z = factors.forward(s)
        y = factors.middle(z)
        w = body.vector("w", self._own(FORCE))
        if any(len(own) > 1 for own in self.of.neighbours):
            _replace(body, self._between(COUPLING), s, z)
        body.store_rows(self._between(FACTOR), y)
        spacing = self.of.spacing
        body.store_symmetric(at(DIAGONAL[0], spacing, "other"), product(transposed(z), y), Operator.SUB)
        body.store_rows(at(RIGHT[0], spacing, "other"), product(transposed(z), w), Operator.SUB)
        return body.statements()

    def _known(self) -> tuple[InstanceItem, ...]:
        """The update of the solution of a joint by the reactions of a neighbour."""
        body = BlockBody(self.size)
        f = body.vector("f", at(FORCE, self.of.spacing, "other"))
        body.store_rows(self._own(FORCE), product(body.matrix("y", self._between(FACTOR)), f), Operator.SUB)
        return body.statements()

    def _transposed_factor(self) -> tuple[InstanceItem, ...]:
        """The reactions of a joint: L^-T times what is left of the solution."""
        body = BlockBody(self.size)
        lower = [[ca.SX(0)] * self.size for _ in range(self.size)]
        for k, (i, j) in enumerate(self.below):
            lower[i][j] = body.element(f"l{i}{j}", self._own(LOWER)(k))
        x = body.vector("f", self._own(FORCE))
        _replace(body, self._own(FORCE), x, Factors(lower, []).backward(x))
        return body.statements()


def _replace(body: BlockBody, at: Callable[[int], Element], old: Block, new: Block) -> None:
    """Write those entries of a block that have changed."""
    for k, (before, value) in enumerate(zip(chain(*old), chain(*new), strict=True)):
        if not ca.is_equal(before, value):
            body.store(at(k), value)


def index_of(variable: str) -> ElementIndex:
    """The index that a variable is."""
    return ElementIndex(0, (IndexTerm(1, variable),))


def at(array: str, spacing: int, variable: str) -> Callable[[int], Element]:
    """The components of the block that a variable counts, in an array of one component after the other."""
    return lambda component: Element(array, index_of(variable).plus(component * spacing))


def each_joint(of: Blocks, body: Iterable[InstanceItem], backward: bool = False) -> ForEach:
    """A loop over all joints."""
    return ForEach(JOINT, constant(0), constant(of.joints), tuple(body), backward)


def each_neighbour(of: Blocks, places: Places, body: tuple[InstanceItem, ...]) -> Iterator[InstanceItem]:
    """The loop over the neighbours `other` of a joint that are eliminated later, if there are any."""
    others = [other for neighbours in of.neighbours for other, _ in neighbours]
    if others:
        yield from _part(places, NEIGHBOUR, "neighbours", map(len, of.neighbours))
        other = Entry("other", places.integers("neighbours", others), index_of(NEIGHBOUR))
        yield ForEach(NEIGHBOUR, index_of("first_neighbour"), index_of("last_neighbour"), (other, *body))


def each_pair(of: Blocks, places: Places, factor: str) -> Iterator[InstanceItem]:
    """The loop over pairs of these neighbours, if there are any: the elimination of the joint changes their blocks.

    factor: the array of D^-1 Z; the blocks themselves contain Z.
    """
    numbers = [[(a, b, of.block(i, j)) for (i, a), (j, b) in combinations(own, 2)] for own in of.neighbours]
    pairs, spacing = [*chain(*numbers)], of.coupling_spacing
    if pairs:
        body = BlockBody(of.size)
        z = body.matrix("z", at(COUPLING, spacing, "first_block"))
        y = body.matrix("y", at(factor, spacing, "second_block"))
        body.store_rows(at(COUPLING, spacing, "filled_block"), product(transposed(z), y), Operator.SUB)
        names = ("first_block", "second_block", "filled_block")
        blocks = (
            Entry(name, places.integers(f"{name}s", [pair[k] for pair in pairs]), index_of(PAIR))
            for k, name in enumerate(names)
        )
        yield from _part(places, PAIR, "pairs", map(len, numbers))
        yield ForEach(PAIR, index_of("first_pair"), index_of("last_pair"), (*blocks, *body.statements()))


def _part(places: Places, variable: str, plural: str, counts: Iterable[int]) -> Iterator[Entry]:
    """The first and the last of the numbers that belong to a joint, where each joint has so many."""
    starts = places.integers(f"first_{plural}", accumulate(counts, initial=0))
    yield Entry(f"first_{variable}", starts, index_of(JOINT))
    yield Entry(f"last_{variable}", starts, index_of(JOINT).plus(1))
