"""The system of the joints: symmetric, positive definite, with a block for each joint and for each coupled pair.

The blocks have one size, that of the joint with the most constraints; the others are padded with unit diagonals. What
the first and the second body of a joint contribute lies in arrays of their own, which a body writes and the elimination
adds, so that bodies are independent of each other. An array holds one component of all blocks after the other.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, zip_longest

from derive.ir.expressions import Element, Number
from derive.ir.indices import LANES, constant, padded
from derive.ir.patterns import pattern
from derive.ir.statements import InstanceStatement, StoreElement, Work
from derive.lowering.elimination_orders import elimination_order, rounds_of_least_degree, work
from derive.lowering.instances.classes.body_classes import NO_JOINT

DIAGONAL, RIGHT = ("first_diagonal", "second_diagonal"), ("first_right", "second_right")
"""The local arrays of what the first and the second body of a joint contribute."""
FLOOR = ("first_floor", "second_floor")
"""The local arrays of what they contribute to the least weights of a proximal term."""
COUPLING, KNOWN, FORCE = "coupling", "known_right", "reaction"
"""The local arrays of the blocks beside the diagonal, of what is known of the right-hand side, and of the solution."""
LARGEST_PACKED = 3
"""The largest symmetric blocks of which one half is stored without gaps."""
FEW = 24
"""Elements that no body writes and that are stored one by one; where there are more, an array begins as zeros."""
FEW_NEIGHBOURS = 4
"""Coupled pairs of joints, divided by the number of joints, up to which their number counts as small."""
ZERO, ONE = Number(Fraction(0)), Number(Fraction(1))
LARGE = Number(Fraction(2**200))
"""The diagonal of a row that a joint does not have where bodies write it: all else of the row is nothing beside it.

