"""The solutions of homogeneous linear equations with rational coefficients, exactly."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction


def nullspace(rows: Sequence[Sequence[Fraction]], columns: int) -> list[list[Fraction]]:
    """A basis of the vectors (columns,) that all rows (n, columns) map to zero.

    Each vector is 1 at one of the columns without a pivot, and 0 at the others: the basis is unique.
    """
    reduced = [list(row) for row in rows]
    pivots: list[int] = []
    for column in range(columns):
        at = len(pivots)
        found = next((i for i in range(at, len(reduced)) if reduced[i][column]), None)
        if found is None:
            continue
        reduced[at], reduced[found] = reduced[found], reduced[at]
        pivot = reduced[at] = [x / reduced[at][column] for x in reduced[at]]
        for i, row in enumerate(reduced):
            if i != at and row[column]:
                reduced[i] = [x - row[column] * p for x, p in zip(row, pivot, strict=True)]
        pivots.append(column)
    return [_solution(reduced, pivots, free, columns) for free in range(columns) if free not in pivots]


def _solution(reduced: list[list[Fraction]], pivots: list[int], free: int, columns: int) -> list[Fraction]:
    """The solution that is 1 at a free column."""
    vector = [Fraction(int(column == free)) for column in range(columns)]
    for row, pivot in zip(reduced, pivots, strict=False):  # rows behind those of the pivots are zero
        vector[pivot] = -row[free]
    return vector
