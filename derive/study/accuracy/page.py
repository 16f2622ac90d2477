"""The page of a ladder: its chart, whose lines show their numbers, and a table; nothing is loaded from elsewhere."""

from __future__ import annotations

from derive.rendering import render
from derive.study.accuracy.chart import LadderChart, accuracy_svg
from derive.study.accuracy.chart_labels import percent
from derive.study.accuracy.table import cheapest


def accuracy_html(chart: LadderChart) -> str:
    """The text of the page."""
    rows = []
    for line in sorted(chart.drawn, key=lambda line: line.best):
        p = cheapest(line)
        rows.append(
            (
                line.label,
                str(line.coordinates),
                percent(p.rms),
                percent(p.worst),
                f"{1e3 * p.seconds[0]:.3g}",
                f"{p.evaluations:,}".replace(",", " "),
                f"{p.operations:,}".replace(",", " "),
                p.setting,
                line.warning.warning if line.warning else line.failure,
            )
        )
    failed = [(line.label, line.failure) for line in chart.lines if not line.points]
    values = {"name": chart.name, "picture": accuracy_svg(chart), "rows": rows, "failed": failed, "chart": chart}
    return render("study/accuracy.html.jinja", values)