So bodies need not leave out what they write to such rows, and the joint has the steps of others. It is a power of two,
which rounds nothing, and small enough for its square in determinants.
"""


@dataclass(frozen=True)
class Blocks:
    """The structure of the system of joints.

    Gears are joints here, to whose blocks their bodies add.

    size: the rows of a block; rows: the constraints of each joint; position: the place of each joint in the order of
    elimination, by which all arrays are numbered; neighbours: for each place the later places that it is coupled with
    when it is eliminated, each with the number of its block; sides: the places that have a first and a second body
    with unknowns; writers: the number of bodies that write each block; closes_loops: whether the joints close loops of
    bodies, with the ground as one of them, or gears may; has_spare: whether the arrays have a place and a block more,
    to which goes what nothing reads.
    """

    size: int
    rows: tuple[int, ...]
    position: tuple[int, ...]
    neighbours: tuple[tuple[tuple[int, int], ...], ...]
    sides: tuple[frozenset[int], frozenset[int]]
    writers: tuple[int, ...]
    closes_loops: bool
    has_spare: bool = False

    @property
    def joints(self) -> int:
        """The number of joints."""
        return len(self.rows)

    @property
    def packed(self) -> int:
        """The elements of a symmetric block, see `packed`."""
        return 1 + packed(self.size, self.size - 1, self.size - 1)

    @property
    def couplings(self) -> int:
        """The number of blocks beside the diagonal."""
        return len(self.writers)

    @property
    def spacing(self) -> int:
        """The distance of the components of a block, in arrays with those of each joint."""
        return spaced(self.joints + self.has_spare)

    @property
    def coupling_spacing(self) -> int:
        """The distance of the components of a block beside the diagonal."""
        return spaced(self.couplings + self.has_spare)

    @property
    def adds(self) -> bool:
        """Whether several bodies write one block beside the diagonal, to which they then add."""
        return max(self.writers, default=0) > 1

    @property
    def is_path(self) -> bool:
        """Whether each joint is coupled with the next one alone."""
        last = self.joints - 1
        return all(of == (((s + 1, s),) if s < last else ()) for s, of in enumerate(self.neighbours))

    def place(self, joint: int) -> int:
        """The place of a joint; that of none is the spare one, behind all others."""
        return self.joints if joint == NO_JOINT else self.position[joint]

    def block(self, first: int, second: int) -> int:
        """The number of the block of two places; if one of them is spare, so is the block."""
        first, second = sorted((first, second))
        return self.couplings if second == self.joints else dict(self.neighbours[first])[second]

    def left(self) -> dict[str, dict[int, bool]]:
        """The elements of each array that no body writes, and whether they are ones: padded diagonals are."""
        n, size = self.joints, self.size
        rows = [0] * n
        for joint, place in enumerate(self.position):
            rows[place] = self.rows[joint]
        result: dict[str, dict[int, bool]] = {}
        for side in (0, 1):
            own = [rows[place] if place in self.sides[side] else 0 for place in range(n)]
            cells = [(i, j) for i in range(size) for j in range(i, size)]
            result[DIAGONAL[side]] = {
                packed(size, i, j) * self.spacing + p: side == 0 and i == j and i >= rows[p]
                for i, j in cells
                for p in range(n)
                if j >= own[p]
            }
            left = {i * self.spacing + p: False for i in range(size) for p in range(n) if i >= own[p]}
            result[RIGHT[side]] = result[FLOOR[side]] = left
        ends = [(place, other) for place, others in enumerate(self.neighbours) for other, _ in others]
        result[COUPLING] = {
            (size * i + j) * self.coupling_spacing + b: False
            for b, (place, other) in enumerate(ends)
            for i in range(size)
            for j in range(size)
            if not self.writers[b] or self.adds or i >= rows[place] or j >= rows[other]
        }
        return result


def _closes_loops(count: int, handles: Sequence[Sequence[tuple[int, bool]]]) -> bool:
    """Whether some of the joints are between bodies that others connect already; the last body is the ground."""
    ends: list[list[int]] = [[] for _ in range(count)]
    for body, own in enumerate(handles):
        for joint, _ in own:
            ends[joint].append(body)
    parent = list(range(len(handles) + 1))

    def root(body: int) -> int:
        while parent[body] != body:
            parent[body] = parent[parent[body]]
            body = parent[body]
        return body

    for bodies in ends:
        first, second = (root(body) for body in [*bodies, len(handles), len(handles)][:2])
        if first == second:
            return True
        parent[first] = second
    return False


def blocks(
    rows: Sequence[int],
    handles: Iterable[Sequence[tuple[int, bool]]],
    gears: Sequence[Sequence[int]] = (),
) -> Blocks:
    """The structure of the system.

    rows: the constraints of each joint, and behind them of gears; handles: the joints of each body, and whether it is
    their first body; gears: those of each body.
    """
    handles = list(handles)
    count = len(rows)
    adjacent: list[set[int]] = [set() for _ in range(count)]
    for own, of_gears in zip_longest(handles, gears, fillvalue=()):
        for a, b in combinations([*(joint for joint, _ in own), *of_gears], 2):
            adjacent[a].add(b)
            adjacent[b].add(a)
    order = _order(adjacent)
    position = [0] * count
    for place, joint in enumerate(order):
        position[joint] = place
    later = [{position[other] for other in adjacent[joint] if position[other] > position[joint]} for joint in order]
    neighbours, number = [], 0
    for place in range(count):
        others = sorted(later[place])
        neighbours.append(tuple((other, number + k) for k, other in enumerate(others)))
        number += len(others)
        for other in others:
            later[other] |= {further for further in others if further > other}
    first, second = (
        frozenset(position[j] for own in handles for j, f in own if f is is_first) for is_first in (True, False)
    )
    pairs = Counter(
        tuple(sorted((position[a], position[b]))) for own in handles for (a, _), (b, _) in combinations(own, 2)
    )
    writers = tuple(pairs[place, other] for place, of in enumerate(neighbours) for other, _ in of)
    closes_loops = any(gears) or _closes_loops(count, handles)
    return Blocks(max(rows), tuple(rows), tuple(position), tuple(neighbours), (first, second), writers, closes_loops)


def _order(adjacent: list[set[int]]) -> tuple[int, ...]:
    """An order of little fill-in: paths from one end to the other, in the order of the joints; else minimum degree.

    Of two such orders that take the same work it is the one in rounds of joints that do not wait for each other, if
    joints have few neighbours; where they have many, the elimination of a single joint occupies a processor.
    """
    if all(others <= {joint - 1, joint + 1} for joint, others in enumerate(adjacent)):
        return tuple(range(len(adjacent)))
    count = len(adjacent)
    entries = {(max(i, j), min(i, j)) for i, others in enumerate(adjacent) for j in others}
    shape = pattern(count, count, entries, symmetric=True)
    order = elimination_order(shape)
    if len(entries) > FEW_NEIGHBOURS * count:
        return order
    return min(rounds_of_least_degree(shape), order, key=lambda other: work(shape, other))


def spaced(count: int) -> int:
    """The distance of the components of `count` blocks: vectors of all of them may begin at multiples of four.

    Rows of a multiple of 32 numbers would displace each other from the cache.
    """
    return padded(count) if padded(count) % 32 else padded(count) + LANES


def packed(size: int, i: int, j: int) -> int:
    """The index of entry (i, j) of a symmetric block, rows i <= j.

    Large blocks have room for all entries, so that loops over their rows find them at equal distances.
    """
    i, j = min(i, j), max(i, j)
    return i * size - i * (i - 1) // 2 + j - i if size <= LARGEST_PACKED else i * size + j


def declared(
    of: Blocks, has_known: bool, has_floor: bool, written: Container[tuple[str, int]] = ()
) -> tuple[InstanceStatement, ...]:
    """The arrays of the system with all elements that no body writes.

    has_known: whether something of the right-hand side is known; has_floor: whether there are least weights; written:
    elements that bodies write also where joints do not have the row.
    """
    left = of.left()
    sizes: dict[str, tuple[int, int]] = {}
    for side in (0, 1):
        sizes[DIAGONAL[side]] = of.packed, of.spacing
        sizes |= dict.fromkeys((RIGHT[side], *((FLOOR[side],) if has_floor else ())), (of.size, of.spacing))
    sizes |= {COUPLING: (of.size**2, of.coupling_spacing)} if of.couplings else {}
    result: list[InstanceStatement] = []
    for array, (components, spacing) in sizes.items():
        cleared = len(left[array]) > FEW
        result.append(Work(array, components * spacing, cleared, spacing))
        result += [
            StoreElement(Element(array, constant(index)), (LARGE if written else ONE) if one else ZERO)
            for index, one in sorted(left[array].items())
            if one or not (cleared or (array, index) in written)
        ]
    if has_known:
        result.append(Work(KNOWN, of.size * of.spacing, True, of.spacing))
    return (*result, Work(FORCE, of.size * of.spacing, spacing=of.spacing))


def spare_reactions(of: Blocks) -> tuple[InstanceStatement, ...]:
    """Zeros at the spare place of the solution, which bodies read for joints that they do not have."""
    return tuple(StoreElement(Element(FORCE, constant(k * of.spacing + of.joints)), ZERO) for k in range(of.size))
