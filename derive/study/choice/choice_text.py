"""The result of a search, as text and as plain data: the models tried, their cost, and the cost of the next steps."""

from __future__ import annotations

from dataclasses import asdict, replace
from math import inf
from typing import Any

from derive.percentages import implied_percent, percent
from derive.study.accuracy.chart_labels import grouped, milliseconds
from derive.study.accuracy.doubts import doubt, doubt_reason
from derive.study.accuracy.headline import GAIN
from derive.study.accuracy.measurement import Line, Point
from derive.study.accuracy.modelled_bodies import flexible_nouns
from derive.study.accuracy.table import MODEL_DOC, cheapest
from derive.study.choice.reference_errors import Agreement
from derive.study.choice.reference_models import ReferenceModels
from derive.study.choice.search import Choice
from derive.study.choice.trials import accurate, implied_error
from derive.study.table import Row, StudyColumn, StudyTable, general

STEPS = 2
"""The largest number of cheaper, and of more accurate, models beside the chosen one."""


TRIED = (
    StudyColumn("model", head="tried", doc=MODEL_DOC),
    StudyColumn("tolerance", general(6)),
    StudyColumn("measured", percent, doc="error (rms) of the plot, relative to its peak"),
    StudyColumn("implied", implied_percent, doc="error that a monitor of the run estimates"),
    StudyColumn("ms", milliseconds, doc="CPU time"),
    StudyColumn("evaluations", grouped),
    StudyColumn("operations", grouped, doc="arithmetic operations of all evaluations"),
    StudyColumn("verdict", head=""),
)
"""The columns of a model that was tried, with one of its runs."""


def choice_text(choice: Choice) -> str:
    """The whole search as lines for a terminal."""
    known = choice.reference
    asked = f"an error of at most {percent(choice.error)} in {' and '.join(choice.plots)}"
    lines = [f"{choice.name}: search for the cheapest model with {asked}", "", "Screening"]
    lines += [f"  {one.text}" for one in choice.screening]
    lines += ["", f"Reference: {known.model.label}. Its error is at most {percent(known.error)}, by comparison with"]
    lines += [f"  {a.label}: {percent(a.difference)}{_of_pieces(a)}" for a in known.agreements]
    if choice.untried:
        lines += ["", "Not tried, or not checked", *(f"  {line}" for line in choice.untried)]
    lines += _shares(choice)
    return "\n".join([*lines, "", *tried_table(choice).text, "", *verdict_lines(choice)])


def _of_pieces(agreement: Agreement) -> str:
    """The error of a reference in a direction where it is not the difference."""
    if agreement.factor == 1:
        return ""
    error = f"{'with a margin ' if agreement.factor > 1 else ''}an error of {percent(agreement.error)}"
    return f", {error}, as errors fall with the square of the number of beams"


def tried_table(choice: Choice) -> StudyTable:
    """A row for each model that was tried."""
    return StudyTable(TRIED, tuple(_tried(line, choice) for line in choice.tried))


def _shares(choice: Choice) -> list[str]:
    """The lines on the share of each beam in the error if it is coarsened alone, one for each model of it."""
    if choice.base is None:
        return []
    width = max(len(of.model.label) for of in choice.shares)
    names = max(len(of.beam) for of in choice.shares)
    flexible, (one, several) = ReferenceModels(choice.scene).flexible, flexible_nouns(choice.scene)
    others = choice.base.label
    if choice.base != flexible:
        others += f" (rigid {several.removeprefix('flexible ')} are compared with {flexible.label})"
    head = ["", f"Share of each {one} in the error, while the other {several} are {others}"]
    return head + [
        f"  {of.beam:{names}}  {of.model.label:{width}}  "
        + (f"fails: {of.failure}" if of.share is None else f"{percent(of.share):>8}")
        for of in choice.shares
    ]


def _tried(line: Line, choice: Choice) -> Row:
    """The values of `TRIED` of a model that was tried."""
    if not line.points:
        return (line.model.label, *(None,) * 6, f"fails: {line.failure}")
    p = shown(line, choice)
    good = "good" if accurate(line, p, choice.error, choice.reference.error) else ""
    verdict = f"fails: {line.failure}" if line.failure else good
    return (line.model.label, p.tolerance, p.rms, line.implied, p.seconds[0], p.evaluations, p.operations, verdict)


def shown(line: Line, choice: Choice) -> Point:
    """The cheapest run of a model that is accurate enough, or else the cheapest of about its smallest error."""
    good = [p for p in line.points if accurate(line, p, choice.error, choice.reference.error)]
    return min(good, key=lambda p: p.operations) if good else cheapest(line)


