"""A sparse LDL^T factorisation, written out for a fixed pattern: the order is chosen at generation time."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from derive.kernel.pattern import Pattern

Entries = dict[tuple[int, int], ca.SX]


@dataclass(frozen=True)
class Factorisation:
    """A = P^T L D L^T P: `order` lists the pivots; `lower` holds L (row, column as in A); `fill` counts new entries."""

    order: tuple[int, ...]
    pivots: tuple[ca.SX, ...]
    inverses: tuple[ca.SX, ...]
    lower: Entries
    fill: int


def elimination_order(pattern: Pattern) -> tuple[int, ...]:
    """The approximate minimum degree order of a symmetric pattern (CasADi's AMD)."""
    rows = [i for i, j in pattern.entries] + [j for i, j in pattern.entries]
    cols = [j for i, j in pattern.entries] + [i for i, j in pattern.entries]
    return tuple(ca.Sparsity.triplet(pattern.rows, pattern.cols, rows, cols).amd())


def factorise(pattern: Pattern, values: Entries) -> Factorisation:
    """Eliminate in the order of `elimination_order`; `values` are the entries of the lower triangle."""
    order = elimination_order(pattern)
    place = {row: k for k, row in enumerate(order)}
    work = {_ordered(i, j, place): value for (i, j), value in values.items()}
    pivots: list[ca.SX] = []
    inverses: list[ca.SX] = []
    lower: Entries = {}
    for k, j in enumerate(order):
        pivots.append(work[j, j])
        inverses.append(1 / work[j, j])  # one division a pivot, or none where setup can do it
        below = [i for i in order[k + 1 :] if (i, j) in work]
        for i in below:
            lower[i, j] = work[i, j] * inverses[k]
        for a, i in enumerate(below):
            for other in below[: a + 1]:
                update = lower[i, j] * work[other, j]
                old = work.get((i, other))
                work[i, other] = -update if old is None else old - update
    return Factorisation(order, tuple(pivots), tuple(inverses), lower, len(work) - len(values))


def _ordered(i: int, j: int, place: dict[int, int]) -> tuple[int, int]:
    """The entry below the diagonal of the permuted matrix."""
    return (i, j) if place[i] >= place[j] else (j, i)


def solve(factors: Factorisation, right: list[ca.SX]) -> list[ca.SX]:
    """x of L D L^T x = right, in the numbering of A."""
    x = list(right)
    for j in factors.order:
        for (i, column), entry in factors.lower.items():
            if column == j:
                x[i] = x[i] - entry * x[j]
    for inverse, j in zip(factors.inverses, factors.order, strict=True):
        x[j] = x[j] * inverse
    for j in reversed(factors.order):
        for (i, column), entry in factors.lower.items():
            if column == j:
                x[j] = x[j] - entry * x[i]
    return x
