"""The page of a ladder: its headline, its chart, whose lines show their numbers, and a table.

The page loads no other files.
"""

from __future__ import annotations

from derive.percentages import percent
from derive.rendering import render
from derive.study.accuracy.chart import LadderChart, accuracy_svg
from derive.study.accuracy.chart_labels import grouped, milliseconds
from derive.study.accuracy.doubts import doubt_reason
from derive.study.accuracy.headline import headline_texts
from derive.study.accuracy.table import cheapest


def accuracy_html(chart: LadderChart) -> str:
    """The text of the page."""
    rows = []
    for line in sorted(chart.drawn, key=lambda line: line.best):
        p = cheapest(line)
        rows.append(
            (
                line.label,
                percent(p.rms),
                percent(p.worst),
                percent(line.warning.error) if line.warning else "",
                milliseconds(p.seconds[0]),
                grouped(p.evaluations),
                grouped(p.operations) if p.operations else "",
                str(line.coordinates),
                p.setting,
                doubt_reason(line, chart.shown),
            )
        )
    values = {
        "name": chart.name,
        "headline": headline_texts(chart.headline, chart.shown),
        "picture": accuracy_svg(chart, alone=False),
        "rows": rows,
        "warnings": list(dict.fromkeys(line.warning.warning for line in chart.drawn if line.warning)),
        "notes": chart.notes,
        "failed": [(line.label, line.failure) for line in chart.lines if not line.points],
    }
    return render("study/accuracy.html.jinja", values)
