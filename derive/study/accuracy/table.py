"""The numbers of a ladder: as a table for a terminal, as CSV, and as plain data."""

from __future__ import annotations

import csv
import io
import textwrap
from typing import Any

from derive.percentages import percent
from derive.study.accuracy.chart import LadderChart, peer_text
from derive.study.accuracy.doubts import doubt_lines
from derive.study.accuracy.headline import headline_texts
from derive.study.accuracy.measurement import Line, Point
from derive.study.accuracy.pareto import Candidate
from derive.terminal import WIDTH

COLUMNS_OF_PEERS = ("cpu_s", "rms_error", "largest_error")
COLUMNS = (
    "model", "order", "shapes", "number_of_shapes", "beams", "frame", "coordinates", "valid", "integrator", "tolerance",
    "step_s", "rms_error", "largest_error", "cpu_s", "cpu_least_s", "cpu_most_s", "evaluations", "operations",
)  # fmt: skip


def accuracy_text(chart: LadderChart) -> str:
    """The table with a line for each model: its smallest error and the cheapest run within 10 % of it; then doubts."""
    width = max(len(line.label) for line in chart.lines)
    reference = f"{chart.reference.plots[0].name} of {chart.name}, against {chart.reference.source}"
    if chart.reference.error is not None:
        reference += f", which has an error of {percent(chart.reference.error)} itself"
    heading = f"{'model':{width}}  coordinates{'rms':>11}{'largest':>11}{'ms':>10}{'evaluations':>13}{'operations':>12}"
    rows = [reference, heading]
    for line in sorted(chart.drawn, key=lambda line: -line.best):
        p = cheapest(line)
        numbers = f"{percent(p.rms):>11}{percent(p.worst):>11}{1e3 * p.seconds[0]:10.3f}{p.evaluations:13}"
        numbers += f"{p.operations or '':12}"
        rows.append(f"{line.label:{width}}{line.coordinates:13}{numbers}{'' if line.valid else '  not valid'}")
    rows += [f"{peer.name:{width}}               {peer_text(peer.runs[-1])}" for peer in chart.peers]
    doubts = (text.replace(" (hollow, dashed)", "") for text in doubt_lines(chart.lines, chart.shown))
    result = (f"{title}: {text}" for title, text in headline_texts(chart.headline, chart.shown))
    for texts in (doubts, chart.notes, result):
        lines = [line for text in texts for line in textwrap.wrap(text, WIDTH, subsequent_indent="    ")]
        rows += ["", *lines] if lines else []
    if chart.reference.error is not None and any(line.best < chart.reference.error for line in chart.drawn):
        rows.append("errors below that of the reference say only that they are small")
    return "\n".join(rows)


def cheapest(line: Line) -> Point:
    """The cheapest run of a model within 10 % of its smallest error."""
    best = min(p.rms for p in line.points)
    return min((p for p in line.points if p.rms <= 1.1 * best), key=lambda p: p.seconds[0])


def accuracy_csv(chart: LadderChart) -> str:
    """The CSV text with a row for each run."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(COLUMNS)
    for line in chart.drawn:
        model = _model(line)
        for p in line.points:
            numbers = (line.integrator, p.tolerance, p.step, p.rms, p.worst, *p.seconds, p.evaluations, p.operations)
            writer.writerow([*model.values(), *numbers])
    return stream.getvalue()


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
                **_model(line),
                "warning": line.warning.data if line.warning else None,
                "failure": line.failure,
                "integrator": line.integrator,
                "runs": [
                    {
                        "tolerance": p.tolerance,
                        "step_s": p.step,
                        "rms_error": p.rms,
                        "largest_error": p.worst,
                        "cpu_s": dict(zip(("median", "least", "most"), p.seconds, strict=True)),
                        "evaluations": p.evaluations,
                        "operations": p.operations,
                    }
                    for p in line.points
                ],
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
        "recommended": _run(result.recommended),
        "cheaper": _run(result.cheaper),
        "better": _run(result.better),
    }


def _run(run: Candidate | None) -> dict[str, Any] | None:
    """A run of the headline as plain data."""
    if run is None:
        return None
    return {
        "model": run.line.label,
        "setting": run.point.setting,
        "rms_error": run.point.rms,
        "cpu_s": run.point.seconds[0],
    }


def _model(line: Line) -> dict[str, Any]:
    m = line.model
    return {
        "model": line.label,
        "order": m.order.value,
        "shapes": m.shapes.value,
        "number_of_shapes": m.count,
        "beams": m.pieces,
        "frame": m.frame,
        "coordinates": line.coordinates,
        "valid": line.valid,
    }