def verdict_lines(choice: Choice) -> list[str]:
    """The lines on the chosen model and its neighbours, or on the best one if none is accurate enough."""
    if choice.chosen is None:
        lines = [f"No model that was tried has an error of at most {percent(choice.error)}."]
        if choice.best is not None:
            line, point = choice.best
            implied = f", and a monitor implies {implied_percent(implied_error(line))}" if line.warning else ""
            lines.append(f"The best model is {line.model.label}: error {percent(point.rms)}{implied}, {_ms(point)}.")
            if doubtful(choice) is not None:
                lines.append(
                    "Monitors imply larger errors for models that agree with the reference, so it is in doubt."
                )
        return [*lines, *_doubtful_line(choice)]
    line, point = choice.chosen
    result = [f"Chosen: {line.model.label}, {point.setting}: error {percent(point.rms)}, {_ms(point)}"]
    for word, steps in neighbours(choice).items():
        for other, p in steps:
            error = f"has {p.rms / point.rms:.2g} times the error" if point.rms else f"has an error of {percent(p.rms)}"
            what = f"{p.operations / point.operations:.2g} times the operations and {error}"
            result.append(f"  {word}: {other.model.label}, {p.setting}, takes {what}")
    return [*result, *_doubtful_line(choice)]


def doubtful(choice: Choice) -> tuple[Line, Point] | None:
    """The cheapest run that agrees with the reference, but whose monitors imply a larger error, of a line of it alone.

    None if no such run is cheaper than the chosen one.
    """
    most = choice.chosen[1].operations if choice.chosen else inf
    runs = [
        (line, p)
        for line in choice.tried
        for p in line.points
        if implied_error(line) > choice.error and p.rms + choice.reference.error <= choice.error and p.operations < most
    ]
    if not runs:
        return None
    line, point = min(runs, key=lambda run: run[1].operations)
    return replace(line, points=(point,)), point


def _doubtful_line(choice: Choice) -> list[str]:
    """The line on the doubtful run, with the doubt."""
    run = doubtful(choice)
    if run is None:
        return []
    line, point = run
    text = f"{line.model.label}, {point.setting}, {_ms(point)}: {doubt(line, ())}"
    return [f"{'Would be accurate' if choice.chosen is None else 'Cheaper'}, if its warning does not matter: {text}"]


def neighbours(choice: Choice) -> dict[str, list[tuple[Line, Point]]]:
    """The next steps down, cheaper with larger errors, and up, more accurate at a higher price; at most two each."""
    if choice.chosen is None:
        return {}
    chosen, point = choice.chosen
    runs = [(line, shown(line, choice)) for line in choice.tried if line.points and line is not chosen]
    down = sorted((r for r in runs if r[1].rms > point.rms), key=lambda r: r[1].rms)
    sure = [r for r in runs if implied_error(r[0]) <= choice.error]
    up = sorted((r for r in sure if r[1].rms < GAIN * point.rms), key=lambda r: r[1].operations)
    finer = [(chosen, p) for p in chosen.points if p.rms < GAIN * point.rms]
    cheaper = [r for r in down if r[1].operations < point.operations]
    return {"step down": cheaper[:STEPS], "step up": [*finer[:1], *up][:STEPS]}


def _ms(point: Point) -> str:
    return f"{1e3 * point.seconds[0]:.3g} ms"


def choice_data(choice: Choice) -> dict[str, Any]:
    """The whole search as plain data."""
    known, chosen = choice.reference, choice.chosen

    def run(line: Line, point: Point) -> dict[str, Any]:
        return {"model": line.model.label, **asdict(point)}

    return {
        "name": choice.name,
        "plots": list(choice.plots),
        "error": choice.error,
        "screening": [asdict(one) for one in choice.screening],
        "reference": {
            "model": known.model.label,
            "error": known.error,
            "agreements": {a.label: a.difference for a in known.agreements},
        },
        "untried": list(choice.untried),
        "base": choice.base.label if choice.base else None,
        "shares": [
            {"beam": of.beam, "model": of.model.label, "share": of.share, "failure": of.failure} for of in choice.shares
        ],
        "tried": [
            {
                "model": line.model.label,
                "failure": line.failure,
                "implied_error": line.implied,
                "runs": [asdict(p) for p in line.points],
            }
            for line in choice.tried
        ],
        "chosen": None if chosen is None else run(*chosen),
        "doubtful": None if (of := doubtful(choice)) is None else {**run(*of), "doubt": doubt_reason(of[0], ())},
        **{word.replace(" ", "_"): [run(*one) for one in steps] for word, steps in neighbours(choice).items()},
    }
