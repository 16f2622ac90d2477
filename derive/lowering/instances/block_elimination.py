"""The elimination of joints: a symmetric positive definite system of blocks, one for each joint.

The blocks have one size, that of the joint with the most constraints; the others are padded with unit diagonals. The
order of elimination and its fill-in are known here, so that the generated code follows constant arrays, or the order
of the joints itself where each is coupled with the next one alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import casadi as ca

from derive.ir.expressions import Element, Number, Operator, ScalarRef
from derive.ir.indices import ElementIndex, IndexTerm, constant
from derive.ir.patterns import pattern
from derive.ir.statements import (
    Entry,
    ForEach,
    InstanceItem,
    InstanceStatement,
    Let,
    Require,
    Requirement,
    ReturnCode,
    Store,
    StoreElement,
    Work,
)
from derive.lowering.elimination_orders import elimination_order
from derive.lowering.flat.body_functions import VANISHING
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.graph import Graph
from derive.lowering.flat.schedule import NamedValue, OutputValue, RequiredValue, Step, StepItem, schedule
from derive.lowering.instances.places import Places
from derive.mechanics.symbols import local

DIAGONAL, RIGHT, COUPLING, FACTOR, INVERSE, FORCE = "diagonal", "right", "coupling", "factor", "inverse", "reaction"
"""The local arrays: the blocks of the diagonal, the right-hand side, the blocks beside the diagonal, these blocks after
the elimination of their first joint, the inverse of a block, and the solution."""
JOINT, NEIGHBOUR, PAIR = "joint", "neighbour", "pair"
"""The variables of the loops over joints, their neighbours and pairs of these."""
ONE = Number(Fraction(1))


@dataclass(frozen=True)
class Blocks:
    """The structure of the system of joints.

    size: the rows of a block; rows: the constraints of each joint; position: the place of each joint in the order of
    elimination, by which all arrays are numbered; neighbours: for each place the later places that it is coupled with
    when it is eliminated, each with the number of its block.
    """

    size: int
    rows: tuple[int, ...]
    position: tuple[int, ...]
    neighbours: tuple[tuple[tuple[int, int], ...], ...]

    @property
    def joints(self) -> int:
        """The number of joints."""
        return len(self.rows)

    @property
    def packed(self) -> int:
        """The elements of a symmetric block."""
        return self.size * (self.size + 1) // 2

    @property
    def couplings(self) -> int:
        """The number of blocks beside the diagonal."""
        return sum(map(len, self.neighbours))

    @property
    def is_path(self) -> bool:
        """Whether each joint is coupled with the next one alone."""
        last = self.joints - 1
        return all(of == (((s + 1, s),) if s < last else ()) for s, of in enumerate(self.neighbours))

    def block(self, first: int, second: int) -> int:
        """The number of the block of two places, the earlier one first."""
        return dict(self.neighbours[first])[second]


def blocks(rows: Sequence[int], cliques: Iterable[Sequence[int]]) -> Blocks:
    """The structure of the system; rows: the constraints of each joint; cliques: the joints of each body."""
    count = len(rows)
    adjacent: list[set[int]] = [set() for _ in range(count)]
    for clique in cliques:
        for joint in clique:
            adjacent[joint] |= {other for other in clique if other != joint}
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
    return Blocks(max(rows), tuple(rows), tuple(position), tuple(neighbours))


def _order(adjacent: list[set[int]]) -> tuple[int, ...]:
    """An order of little fill-in: paths from one end to the other, in the order of the joints; else minimum degree."""
    if all(others <= {joint - 1, joint + 1} for joint, others in enumerate(adjacent)):
        return tuple(range(len(adjacent)))
    count = len(adjacent)
    entries = {(max(i, j), min(i, j)) for i, others in enumerate(adjacent) for j in others}
    return elimination_order(pattern(count, count, entries, symmetric=True))


def packed(size: int, i: int, j: int) -> int:
    """The index of entry (i, j) of a symmetric block, rows i <= j."""
    i, j = min(i, j), max(i, j)
    return i * size - i * (i - 1) // 2 + j - i


# ---- statements ----


class _Body:
    """The statements of one loop body, from CasADi expressions of elements of arrays."""

    def __init__(self) -> None:
        self.symbols = Symbols(frozenset(), frozenset())
        self.items: list[StepItem] = []
        self.targets: dict[tuple[str, int], tuple[Element, Operator | None]] = {}
        self.loads: list[Let] = []

    def element(self, name: str, array: str, index: ElementIndex) -> ca.SX:
        """The value of an element, which is loaded under a name."""
        symbol = local(name)
        self.symbols.input(symbol, ScalarRef(name))
        self.loads.append(Let(name, Element(array, index)))
        return self.symbols.values[symbol]

    def named(self, name: str, value: ca.SX) -> None:
        """Name a value."""
        self.items.append(NamedValue(name, value))

    def store(self, array: str, index: ElementIndex, value: ca.SX, operator: Operator | None = None) -> None:
        """Write an element."""
        key = (array, len(self.targets))
        self.targets[key] = Element(array, index), operator
        self.items.append(OutputValue(*key, value))

    def positive(self, value: ca.SX, text: str) -> None:
        """Require that a value is positive."""
        self.items.append(RequiredValue(Requirement.POSITIVE, value, ReturnCode.PIVOT, text))

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


def _at(variable: str, stride: int, offset: int = 0) -> ElementIndex:
    return ElementIndex(offset, (IndexTerm(stride, variable),))


def declared(of: Blocks) -> tuple[InstanceStatement, ...]:
    """The arrays of the system, which begin as zeros, and as ones on the padded diagonals."""
    n, size = of.joints, of.size
    arrays = ((DIAGONAL, n * of.packed), (RIGHT, n * size), (COUPLING, of.couplings * size**2))
    works = [Work(array, count, cleared=True) for array, count in arrays if count]
    works += [Work(FACTOR, max(1, of.couplings) * size**2), Work(INVERSE, of.packed), Work(FORCE, n * size)]
    ones = [
        StoreElement(Element(DIAGONAL, constant(of.position[joint] * of.packed + packed(size, k, k))), ONE)
        for joint, rows in enumerate(of.rows)
        for k in range(rows, size)
    ]
    return (*works, *_ones(ones))


def _ones(stores: list[StoreElement]) -> list[InstanceStatement]:
    """The ones of padded diagonals, in a loop if they are equally spaced."""
    firsts = [store.target.index.offset for store in stores if store.target.index]
    if len(firsts) > 2 and all(b - a == firsts[1] - firsts[0] for a, b in pairwise(firsts)):
        target = Element(DIAGONAL, _at(JOINT, firsts[1] - firsts[0], firsts[0]))
        return [ForEach(JOINT, constant(0), constant(len(firsts)), (StoreElement(target, ONE),))]
    return list(stores)


def eliminated(of: Blocks, places: Places) -> tuple[InstanceStatement, ...]:
    """The elimination of all joints and the back substitution, from the arrays of the system to the reactions."""
    return _along_path(of) if of.is_path else _in_graph(of, places)


def _inverse(body: _Body, size: int, index: ElementIndex) -> list[list[ca.SX]]:
    """The inverse of a symmetric block by its cofactors, whose leading minors must be positive."""
    entries = {
        packed(size, i, j): body.element(f"d{i}{j}", DIAGONAL, index.plus(packed(size, i, j)))
        for i in range(size)
        for j in range(i, size)
    }
    d = [[entries[packed(size, i, j)] for j in range(size)] for i in range(size)]
    margin = body.symbols.number(VANISHING)
    text = "the pivot of a joint vanished"
    if size == 1:
        body.positive(d[0][0], text)
        return [[1 / d[0][0]]]
    if size == 2:
        determinant = d[0][0] * d[1][1] - d[0][1] * d[0][1]
        body.positive(d[0][0], text)
        body.positive(determinant - margin * (d[0][0] * d[1][1]), text)
        inverse = 1 / determinant
        return [[d[1][1] * inverse, -d[0][1] * inverse], [-d[0][1] * inverse, d[0][0] * inverse]]
    if size == 3:
        a = [[ca.SX(0)] * 3 for _ in range(3)]
        a[0][0] = d[1][1] * d[2][2] - d[1][2] * d[1][2]
        a[0][1] = d[0][2] * d[1][2] - d[0][1] * d[2][2]
        a[0][2] = d[0][1] * d[1][2] - d[0][2] * d[1][1]
        a[1][1] = d[0][0] * d[2][2] - d[0][2] * d[0][2]
        a[1][2] = d[0][1] * d[0][2] - d[0][0] * d[1][2]
        a[2][2] = d[0][0] * d[1][1] - d[0][1] * d[0][1]
        determinant = d[0][0] * a[0][0] + d[0][1] * a[0][1] + d[0][2] * a[0][2]
        body.positive(d[0][0], text)
        body.positive(a[2][2], text)
        body.positive(determinant - margin * (a[2][2] * d[2][2]), text)
        inverse = 1 / determinant
        return [[a[min(i, j)][max(i, j)] * inverse for j in range(3)] for i in range(3)]
    raise NotImplementedError("blocks of more than three constraints")


def _product(a: list[list[ca.SX]], b: list[list[ca.SX]]) -> list[list[ca.SX]]:
    inner, cols = range(len(b)), range(len(b[0]))
    return [[_sum(row[k] * b[k][j] for k in inner) for j in cols] for row in a]


def _sum(values: Iterable[ca.SX]) -> ca.SX:
    first, *others = values
    for other in others:
        first = first + other
    return first


def _matrix(body: _Body, name: str, size: int, array: str, index: ElementIndex) -> list[list[ca.SX]]:
    every = range(size)
    return [[body.element(f"{name}{i}{j}", array, index.plus(size * i + j)) for j in every] for i in every]


def _vector(body: _Body, name: str, size: int, array: str, index: ElementIndex) -> list[list[ca.SX]]:
    return [[body.element(f"{name}{i}", array, index.plus(i))] for i in range(size)]


def _store_vector(body: _Body, array: str, index: ElementIndex, values: list[list[ca.SX]]) -> None:
    for i, (value,) in enumerate(values):
        body.store(array, index.plus(i), value)


def _reduce(
    body: _Body, size: int, s: list[list[ca.SX]], y: list[list[ca.SX]], w: list[list[ca.SX]], at: Sequence[ElementIndex]
) -> None:
    """Subtract what an eliminated joint contributes to the block and to the right-hand side of a neighbour."""
    diagonal, right = at
    for i in range(size):
        for j in range(i, size):
            update = _sum(s[k][i] * y[k][j] for k in range(size))
            body.store(DIAGONAL, diagonal.plus(packed(size, i, j)), update, Operator.SUB)
        body.store(RIGHT, right.plus(i), _sum(s[k][i] * w[k][0] for k in range(size)), Operator.SUB)


def _store_matrix(body: _Body, array: str, index: ElementIndex, values: list[list[ca.SX]]) -> None:
    for i, row in enumerate(values):
        for j, value in enumerate(row):
            body.store(array, index.plus(len(values) * i + j), value)


def _along_path(of: Blocks) -> tuple[InstanceStatement, ...]:
    """A recurrence: each joint is coupled with the next one alone."""
    size, last = of.size, of.joints - 1
    body = _Body()
    inverse = _inverse(body, size, _at(JOINT, of.packed))
    w = _product(inverse, _vector(body, "r", size, RIGHT, _at(JOINT, size)))
    s = _matrix(body, "s", size, COUPLING, _at(JOINT, size**2))
    y = _product(inverse, s)
    _store_vector(body, RIGHT, _at(JOINT, size), w)
    _store_matrix(body, FACTOR, _at(JOINT, size**2), y)
    _reduce(body, size, s, y, w, (_at(JOINT, of.packed, of.packed), _at(JOINT, size, size)))
    forward = ForEach(JOINT, constant(0), constant(last), body.statements())
    end = _Body()
    inverse = _inverse(end, size, constant(last * of.packed))
    w = _product(inverse, _vector(end, "r", size, RIGHT, constant(last * size)))
    _store_vector(end, FORCE, constant(last * size), w)
    back = _Body()
    y = _matrix(back, "y", size, FACTOR, _at(JOINT, size**2))
    known = _product(y, _vector(back, "f", size, FORCE, _at(JOINT, size, size)))
    w = _vector(back, "w", size, RIGHT, _at(JOINT, size))
    _store_vector(back, FORCE, _at(JOINT, size), [[w[i][0] - known[i][0]] for i in range(size)])
    backward = ForEach(JOINT, constant(0), constant(last), back.statements(), backward=True)
    ends = ForEach(JOINT, constant(0), constant(1), end.statements())
    return (*((forward,) if last else ()), ends, *((backward,) if last else ()))


def _in_graph(of: Blocks, places: Places) -> tuple[InstanceStatement, ...]:
    """The elimination along constant arrays of the neighbours of each joint and of the pairs of these."""
    size, square = of.size, of.size**2
    starts = [0]
    others: list[int] = []
    pairs: list[tuple[int, int, int]] = []
    first_pairs = [0]
    for place, neighbours in enumerate(of.neighbours):
        others += [other for other, _ in neighbours]
        starts.append(len(others))
        pairs += list(_pairs(of, place))
        first_pairs.append(len(pairs))
    names = {
        "first_neighbour": places.integers("first_neighbours", starts),
        "other": places.integers("neighbours", others),
    }
    first = Entry("first_neighbour", names["first_neighbour"], _at(JOINT, 1))
    after = Entry("last_neighbour", names["first_neighbour"], _at(JOINT, 1, 1))
    other = Entry("other", names["other"], _at(NEIGHBOUR, 1)) if others else None
    head = _Body()
    inverse = _inverse(head, size, _at(JOINT, of.packed))
    _store_vector(head, RIGHT, _at(JOINT, size), _product(inverse, _vector(head, "r", size, RIGHT, _at(JOINT, size))))
    for i in range(size):
        for j in range(i, size):
            head.store(INVERSE, constant(packed(size, i, j)), inverse[i][j])
    forward: list[InstanceItem] = [*head.statements()]
    bounds = (_at("first_neighbour", 1), _at("last_neighbour", 1))
    if other is not None:
        inner = _Body()
        entries = {p: inner.element(f"inverse_{p}", INVERSE, constant(p)) for p in range(of.packed)}
        known = [[entries[packed(size, i, j)] for j in range(size)] for i in range(size)]
        s = _matrix(inner, "s", size, COUPLING, _at(NEIGHBOUR, square))
        y = _product(known, s)
        w = _vector(inner, "w", size, RIGHT, _at(JOINT, size))
        _store_matrix(inner, FACTOR, _at(NEIGHBOUR, square), y)
        _reduce(inner, size, s, y, w, (_at("other", of.packed), _at("other", size)))
        forward += [first, after, ForEach(NEIGHBOUR, *bounds, (other, *inner.statements()))]
    if pairs:
        update = _Body()
        s = _matrix(update, "s", size, COUPLING, _at("first_block", square))
        y = _matrix(update, "y", size, FACTOR, _at("second_block", square))
        for i in range(size):
            for j in range(size):
                value = _sum(s[k][i] * y[k][j] for k in range(size))
                update.store(COUPLING, _at("filled_block", square, size * i + j), value, Operator.SUB)
        starts_of_pairs = places.integers("first_pairs", first_pairs)
        columns = {
            name: places.integers(f"{name}s", [pair[k] for pair in pairs])
            for k, name in enumerate(("first_block", "second_block", "filled_block"))
        }
        entries_of = (Entry(name, array, _at(PAIR, 1)) for name, array in columns.items())
        forward += [
            Entry("first_pair", starts_of_pairs, _at(JOINT, 1)),
            Entry("last_pair", starts_of_pairs, _at(JOINT, 1, 1)),
            ForEach(PAIR, _at("first_pair", 1), _at("last_pair", 1), (*entries_of, *update.statements())),
        ]
    start = _Body()
    _store_vector(start, FORCE, _at(JOINT, size), _vector(start, "w", size, RIGHT, _at(JOINT, size)))
    backward: list[InstanceItem] = [*start.statements()]
    if other is not None:
        back = _Body()
        y = _matrix(back, "y", size, FACTOR, _at(NEIGHBOUR, square))
        known = _product(y, _vector(back, "f", size, FORCE, _at("other", size)))
        for i in range(size):
            back.store(FORCE, _at(JOINT, size, i), known[i][0], Operator.SUB)
        backward += [first, after, ForEach(NEIGHBOUR, *bounds, (other, *back.statements()))]
    whole = constant(0), constant(of.joints)
    return ForEach(JOINT, *whole, tuple(forward)), ForEach(JOINT, *whole, tuple(backward), backward=True)


def _pairs(of: Blocks, place: int) -> Iterator[tuple[int, int, int]]:
    """The blocks of two neighbours of a place, and the block of these two that its elimination changes."""
    neighbours = of.neighbours[place]
    for k, (first, a) in enumerate(neighbours):
        for second, b in neighbours[k + 1 :]:
            yield a, b, of.block(first, second)
