"""The elimination of joints in any graph, along constant arrays of the neighbours of each joint and of their pairs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import accumulate, chain

from derive.ir.expressions import Element, Operator
from derive.ir.indices import ElementIndex, IndexTerm, constant
from derive.ir.statements import Entry, ForEach, InstanceItem, InstanceStatement, Work
from derive.lowering.instances.block_body import BlockBody, diagonal, plus, product, transposed
from derive.lowering.instances.block_system import COUPLING, DIAGONAL, FORCE, KNOWN, RIGHT, Blocks
from derive.lowering.instances.places import Places

FACTOR, INVERSE, SCALE = "factor", "inverse", "scale"
"""The local arrays of the blocks after the elimination of their first joint, of the inverse of a block, and of
the diagonals before, with which pivots are compared."""
JOINT, NEIGHBOUR, PAIR = "joint", "neighbour", "pair"
"""The variables of the loops over joints, their neighbours and pairs of these."""


def in_graph(of: Blocks, places: Places, has_known: bool) -> tuple[InstanceStatement, ...]:
    """The elimination of all joints and the back substitution; has_known: whether there is an array KNOWN.

    What elimination subtracts from a neighbour goes to the array of its first body. The solution begins as what is left
    of the right-hand side.
    """
    size, square, spacing, blocks = of.size, of.size**2, of.spacing, of.coupling_spacing
    others = [other for neighbours in of.neighbours for other, _ in neighbours]
    starts = list(accumulate(map(len, of.neighbours), initial=0))
    every_pair = [list(pairs_of(of, place)) for place in range(of.joints)]
    pairs = list(chain(*every_pair))
    first_pairs = list(accumulate(map(len, every_pair), initial=0))
    first_neighbours = places.integers("first_neighbours", starts)
    bounds = [
        Entry("first_neighbour", first_neighbours, index_of(JOINT)),
        Entry("last_neighbour", first_neighbours, index_of(JOINT).plus(1)),
    ]
    every = index_of("first_neighbour"), index_of("last_neighbour")
    head = BlockBody(size)
    block = plus(*(head.symmetric(f"{name}_", at(name, spacing, JOINT)) for name in DIAGONAL))
    scales = head.vector("scale", at(SCALE, spacing, JOINT))
    names = [*RIGHT, *([KNOWN] if has_known else [])]
    right = plus(*(head.vector(f"{name}_", at(name, spacing, JOINT)) for name in names))
    inverse = head.inverse(block, [value for (value,) in scales], of.closes_loops)
    head.store_rows(at(FORCE, spacing, JOINT), inverse.solve(right))
    forward: list[InstanceItem] = []
    backward: list[InstanceItem] = []
    works = [Work(FACTOR, blocks * square, spacing=blocks), Work(INVERSE, of.packed)] if others else []
    if others:
        other = Entry("other", places.integers("neighbours", others), index_of(NEIGHBOUR))
        head.store_symmetric(_fixed(INVERSE), inverse.block)
        inner = BlockBody(size)
        s = inner.matrix("s", at(COUPLING, blocks, NEIGHBOUR))
        y = type(inverse).of_block(inner.symmetric("a", _fixed(INVERSE))).solve(s)
        w = inner.vector("w", at(FORCE, spacing, JOINT))
        inner.store_rows(at(FACTOR, blocks, NEIGHBOUR), y)
        inner.store_symmetric(at(DIAGONAL[0], spacing, "other"), product(transposed(s), y), Operator.SUB)
        inner.store_rows(at(RIGHT[0], spacing, "other"), product(transposed(s), w), Operator.SUB)
        forward += [*bounds, ForEach(NEIGHBOUR, *every, (other, *inner.statements()))]
        back = BlockBody(size)
        known = product(back.matrix("y", at(FACTOR, blocks, NEIGHBOUR)), back.vector("f", at(FORCE, spacing, "other")))
        back.store_rows(at(FORCE, spacing, JOINT), known, Operator.SUB)
        backward += [*bounds, ForEach(NEIGHBOUR, *every, (other, *back.statements()))]
    if pairs:
        update = BlockBody(size)
        s = update.matrix("s", at(COUPLING, blocks, "first_block"))
        y = update.matrix("y", at(FACTOR, blocks, "second_block"))
        update.store_rows(at(COUPLING, blocks, "filled_block"), product(transposed(s), y), Operator.SUB)
        columns = {
            name: places.integers(f"{name}s", [pair[k] for pair in pairs])
            for k, name in enumerate(("first_block", "second_block", "filled_block"))
        }
        entries = (Entry(name, array, index_of(PAIR)) for name, array in columns.items())
        starts_of_pairs = places.integers("first_pairs", first_pairs)
        forward += [
            Entry("first_pair", starts_of_pairs, index_of(JOINT)),
            Entry("last_pair", starts_of_pairs, index_of(JOINT).plus(1)),
            ForEach(PAIR, index_of("first_pair"), index_of("last_pair"), (*entries, *update.statements())),
        ]
    whole = constant(0), constant(of.joints)
    works.append(Work(SCALE, size * spacing, spacing=spacing))
    result: list[InstanceStatement] = [*works, ForEach(JOINT, *whole, _scales(of))]
    result.append(ForEach(JOINT, *whole, (*head.statements(), *forward)))
    if backward:
        result.append(ForEach(JOINT, *whole, tuple(backward), backward=True))
    return tuple(result)


def _scales(of: Blocks) -> tuple[InstanceItem, ...]:
    """The diagonal of a block before the elimination of other joints."""
    body, spacing = BlockBody(of.size), of.spacing
    assembled = plus(*(body.symmetric(f"{name}_", at(name, spacing, JOINT)) for name in DIAGONAL))
    body.store_rows(at(SCALE, spacing, JOINT), [[value] for value in diagonal(assembled)])
    return body.statements()


def index_of(variable: str) -> ElementIndex:
    """The index that a variable is."""
    return ElementIndex(0, (IndexTerm(1, variable),))


def at(array: str, spacing: int, variable: str) -> Callable[[int], Element]:
    """The components of the block that a variable counts, in an array of one component after the other."""
    return lambda component: Element(array, index_of(variable).plus(component * spacing))


def _fixed(array: str) -> Callable[[int], Element]:
    return lambda component: Element(array, constant(component))


def pairs_of(of: Blocks, place: int) -> Iterator[tuple[int, int, int]]:
    """The blocks of two neighbours of a place, and the block of these two that its elimination changes."""
    neighbours = of.neighbours[place]
    for k, (first, a) in enumerate(neighbours):
        for second, b in neighbours[k + 1 :]:
            yield a, b, of.block(first, second)
