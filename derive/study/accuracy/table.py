"""The numbers of a ladder: a table of its models as text and on a page, and one of all runs as CSV and plain data."""

from __future__ import annotations

import textwrap
from typing import Any

from derive.percentages import implied_percent, percent
from derive.rendering import render
from derive.study.accuracy.chart import accuracy_svg, peer_text
from derive.study.accuracy.chart_labels import grouped, milliseconds
from derive.study.accuracy.doubts import doubt_lines, doubt_reason
from derive.study.accuracy.headline import Candidate, headline_texts
from derive.study.accuracy.ladder_chart import LadderChart
from derive.study.accuracy.ladder_model import MODEL_COLUMNS, model_row
from derive.study.accuracy.measurement import Line, Point
from derive.study.table import StudyColumn, StudyTable, columns, named
from derive.terminal import WIDTH

COLUMNS_OF_PEERS = ("cpu_s", "rms_error", "largest_error")
LINE_COLUMNS = (*MODEL_COLUMNS, *columns("coordinates", "valid"))
"""The columns of a model with its runs."""
COST = columns("cpu_s", "cpu_least_s", "cpu_most_s", "evaluations", "operations")
RUN_COLUMNS = (*columns("tolerance", "step_s", "rms_error", "largest_error"), *COST)
"""The columns of a run."""
MODEL_DOC = (
    "rigid bodies, or the number of beams in the rod and their shapes: half sine waves or Legendre polynomials P2, P3, "
    "..., in space in both planes; of finite-element bodies free modes, or Craig-Bampton modes, which are the static "
    "ones of the interface and vibrations; first, truncated, full: the order of the displacements"
)
MODELS = (
    StudyColumn("model", doc=MODEL_DOC),
    StudyColumn("rms", percent, doc="the measured error of the plot, relative to its peak"),
    StudyColumn("largest", percent, doc="the largest measured error"),
    StudyColumn("implied", implied_percent, doc="the error that a monitor estimates for the beam that it doubts"),
    StudyColumn("ms", milliseconds, doc="CPU time of the integration"),
    StudyColumn("evaluations", grouped, doc="of the accelerations"),
    StudyColumn("operations", grouped, doc="arithmetic operations of all evaluations"),
    StudyColumn("coordinates"),
    StudyColumn("setting"),
    StudyColumn("valid", lambda valid: "" if valid else "not valid", head=""),
    StudyColumn("doubt"),
)
"""The columns of a model with one of its runs."""
IN_TEXT = ("model", "coordinates", "rms", "largest", "ms", "evaluations", "operations", "valid")
ON_PAGE = ("model", "rms", "largest", "implied", "ms", "evaluations", "operations", "coordinates", "setting", "doubt")


def model_table(chart: LadderChart) -> StudyTable:
    """A row for each model, from the smallest error on: the cheapest run within 10 % of that error."""
    rows = []
    for line in sorted(chart.drawn, key=lambda line: line.best):
        p = cheapest(line)
        sizes = (p.rms, p.worst, line.implied, p.seconds[0], p.evaluations, p.operations or None, line.coordinates)
        rows.append((line.label, *sizes, p.setting, line.valid, doubt_reason(line, chart.shown)))
    return StudyTable(
        MODELS, tuple(rows), notes=("each row is the cheapest run of a model within 10 % of its smallest error",)
    )


def run_table(chart: LadderChart) -> StudyTable:
    """A row for each run of each model."""
    rows = [(*_line(line), line.integrator, *_run(p)) for line in chart.drawn for p in line.points]
    return StudyTable((*LINE_COLUMNS, *columns("integrator"), *RUN_COLUMNS), tuple(rows))


def accuracy_text(chart: LadderChart) -> str:
    """The table of models, from the largest error on, then doubts, notes and the result."""
    reference = f"{chart.reference.plots[0].name} of {chart.name}, against {chart.reference.source}"
    if chart.reference.error is not None:
        reference += f", which has an error of {percent(chart.reference.error)} itself"
    rows = [reference, *model_table(chart).only(IN_TEXT).reversed.text]
    rows += [f"  {peer.name}: {peer_text(peer.runs[-1])}" for peer in chart.peers]
    result = (f"{title}: {text}" for title, text in headline_texts(chart.headline, chart.shown))
    for texts in (doubt_lines(chart.lines, chart.shown), chart.notes, result):
        lines = [line for text in texts for line in textwrap.wrap(text, WIDTH, subsequent_indent="    ")]
        rows += ["", *lines] if lines else []
    if chart.reference.error is not None and any(line.best < chart.reference.error for line in chart.drawn):
        rows.append("errors below that of the reference are known to be small, but not how small")
    return "\n".join(rows)


def accuracy_html(chart: LadderChart) -> str:
    """The page: the headline, the chart, whose lines show their numbers, and the table; it loads no other files."""
    values = {
        "name": chart.name,
        "headline": headline_texts(chart.headline, chart.shown),
        "picture": accuracy_svg(chart, alone=False),
        "table": model_table(chart).only(ON_PAGE),
        "warnings": [
            f"{line.label}: {line.warning.warning}"
            for line in chart.drawn
            if line.warning and line.integrator == "adaptive"
        ],
        "notes": chart.notes,
        "failed": [(line.label, line.failure) for line in chart.lines if not line.points],
    }
    return render("study/accuracy.html.jinja", values)


def cheapest(line: Line) -> Point:
    """The cheapest run of a model within 10 % of its smallest error."""
    best = min(p.rms for p in line.points)
    return min((p for p in line.points if p.rms <= 1.1 * best), key=lambda p: p.seconds[0])


def accuracy_data(chart: LadderChart) -> dict[str, Any]:
    """The whole study as plain data."""
    result = chart.headline
    return {
        "name": chart.name,
        "machine": chart.machine,
        "plot": chart.reference.plots[0].name,
        "reference": {"source": chart.reference.source, "error": chart.reference.error},
        "models": [
            {
                **named(LINE_COLUMNS, _line(line)),
                "warning": line.warning.data if line.warning else None,
                "missed_modes": {of.body: of.error for of in line.missed},
                "failure": line.failure,
                "integrator": line.integrator,
                "runs": [named(RUN_COLUMNS, _run(p)) for p in line.points],
            }
            for line in chart.lines
        ],
        "peers": [
            {"model": peer.name, "runs": [dict(zip(COLUMNS_OF_PEERS, run, strict=True)) for run in peer.runs]}
            for peer in chart.peers
        ],
        "notes": list(chart.notes),
        "asked": chart.error,
        "shown": list(chart.shown),
        "recommended": _candidate(result.recommended),
        "cheaper": _candidate(result.cheaper),
        "better": _candidate(result.better),
    }


def _line(line: Line) -> tuple[Any, ...]:
    """The values of `LINE_COLUMNS`."""
    return (*model_row(line.model, line.label), line.coordinates, line.valid)


def _run(p: Point) -> tuple[Any, ...]:
    """The values of `RUN_COLUMNS`."""
    return p.tolerance, p.step, p.rms, p.worst, *p.seconds, p.evaluations, p.operations


def _candidate(run: Candidate | None) -> dict[str, Any] | None:
    """A run of the headline as plain data."""
    if run is None:
        return None
    return {
        "model": run.line.label,
        "setting": run.point.setting,
        "rms_error": run.point.rms,
        "cpu_s": run.point.seconds[0],
    }
