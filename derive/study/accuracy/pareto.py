"""The Pareto-optimal runs of a ladder: those that no other run beats in both error and time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from derive.study.accuracy.measurement import Line, Point


@dataclass(frozen=True)
class Candidate:
    """A run of a model: the line of the model, and the point of the run."""

    line: Line
    point: Point


def candidates(lines: Sequence[Line]) -> tuple[Candidate, ...]:
    """All runs of models that are valid."""
    return tuple(Candidate(line, point) for line in lines if line.valid for point in line.points)


def front(runs: Sequence[Candidate], cost: Callable[[Point], float]) -> tuple[Candidate, ...]:
    """The runs with a smaller error than all that are cheaper, from cheap to dear."""
    result: list[Candidate] = []
    for run in sorted(runs, key=lambda r: (cost(r.point), r.point.rms)):
        if not result or run.point.rms < result[-1].point.rms:
            result.append(run)
    return tuple(result)


def recommended(runs: Sequence[Candidate], error: float) -> Candidate | None:
    """The cheapest run whose root mean square error is at most `error`; None if there is none."""
    good = [run for run in runs if run.point.rms <= error]
    return min(good, key=lambda run: run.point.seconds[0], default=None)
