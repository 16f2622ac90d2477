"""Sparse LDL^T factorisation, unrolled for a fixed pattern and a fixed elimination order."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from derive.ir.patterns import Pattern
from derive.lowering.elimination_orders import elimination_order, fill_in
from derive.lowering.flat.graph import LoweringError

Entries = dict[tuple[int, int], ca.SX]

VANISHING = Fraction(1, 2**44)
"""A pivot counts as zero below this fraction of its diagonal entry, because rounding errors are of that size."""


@dataclass(frozen=True)
class Factorisation:
    """The factors of A = P^T L D L^T P.

    order: the elimination order, as row indices of A. pivots, inverses: D and its inverse, in that order. scales: the
    sizes with which the pivots are compared, the diagonal entries of A or, for a multiplier, whose entry is zero, the
    contribution of its coordinates. lower: the columns of L as pairs (row, entry), with the indices of A. fill: the
    number of entries of L without an entry of A. coordinates: the number of rows of A before those of multipliers.
    idle: the multipliers without coordinates, whose pivots are the proximal term alone.
    """

    order: tuple[int, ...]
    pivots: tuple[ca.SX, ...]
    scales: tuple[ca.SX, ...]
    inverses: tuple[ca.SX, ...]
    lower: dict[int, tuple[tuple[int, ca.SX], ...]]
    fill: int
    coordinates: int
    idle: frozenset[int] = frozenset()


def factorise(
    pattern: Pattern,
    values: Entries,
    order: tuple[int, ...] | None = None,
    coordinates: int | None = None,
    proximal: ca.SX | None = None,
    least: ca.SX | None = None,
) -> Factorisation:
    """The factorisation of a symmetric matrix.

    pattern, values: the lower triangle. order: the elimination order, by default one of minimum degree.
    coordinates: the number of rows before those of multipliers; by default there are no multipliers. proximal: the
    part of the scale of a multiplier that is added to its pivot; the scale of one without coordinates is -1. least:
    if there is such a part, the least scale of a multiplier, relative to that with an entry of 1 for each of its
    coordinates. Raises LoweringError if a multiplier has no coordinates and there is no such part.
    """
    order = elimination_order(pattern) if order is None else order
    coordinates = pattern.rows if coordinates is None else coordinates
    position = {row: k for k, row in enumerate(order)}
    work = {_ordered(i, j, position): value for (i, j), value in values.items()}
    of_coordinates: Entries = {}
    of_multipliers: dict[int, list[ca.SX]] = {}
    compliances: dict[int, ca.SX] = {}
    pivots: list[ca.SX] = []
    scales: list[ca.SX] = []
    inverses: list[ca.SX] = []
    lower: dict[int, tuple[tuple[int, ca.SX], ...]] = {}
    neighbours: dict[int, set[int]] = {row: set() for row in order}
    for i, j in work:
        if i != j:
            neighbours[j].add(i)
    for j in order:
        if j >= coordinates:
            idle_scale = {} if proximal is None else {(j, j): ca.SX(-1)}
            scale = (idle_scale | of_coordinates).get((j, j))
            if scale is None:
                raise LoweringError("there is nothing to divide by: a constraint has no coordinates")
            own = scale if (j, j) in of_coordinates else ca.SX(0)
            scales.append(ca.fmin(scale, -least * compliances[j]) if least is not None and j in compliances else scale)
            own = own if proximal is None else own + proximal * scales[-1]
            # What is known last is subtracted last: each pivot waits for the one before, and nothing else follows.
            work[j, j] = sum((-update for update in of_multipliers.get(j, ())), start=own)
        else:
            scales.append(values[j, j])
        pivots.append(work[j, j])
        inverses.append(1 / work[j, j])  # a single division for each pivot, or none if setup can compute the inverse
        below = sorted(neighbours[j], key=position.__getitem__)
        factors = {i: work[i, j] * inverses[-1] for i in below}
        lower[j] = tuple(factors.items())
        for a, i in enumerate(below):
            for other in below[: a + 1]:
                update = factors[i] * work[other, j]
                if i == other >= coordinates and j >= coordinates:
                    of_multipliers.setdefault(i, []).append(update)
                    continue
                if i == other >= coordinates > j and least is not None:
                    compliances[i] = compliances.get(i, ca.SX(0)) + inverses[-1]
                store = of_coordinates if i == other >= coordinates > j else work
                old = store.get((i, other))
                store[i, other] = -update if old is None else old - update
                if i != other:
                    neighbours[other].add(i)
    fill = fill_in(pattern, order)
    idle = frozenset(j for j in order if j >= coordinates and (j, j) not in of_coordinates)
    return Factorisation(order, tuple(pivots), tuple(scales), tuple(inverses), lower, fill, coordinates, idle)


def _ordered(i: int, j: int, position: dict[int, int]) -> tuple[int, int]:
    """The indices of a symmetric entry in the lower triangle of the permuted matrix."""
    return (i, j) if position[i] >= position[j] else (j, i)


def solve(factors: Factorisation, right: list[ca.SX]) -> list[ca.SX]:
    """The solution x (n,) of A x = right, with `right` (n,)."""
    return backward(factors, forward(factors, right))


def forward(factors: Factorisation, right: list[ca.SX]) -> list[ca.SX]:
    """L^-1 right (n,), the right-hand side after the forward substitution."""
    x = list(right)
    for j in factors.order:
        for i, entry in factors.lower[j]:
            x[i] = x[i] - entry * x[j]
    return x


def backward(factors: Factorisation, eliminated: list[ca.SX]) -> list[ca.SX]:
    """The solution x (n,) from the right-hand side after the forward substitution.

    Unknowns are subtracted in the order in which they become known, so that each row waits for the last one alone.
    """
    x = list(eliminated)
    for inverse, j in zip(factors.inverses, factors.order, strict=True):
        x[j] = x[j] * inverse
    for j in reversed(factors.order):
        for i, entry in reversed(factors.lower[j]):
            x[j] = x[j] - entry * x[i]
    return x
