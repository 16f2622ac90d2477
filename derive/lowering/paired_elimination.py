"""Pairs of a coordinate and a multiplier that are eliminated together, before the rest of a KKT matrix is factorised.

A constraint with a constant factor g of a coordinate gives its acceleration as a function of the others, and the row of
the coordinate gives the multiplier. The block [m, g; g, 0] is regular whatever m is, its inverse [0, 1/g; 1/g, -m/g^2]
divides by numbers alone, and multipliers stay without a diagonal entry: what is left is again a KKT matrix, whose mass
matrix is that of the motions that meet the eliminated constraints, and which has full rank whenever the whole one has.

In space a joint of two points has such factors for the translations of its bodies. Along a tree of bodies the pairs
leave rotations alone, with the composite inertias behind each joint. What the body of a pair has in the constraint
besides its translation first changes the translation to that of the point of the joint, so that the constraint couples
this point with the body before it, and the levers of both joints of a body enter as their difference.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations_with_replacement

import casadi as ca

from derive.ir.patterns import Pattern
from derive.ir.patterns import pattern as pattern_of
from derive.lowering.congruences import AddedRow, Columns, Entries, columns_of, lower_triangle
from derive.lowering.elimination_orders import graph_of

GROUND = -1
"""The end of a constraint that has a single coordinate with a constant factor."""


@dataclass(frozen=True)
class Pair:
    """A multiplier and the coordinate that its constraint determines: rows of the KKT matrix."""

    coordinate: int
    multiplier: int


def rows_of(pairs: Iterable[Pair]) -> tuple[int, ...]:
    """The rows of pairs, in the order of their elimination."""
    return tuple(row for pair in pairs for row in (pair.coordinate, pair.multiplier))


def forest_of_pairs(pattern: Pattern, coordinates: int, constant: Iterable[tuple[int, int]]) -> tuple[Pair, ...]:
    """Pairs whose constraints are independent of each other in every state, in the order of their elimination.

    pattern: that of the KKT matrix. constant: its entries (multiplier, coordinate) that are numbers other than zero.
    Constraints are the edges of a graph whose nodes are coordinates and the ground. An edge that closes a loop stays;
    the others are a forest, in which each node is paired with the edge to its parent, the leaves first.
    """
    factors: dict[int, set[int]] = {}
    for i, j in constant:
        factors.setdefault(i, set()).add(j)
    numbers = {(i, j) for i, of in factors.items() for j in of}
    every: dict[int, set[int]] = {i: set() for i in factors}
    for i, j in pattern.entries:
        if i in every and j < coordinates:
            every[i].add(j)
    edges = {i: of for i, of in factors.items() if len(of) <= 2}
    while True:  # a coordinate is a node if all edges at it have constant factors of it
        nodes = set().union(*edges.values()) if edges else set()
        varying = {i for i in edges if any(j in nodes and (i, j) not in numbers for j in every[i])}
        if not varying:
            break
        edges = {i: of for i, of in edges.items() if i not in varying}
    neighbours: dict[int, list[tuple[int, int]]] = {}
    for i, of in edges.items():
        a, b = (*sorted(of), GROUND)[:2]
        for one, other in ((a, b), (b, a)):
            neighbours.setdefault(one, []).append((other, i))
    order: list[Pair] = []
    seen: set[int] = set()
    for root in (GROUND, *sorted(neighbours)):
        if root in seen or root not in neighbours:
            continue
        seen.add(root)
        reached = [root]
        for node in reached:
            for other, edge in neighbours[node]:
                if other not in seen:
                    seen.add(other)
                    reached.append(other)
                    order.append(Pair(other, edge))
    return tuple(reversed(order))


def left_by_pairs(pattern: Pattern, pairs: Sequence[Pair]) -> tuple[Pattern, int]:
    """The pattern that pairs leave, with the rows of the whole matrix, and the operations that they take."""
    graph, products = graph_of(pattern), 0
    diagonal = {i for i, j in pattern.entries if i == j}
    for pair in pairs:
        by_row, by_constraint = graph.pop(pair.coordinate), graph.pop(pair.multiplier)
        by_row -= {pair.multiplier}
        by_constraint -= {pair.coordinate}
        for i in by_row | by_constraint:
            graph[i] -= {pair.coordinate, pair.multiplier}
        for i, j in combinations_with_replacement(sorted(by_row | by_constraint), 2):
            count = (i in by_constraint) * (j in by_row) + (i in by_row) * (j in by_constraint)
            count += (i in by_constraint) * (j in by_constraint)
            if count == 0:
                continue
            products += 2 * count
            if i == j:
                diagonal.add(i)
            else:
                graph[i].add(j)
                graph[j].add(i)
    entries = {(i, j) for i, of in graph.items() for j in of if i > j} | {(i, i) for i in diagonal if i in graph}
    return pattern_of(pattern.rows, pattern.cols, entries, symmetric=True), products


@dataclass
class PairedElimination:
    """The symbolic elimination of pairs from a KKT matrix: `entries` of its lower triangle, which it changes.

    together: for the coordinate of a pair, the other ones of its body.
    """

    entries: Entries
    pairs: Sequence[Pair]
    together: Mapping[int, Sequence[int]] = field(default_factory=dict)
    _shifts: list[AddedRow] = field(default_factory=list)
    _steps: list[tuple[Pair, ca.SX, ca.SX, dict[int, ca.SX], dict[int, ca.SX]]] = field(default_factory=list)

    def __post_init__(self) -> None:
        columns = columns_of(self.entries)
        for pair in self.pairs:
            self._shift(pair, columns)
        for pair in self.pairs:
            self._eliminate(pair, columns)
        self.entries.clear()
        self.entries.update(lower_triangle(columns))

    def _shift(self, pair: Pair, columns: Columns) -> None:
        """Change the coordinate of a pair to what the constraint has of its body."""
        c, of = pair.coordinate, pair.multiplier
        constraint = columns[of]
        for j in self.together.get(c, ()):
            if j in constraint:
                shift = AddedRow(c, j, -constraint[j] / constraint[c])
                shift.change(columns)
                constraint.pop(j)
                columns[j].pop(of)
                self._shifts.append(shift)

    def _eliminate(self, pair: Pair, columns: Columns) -> None:
        c, of = pair.coordinate, pair.multiplier
        row, constraint = columns.pop(c), columns.pop(of)
        g, m = constraint.pop(c), row.pop(c, ca.SX(0))
        row.pop(of)
        for i in {**row, **constraint}:
            columns[i].pop(c, None)
            columns[i].pop(of, None)
        factors = {i: value / g for i, value in constraint.items()}
        coupled = {i: row[i] - m * factors[i] if i in row else -m * factors[i] for i in factors}
        coupled = {**row, **coupled}
        for i, j in combinations_with_replacement(sorted({**row, **constraint}), 2):
            parts = [
                x[k] * y[n] for x, y, k, n in ((factors, coupled, i, j), (row, factors, i, j)) if k in x and n in y
            ]
            if parts:
                old = columns[i].get(j)
                total = sum((-part for part in parts), start=ca.SX(0) if old is None else old)
                columns[i][j] = columns[j][i] = total
        self._steps.append((pair, g, m, row, constraint))

    def forward(self, right: Sequence[ca.SX]) -> list[ca.SX]:
        """The right-hand side of the rows that are left."""
        b = list(right)
        for shift in self._shifts:
            shift.change_right(b)
        for pair, g, m, row, constraint in self._steps:
            acceleration = b[pair.multiplier] / g
            multiplier = (b[pair.coordinate] - m * acceleration) / g
            for i, value in row.items():
                b[i] = b[i] - value * acceleration
            for i, value in constraint.items():
                b[i] = b[i] - value * multiplier
        return b

    def backward(self, eliminated: Sequence[ca.SX], solution: Mapping[int, ca.SX]) -> list[ca.SX]:
        """All unknowns from those of the rows that are left; eliminated: the result of `forward`."""
        x = list(eliminated)
        for i, value in solution.items():
            x[i] = value
        for pair, g, m, row, constraint in reversed(self._steps):
            c, of = pair.coordinate, pair.multiplier
            x[c] = (eliminated[of] - sum((a * x[i] for i, a in constraint.items()), start=ca.SX(0))) / g
            others = sum((a * x[i] for i, a in row.items()), start=m * x[c])
            x[of] = (eliminated[c] - others) / g
        for shift in reversed(self._shifts):
            shift.recover(x)
        return x
