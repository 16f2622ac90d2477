"""The result of a ladder: its Pareto-optimal runs, and sentences on the recommended model and those next to it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from derive.percentages import percent
from derive.study.accuracy.chart_labels import duration
from derive.study.accuracy.doubts import doubt
from derive.study.accuracy.measurement import Line, Point

GAIN = 0.9
"""The part of an error below which another one is clearly smaller."""


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


@dataclass(frozen=True)
class Headline:
    """The runs of a ladder that answer a requested error.

    recommended: the cheapest run of a valid model with that error. best: the most accurate one if there is none.
    cheaper: the cheapest run with that error of a model that a monitor warns of, if it is cheaper than the recommended
    one. better: the cheapest run of another valid model with a clearly smaller error. undecided: the error of the
    reference, if it is larger than the requested one, so that no run is known to have that; None if it is not.
    """

    error: float
    recommended: Candidate | None
    best: Candidate | None
    cheaper: Candidate | None
    better: Candidate | None
    undecided: float | None = None


def headline(lines: Sequence[Line], error: float, of_reference: float | None = None) -> Headline:
    """The runs of the headline of a ladder; of_reference: the error of the reference itself, if it is known."""
    if of_reference is not None and of_reference > error:
        return Headline(error, None, None, None, None, undecided=of_reference)
    valid = candidates(lines)
    chosen = recommended(valid, error)
    warned = [Candidate(line, p) for line in lines if line.warning and not line.failure for p in line.points]
    cheaper = recommended(warned, error)
    if chosen is not None and cheaper is not None and _seconds(cheaper) >= _seconds(chosen):
        cheaper = None
    others = () if chosen is None else [run for run in valid if run.line is not chosen.line]
    smaller = [run for run in others if chosen is not None and run.point.rms < GAIN * chosen.point.rms]
    return Headline(
        error,
        chosen,
        min(valid, key=lambda run: run.point.rms, default=None) if chosen is None else None,
        cheaper,
        min(smaller, key=_seconds, default=None),
    )


def headline_texts(of: Headline, shown: Sequence[str]) -> list[tuple[str, str]]:
    """The sentences, each with its title; `shown` are the beams that the plot shows."""
    asked = percent(of.error)
    if of.undecided is not None:
        text = f"the error of the reference itself is {percent(of.undecided)}, so an error of {asked} cannot be judged"
        return [("Undecided", text)]
    if of.recommended is None:
        best = f"; the most accurate one is {_run(of.best)}" if of.best else ""
        result = [("Recommended", f"none: no valid model has an error of at most {asked}{best}")]
    else:
        result = [("Recommended", f"{_run(of.recommended)}; the cheapest valid model with an error of at most {asked}")]
    if of.cheaper is not None:
        text = f"{_run(of.cheaper)}; {doubt(replace(of.cheaper.line, points=(of.cheaper.point,)), shown)}"
        result.append(("Cheaper, if its warning does not matter", text))
    if of.better is not None:
        result.append(("Next better", _run(of.better)))
    elif of.recommended is not None:
        result.append(("Next better", "none: no other valid model has a clearly smaller error"))
    return result


def _seconds(run: Candidate) -> float:
    return run.point.seconds[0]


def _run(run: Candidate) -> str:
    """The text of a run: its model, its setting, its error and its time."""
    error = f"{percent(run.point.rms)} (largest {percent(run.point.worst)})"
    return f"{run.line.label}, {run.point.setting}: error {error}, {duration(_seconds(run))}"
