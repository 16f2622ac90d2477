"""The elimination orders that `study pivots` compares; that of the generated code is one of them.

Each is determined once and used in all states, without exchanges of rows.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import min_weight_full_bipartite_matching

from derive.ir.patterns import Pattern
from derive.lowering.elimination_orders import elimination_order, safe_order
from derive.runtime.native_call import Matrix
from derive.study.elimination import entry_mask

THRESHOLD = 0.1
"""The threshold of `markowitz` for a pivot, relative to the largest entry of its column: the usual value of MA28."""


@dataclass(frozen=True)
class Order:
    """Rows and columns of the pivots, in the order of elimination."""

    rows: tuple[int, ...]
    cols: tuple[int, ...]


def constrained(shape: Pattern, coordinates: int, _: Matrix) -> Order:
    """Minimum degree with multipliers after all of their coordinates: the order of the generated code."""
    order = safe_order(shape, coordinates)
    return Order(order, order)


def matched(shape: Pattern, coordinates: int, first: Matrix) -> Order:
    """Each multiplier directly after one of its coordinates, the pairs in the order of AMD.

    After its coordinate, of inertia m, the pivot of a multiplier is -g^2/m; the matching maximises the product of these
    pivots in the first state. Solvers of indefinite systems preprocess matrices in this way (Duff and Pralet, 2005,
    SIAM J. Matrix Anal. Appl. 27, 313-340), but allow exchanges of pivots afterwards.
    """
    pairs = matching(coordinates, first)
    groups = [(coordinate, multiplier) for multiplier, coordinate in pairs.items()]
    taken = {node for group in groups for node in group}
    groups += [(node,) for node in range(shape.rows) if node not in taken]  # type: ignore[misc]
    group_of = {node: number for number, group in enumerate(groups) for node in group}
    rows, cols = [group_of[i] for i, _ in shape.entries], [group_of[j] for _, j in shape.entries]
    every = range(len(groups))
    compressed = ca.Sparsity.triplet(len(groups), len(groups), [*rows, *cols, *every], [*cols, *rows, *every])
    order = tuple(node for number in compressed.amd() for node in groups[number])
    return Order(order, order)


def markowitz(shape: Pattern, _: int, first: Matrix) -> Order:
    """The pivots that a general sparse solver of 1988 selects in the first matrix and then uses in all states.

    Each has the least (r - 1)(c - 1), for r and c entries in its row and column (Markowitz), among entries of at least
    `THRESHOLD` times the largest in their column (Duff, 1977, AERE R 8730: MA28).
    """
    work, n = first.copy(), shape.rows
    there = entry_mask(shape)
    left_rows, left_cols = np.ones(n, dtype=bool), np.ones(n, dtype=bool)
    rows, cols = [], []
    for _ in range(n):
        there &= left_rows[:, None] & left_cols
        work[~there] = 0.0
        size = np.abs(work)
        relative = size / np.maximum(size.max(axis=0), np.finfo(float).tiny)
        cost = np.outer(there.sum(axis=1) - 1, there.sum(axis=0) - 1) + (1 - relative) / 2
        i, j = np.unravel_index(np.argmin(np.where(relative >= THRESHOLD, cost, np.inf)), (n, n))
        rows.append(int(i))
        cols.append(int(j))
        left_rows[i] = left_cols[j] = False
        if work[i, j] != 0.0:
            work -= np.outer(np.where(left_rows, work[:, j], 0.0) / work[i, j], work[i])
            there |= np.outer(there[:, j], there[i])
    return Order(tuple(rows), tuple(cols))


def unconstrained(shape: Pattern, _: int, __: Matrix) -> Order:
    """Minimum degree as for a positive definite matrix: multipliers are treated as any other unknown."""
    order = elimination_order(shape)
    return Order(order, order)


ORDERS: dict[str, Callable[[Pattern, int, Matrix], Order]] = {
    "constrained": constrained,
    "matched": matched,
    "markowitz": markowitz,
    "unconstrained": unconstrained,
}
"""The orders by name: functions of the pattern, the number of coordinates, and the matrix in the first state."""


def matching(coordinates: int, first: Matrix) -> dict[int, int]:
    """A coordinate for each multiplier, so that the product of g^2/m over all pairs is largest."""
    G, inertia = first[coordinates:, :coordinates], np.diag(first)[:coordinates]
    if not len(G):
        return {}
    size = np.log(np.maximum(G**2 / inertia, np.finfo(float).tiny))
    size[G == 0.0] = 2 * size.min() - 1.0  # such pairs are the last resort
    weights = csr_array(1.0 + size.max() - size)
    multipliers, matched = min_weight_full_bipartite_matching(weights)
    return {coordinates + int(i): int(j) for i, j in zip(multipliers, matched, strict=True)}


def without_diagonal(shape: Pattern, coordinates: int, order: Order) -> int:
    """The number of multipliers that come before all of their coordinates: their pivots are zero in every state."""
    if order.rows != order.cols:
        return 0
    place = {node: k for k, node in enumerate(order.rows)}
    filled = {i for i, j in shape.entries if i >= coordinates > j and place[j] < place[i]}
    return shape.rows - coordinates - len(filled)
