"""Orders in which a symmetric matrix is eliminated, fixed at generation time: those of M and of the KKT matrix.

The KKT matrix is [M, -G^T; -G, 0]; its first `coordinates` rows are those of M, the others those of multipliers.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from enum import Enum

import casadi as ca

from derive.ir.patterns import Pattern
from derive.ir.patterns import pattern as pattern_of

Graph = dict[int, set[int]]
"""The neighbours of each row: the columns in which it has entries besides the diagonal."""

TRIES = 200
"""The number of matchings from which `matched_order` takes the best."""


class EliminationRule(Enum):
    """The rule for the elimination order of the KKT matrix.

    SAFE: each multiplier after all of its coordinates; no pivot vanishes in a state with independent constraints.
    MATCHED: each multiplier after one of its coordinates, for less fill-in; a pivot vanishes in the states in which the
    entry of G that pairs the two does. The pivots are checked in either case.
    """

    SAFE = "safe"
    MATCHED = "matched"

    def order(self, pattern: Pattern, coordinates: int) -> tuple[int, ...]:
        """The elimination order of a KKT matrix."""
        return ORDERS[self](pattern, coordinates)


def elimination_order(pattern: Pattern) -> tuple[int, ...]:
    """The minimum degree order of a symmetric pattern: of AMD or, where that takes less work, of exact degrees."""
    return min((amd_order(pattern), least_degree_order(pattern)), key=lambda order: work(pattern, order))


def amd_order(pattern: Pattern) -> tuple[int, ...]:
    """The approximate minimum degree order of a symmetric pattern (CasADi's AMD)."""
    rows = [i for i, j in pattern.entries] + [j for i, j in pattern.entries]
    cols = [j for i, j in pattern.entries] + [i for i, j in pattern.entries]
    diagonal = list(range(pattern.rows))
    return tuple(ca.Sparsity.triplet(pattern.rows, pattern.cols, rows + diagonal, cols + diagonal).amd())


def least_degree_order(pattern: Pattern, coordinates: int | None = None) -> tuple[int, ...]:
    """The minimum degree order with exact degrees; of equal ones, rows that wait for the fewest others come first.

    coordinates: the number of rows before those of multipliers, which wait for their coordinates; by default there are
    no multipliers.

    AMD eliminates rows of one neighbourhood together, such as the three rotations of a body: where the last of its
    modes have as many neighbours, rotations come before them, which adds fill-in and pivots that wait for each other.
    """
    graph, order = graph_of(pattern), list[int]()
    waits = dict.fromkeys(graph, 0)
    missing = {} if coordinates is None else _coordinates_of(pattern, coordinates)
    while graph:
        ready = (n for n in graph if missing.get(n, set()).isdisjoint(graph))
        node = min(ready, key=lambda n: (len(graph[n]), waits[n], n))
        for other in eliminated(graph, node):
            waits[other] = max(waits[other], waits[node] + 1)
        order.append(node)
    return tuple(order)


def rounds_of_least_degree(pattern: Pattern) -> tuple[int, ...]:
    """A minimum degree order in rounds, each of rows of the least degree that are not neighbours of each other.

    Rows of a round need nothing of each other, so that processors compute them at once; along a path or a ring the
    longest chain of rows that wait for each other grows with the logarithm of their number.
    """
    graph, order = graph_of(pattern), list[int]()
    while graph:
        least = min(map(len, graph.values()))
        chosen: dict[int, None] = {}
        for node in sorted(graph):
            if len(graph[node]) == least and graph[node].isdisjoint(chosen):
                chosen[node] = None
        for node in chosen:
            eliminated(graph, node)
        order += chosen
    return tuple(order)


def safe_order(pattern: Pattern, coordinates: int) -> tuple[int, ...]:
    """The elimination order of the KKT matrix [M, -G^T; -G, 0], whose first `coordinates` rows are those of M.

    It is a minimum degree order, except that each multiplier is eliminated after its coordinates: one in which it moves
    behind them, or one in which it does not take part before. Then no pivot
    vanishes in any state in which M is positive definite and the rows of G are independent, whatever entries of G
    vanish there: the eliminated block contains every eliminated multiplier with its complete row of G and is
    therefore regular. Pivots of coordinates are positive, those of multipliers negative.
    """
    orders = [_multipliers_last(pattern, coordinates, order(pattern)) for order in (amd_order, least_degree_order)]
    orders.append(least_degree_order(pattern, coordinates))
    return min(orders, key=lambda order: work(pattern, order))


def _multipliers_last(pattern: Pattern, coordinates: int, nodes: Sequence[int]) -> tuple[int, ...]:
    """An order of the rows of a KKT matrix with each multiplier moved behind the last of its coordinates."""
    missing = _coordinates_of(pattern, coordinates)
    order: list[int] = []
    waiting: list[int] = []
    for node in nodes:
        if node >= coordinates:
            waiting.append(node)
        else:
            order.append(node)
            for coordinates_of in missing.values():
                coordinates_of.discard(node)
        ready = [k for k in waiting if not missing[k]]
        order += ready
        waiting = [k for k in waiting if missing[k]]
    return tuple(order)


def _coordinates_of(pattern: Pattern, coordinates: int) -> dict[int, set[int]]:
    """The coordinates of each multiplier."""
    result: dict[int, set[int]] = {k: set() for k in range(coordinates, pattern.rows)}
    for i, j in pattern.entries:
        if i >= coordinates > j:
            result[i].add(j)
    return result


def coordinates_first(pattern: Pattern, coordinates: int) -> tuple[int, ...]:
    """The elimination order of a KKT matrix in which all multipliers come after all coordinates, each by AMD.

    The coordinates leave -G M^-1 G^T, so that a term on its diagonal acts on all multipliers alike.
    """
    entries = {(i, j) for i, j in pattern.entries if i < coordinates}
    first = elimination_order(pattern_of(coordinates, coordinates, entries, symmetric=True))
    graph = graph_of(pattern)
    for node in first:
        eliminated(graph, node)
    count = pattern.rows - coordinates
    left = {(i - coordinates, j - coordinates) for i, others in graph.items() for j in others if i > j}
    order = elimination_order(pattern_of(count, count, left, symmetric=True))
    return (*first, *(coordinates + node for node in order))


def matched_order(pattern: Pattern, coordinates: int) -> tuple[int, ...]:
    """An order with little work in which each multiplier comes after the one coordinate that it is matched to.

    Of many random matchings, each eliminated by least fill-in, the one with the fewest operations is taken; the numbers
    are the same in every run. With one multiplier behind its coordinate the pivot is -g^2/m.
    """
    touched: dict[int, list[int]] = {k: [] for k in range(coordinates, pattern.rows)}
    for i, j in pattern.entries:
        if i >= coordinates > j:
            touched[i].append(j)
    rng = random.Random(0)
    best = safe_order(pattern, coordinates)
    for _ in range(TRIES if pattern.rows < 60 else TRIES // 20):
        order = _least_fill(pattern, _matching(touched, rng), rng)
        if work(pattern, order) < work(pattern, best):
            best = order
    return best


ORDERS: dict[EliminationRule, Callable[[Pattern, int], tuple[int, ...]]] = {
    EliminationRule.SAFE: safe_order,
    EliminationRule.MATCHED: matched_order,
}


def graph_of(pattern: Pattern) -> Graph:
    """The graph of a symmetric pattern."""
    graph: Graph = {node: set() for node in range(pattern.rows)}
    for i, j in pattern.entries:
        if i != j:
            graph[i].add(j)
            graph[j].add(i)
    return graph


def eliminated(graph: Graph, node: int) -> set[int]:
    """Remove a node and connect its neighbours, which are returned."""
    neighbours = graph.pop(node)
    for other in neighbours:
        graph[other] |= neighbours
        graph[other] -= {node, other}
    return neighbours


def fill_in(pattern: Pattern, order: tuple[int, ...]) -> int:
    """The number of entries of L below the diagonal that are not entries of the matrix."""
    graph = graph_of(pattern)
    present = sum(map(len, graph.values())) // 2
    return sum(len(eliminated(graph, node)) for node in order) - present


def work(pattern: Pattern, order: tuple[int, ...]) -> int:
    """Divisions, products and sums of LDL^T: 1 + c + c (c + 1) for a column with c entries below its pivot."""
    graph = graph_of(pattern)
    below = (len(eliminated(graph, node)) for node in order)
    return sum(1 + c + c * (c + 1) for c in below)


def _matching(touched: Mapping[int, list[int]], rng: random.Random) -> dict[int, int]:
    """A coordinate for each multiplier, by augmenting paths in random order; none where there is no such matching."""
    multiplier_of: dict[int, int] = {}

    def augment(multiplier: int, seen: set[int]) -> bool:
        for coordinate in rng.sample(touched[multiplier], len(touched[multiplier])):
            if coordinate not in seen:
                seen.add(coordinate)
                if coordinate not in multiplier_of or augment(multiplier_of[coordinate], seen):
                    multiplier_of[coordinate] = multiplier
                    return True
        return False

    for multiplier in rng.sample(list(touched), len(touched)):
        augment(multiplier, set())
    return {multiplier: coordinate for coordinate, multiplier in multiplier_of.items()}


def _least_fill(pattern: Pattern, after: Mapping[int, int], rng: random.Random) -> tuple[int, ...]:
    """Greedy elimination by least fill-in, in which a node comes after the one that it is mapped to."""
    graph, order = graph_of(pattern), []
    while graph:
        ready = (node for node in sorted(graph) if after.get(node) not in graph)
        node = min(ready, key=lambda n: (_new_entries(graph, n), len(graph[n]), rng.random()))
        eliminated(graph, node)
        order.append(node)
    return tuple(order)


def _new_entries(graph: Graph, node: int) -> int:
    """The number of entries that eliminating a node creates."""
    neighbours = graph[node]
    return sum(len(neighbours - graph[n]) - 1 for n in neighbours) // 2
