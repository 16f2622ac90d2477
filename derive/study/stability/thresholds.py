"""The thresholds of a parameter at which the number of growing modes changes, by bracketing, and stable intervals."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

BRACKET = 2e-7
"""A threshold is bracketed to this part of its value."""

MOST = 200
"""The largest number of values that are evaluated between two given ones, if counts keep changing."""

Count = Callable[[float], int | None]
"""The number of growing modes at a value of the parameter; None where there is no steady motion."""


@dataclass(frozen=True)
class Threshold:
    """A threshold, between `low` and `high`, where the number of growing modes changes from `before` to `after`."""

    low: float
    high: float
    before: int
    after: int

    @property
    def value(self) -> float:
        """The middle of the bracket."""
        return (self.low + self.high) / 2


@dataclass(frozen=True)
class Interval:
    """Values from `low` to `high` of the parameter, where a model is stable or not; None: it has no steady motion."""

    low: float
    high: float
    stable: bool | None


def thresholds(count: Count, values: Sequence[float], counts: Sequence[int | None]) -> tuple[Threshold, ...]:
    """All thresholds between rising values, given their numbers of growing modes."""
    ends = list(zip(values, counts, strict=True))
    return tuple(
        threshold
        for (low, before), (high, after) in pairwise(ends)
        if before is not None and after is not None
        for threshold in _between(_limited(count), low, before, high, after)
    )


def _limited(count: Count) -> Count:
    """The function `count`, limited to MOST calls; further calls return None."""
    left = iter(range(MOST))

    def limited(value: float) -> int | None:
        return None if next(left, None) is None else count(value)

    return limited


def _between(count: Count, low: float, before: int, high: float, after: int) -> Iterator[Threshold]:
    """The thresholds between two values; those within one bracket count as one."""
    if before == after:
        return
    middle = (low + high) / 2
    between = count(middle) if high - low > BRACKET * max(abs(low), abs(high)) else None
    if between is None:
        yield Threshold(low, high, before, after)
        return
    yield from _between(count, low, before, middle, between)
    yield from _between(count, middle, between, high, after)


def intervals(
    values: Sequence[float], counts: Sequence[int | None], changes: Sequence[Threshold]
) -> tuple[Interval, ...]:
    """The intervals in which a model is stable or not, from the first value to the last; adjacent ones differ."""
    pieces: list[Interval] = []
    ends = list(zip(values, counts, strict=True))
    for (low, before), (high, after) in pairwise(ends):
        at, stable = low, None if before is None or after is None else before == 0
        for change in (c for c in changes if low <= c.low and c.high <= high):
            pieces.append(Interval(at, change.value, stable))
            at, stable = change.value, change.after == 0
        pieces.append(Interval(at, high, stable))
    return _joined(pieces)


def _joined(pieces: Sequence[Interval]) -> tuple[Interval, ...]:
    """The intervals with adjacent ones that agree joined into one."""
    result: list[Interval] = []
    for piece in pieces:
        if result and result[-1].stable == piece.stable:
            result[-1] = Interval(result[-1].low, piece.high, piece.stable)
        elif piece.high > piece.low:
            result.append(piece)
    return tuple(result)


def loss(of: Sequence[Interval]) -> float | None:
    """The least value at which stability is lost; None if it is not lost, or if there is none at first."""
    return next((b.low for a, b in pairwise(of) if a.stable and b.stable is False), None)


def wrong_intervals(of: Sequence[Interval], truth: Sequence[Interval], least: float = 0.0) -> tuple[Interval, ...]:
    """The intervals where a model is stable and the truth is not, or vice versa; stable: the verdict of the model.

    Intervals that are not wider than `least`, the error of the truth, are left out.
    """
    overlaps = (
        Interval(max(a.low, b.low), min(a.high, b.high), a.stable)
        for a in of
        for b in truth
        if a.stable is not None and b.stable is not None and a.stable != b.stable
    )
    return tuple(o for o in overlaps if o.high - o.low > max(least, BRACKET * max(abs(o.low), abs(o.high))))
