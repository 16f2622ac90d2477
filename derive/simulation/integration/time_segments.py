"""The time of an integration in segments: between breaks of functions of time, with equal intervals between rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from derive.runtime.native_call import Vector

CLOSE, BEFORE = 64, 16
"""Distances in units in the last place of a time: times that are closer than CLOSE count as equal; a segment that leads
to a break ends BEFORE units before it, so that all of its steps have the values of functions before the break."""


@dataclass(frozen=True)
class TimeSegment:
    """A segment of time: `count` intervals of equal length (s) from `start` (s) on, with rows at their ends.

    to_break: whether the last one ends at a break, where there is no row.
    """

    start: float
    interval: float
    count: int
    to_break: bool = False


def smooth_ends(times: Vector, breaks: Sequence[float]) -> list[float]:
    """The ends of smooth intervals with rows at `times` (n,), s: the breaks within, and the last row."""
    ends = [*sorted(time for time in {*breaks} if times[0] < time < times[-1]), float(times[-1])]
    return [end for end, following in pairwise(ends) if following - end > rounding(following)] + ends[-1:]


def time_segments(times: Vector, breaks: Sequence[float] = ()) -> list[TimeSegment]:
    """The segments of an integration with rows at `times` (n,), s; one that follows a break begins exactly there."""
    result: list[TimeSegment] = []
    start, rest = float(times[0]), times[1:]
    ends = smooth_ends(times, breaks) if len(rest) else []
    for end in ends:
        count = int(np.searchsorted(rest, end + rounding(end), side="right"))
        rows, rest = rest[:count], rest[count:]
        to_break = not count or end - float(rows[-1]) > rounding(end)
        nodes = np.array([start, *rows, *([end] if to_break else [])])
        for first, last in equal_intervals(nodes):
            at, stop, leads_to_break = float(nodes[first]), float(nodes[last]), False
            if last == len(nodes) - 1 and end != ends[-1]:
                stop, leads_to_break = end - rounding(end, BEFORE), to_break
            result.append(TimeSegment(at, (stop - at) / (last - first), last - first, leads_to_break))
        start = end
    return result


def rounding(time: float, units: int = CLOSE) -> float:
    """The size (s) of a number of units in the last place of a time (s)."""
    return units * float(np.spacing(abs(time)))


def equal_intervals(times: Vector) -> list[tuple[int, int]]:
    """The first and the last index of each longest part of `times` (n,) whose intervals are equal."""
    intervals = np.diff(times)
    changes = [i + 1 for i in range(len(intervals) - 1) if abs(intervals[i + 1] / intervals[i] - 1) > 1e-6]
    return list(pairwise([0, *changes, len(intervals)])) if len(intervals) else []
