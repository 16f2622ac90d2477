"""Columns of a pattern that repeat, with rows at constant distances: a few numbers for matrices of any size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from derive.ir.patterns import Pattern

MOST_COLUMNS = 48
"""The largest number of columns that are looked for again."""

Columns = Sequence[Sequence[int]]


@dataclass(frozen=True)
class RepeatedColumns:
    """Columns that a pattern has `repeats` times: the rows of each, and their distances to those of the next time."""

    repeats: int
    columns: tuple[tuple[tuple[int, int], ...], ...]

    @property
    def numbers(self) -> tuple[int, ...]:
        """The repeats, the number of columns, and for each that of its rows, and these with their distances, if any."""
        result = [self.repeats, len(self.columns)]
        for column in self.columns:
            result.append(len(column))
            for row, distance in column:
                result += [row, distance] if self.repeats > 1 else [row]
        return tuple(result)


def repeated_columns(pattern: Pattern) -> tuple[RepeatedColumns, ...]:
    """The columns of a pattern as runs of columns that repeat at a distance; a greedy search makes the runs long."""
    columns = [pattern.rowidx[a:b] for a, b in zip(pattern.colptr, pattern.colptr[1:], strict=False)]
    result: list[RepeatedColumns] = []
    first = 0
    while first < len(columns):
        period, repeats = _longest(columns, first)
        own = columns[first : first + period]
        after = columns[first + period : first + 2 * period] if repeats > 1 else own
        pairs = tuple(
            tuple((row, other - row) for row, other in zip(rows, others, strict=True))
            for rows, others in zip(own, after, strict=True)
        )
        if repeats == 1 and result and result[-1].repeats == 1:
            result[-1] = RepeatedColumns(1, result[-1].columns + pairs)
        else:
            result.append(RepeatedColumns(repeats, pairs))
        first += period * repeats
    return tuple(result)


def _longest(columns: Columns, first: int) -> tuple[int, int]:
    """The number of columns from `first` on that repeat most often, and how often they are there."""
    best, left = (1, 1), len(columns) - first
    for period in range(1, min(MOST_COLUMNS, left // 2) + 1):
        repeats = _repeats(columns, first, period)
        if repeats > max(best[1], 1 if period == 1 else 2):  # longer columns that are there twice hide others
            best = period, repeats
        if 2 * best[0] * best[1] > left:
            break
    return best


def _repeats(columns: Columns, first: int, period: int) -> int:
    """How often the columns from `first` on follow each other with rows at constant distances."""
    distances: dict[int, list[int]] = {}
    repeats = 1
    while first + (repeats + 1) * period <= len(columns):
        for j in range(first + repeats * period, first + (repeats + 1) * period):
            rows, before = columns[j], columns[j - period]
            if len(rows) != len(before):
                return repeats
            moved = [row - old for row, old in zip(rows, before, strict=True)]
            if distances.setdefault((j - first) % period, moved) != moved:
                return repeats
        repeats += 1
    return repeats
