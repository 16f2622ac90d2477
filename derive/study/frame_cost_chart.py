"""The chart of `tisserand study frames`: the cost of one frame divided by that of the other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from derive.study.frame_cost import PAPER, FrameComparison, FrameCost
from derive.study.frame_study import FrameStudy
from derive.terminal import beam_count
from derive.visual import chart_style as style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH, HEIGHT = 8.3, 4.9  # inches
MEASURED, PAPER_COLOUR = "#d0702a", "#b3468a"


@dataclass(frozen=True)
class RatioLine:
    """The line of a ratio over the number of beams: its label, the count, marker, colour and dashes."""

    label: str
    count: Callable[[FrameCost], int]
    marker: str
    colour: str
    dashes: tuple[float, ...]


LINES = (
    RatioLine("non-zeros of M", lambda f: f.counts.mass, "s", "#8661c1", (2, 1.4)),
    RatioLine("non-zeros of the KKT matrix", lambda f: f.counts.kkt, "D", "#5c8a2b", (9, 2)),
    RatioLine("operations of LDLᵀ", lambda f: f.counts.flops, "^", "#8c6d46", (6, 1.6, 1.4, 1.6)),
    RatioLine("operations of the accelerations", lambda f: f.counts.accel, "v", "#1f8fbf", (6, 2)),
)


def frame_cost_svg(study: FrameStudy) -> str:
    """The text of the chart. The same numbers give the same bytes."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    frames, rows = study.frames, study.rows
    title = f"{study.name}: cost in the {frames[0]} frame divided by cost in the {frames[1]} frame"
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(style.SETTINGS)
        figure = Figure(figsize=(WIDTH, HEIGHT))
        left, head, foot = 0.62, 1.12, 0.55
        size = ((WIDTH - left - 0.12) / WIDTH, (HEIGHT - head - foot) / HEIGHT)
        axes = figure.add_axes((left / WIDTH, foot / HEIGHT, *size))
        _lines(axes, frames, rows)
        figure.text(left / WIDTH, 1 - 0.1 / HEIGHT, title, va="top", fontweight="bold", fontsize=11)
        place: Any = {"loc": "upper left", "bbox_to_anchor": (left / WIDTH, 1 - 0.36 / HEIGHT), "ncols": 2}
        space: Any = {"borderaxespad": 0, "borderpad": 0, "handlelength": 3, "columnspacing": 3, "labelspacing": 0.35}
        handles, labels = axes.get_legend_handles_labels()
        figure.legend(handles=handles, labels=labels, **place, **space)
        return style.figure_svg(figure, "; ".join([title, *_values(rows)]))


def _lines(axes: Axes, frames: tuple[str, str], rows: Sequence[FrameComparison]) -> None:
    places = range(len(rows))
    axes.axhline(1, color=style.REFERENCE, linewidth=2, alpha=0.55)
    _bars(axes, rows)
    for line in LINES:
        ratios = [line.count(row.costs[0]) / max(line.count(row.costs[1]), 1) for row in rows]
        marks: Any = {"marker": line.marker, "markersize": 5, "dashes": line.dashes, "linewidth": 1.4}
        axes.plot(places, ratios, label=line.label, color=line.colour, **marks)
    known = [(i, PAPER[row.pieces]) for i, row in enumerate(rows) if row.pieces in PAPER]
    if frames == ("mean", "point") and known:
        marks = {"linestyle": "none", "marker": "o", "markersize": 8, "fillstyle": "none", "markeredgewidth": 2}
        axes.plot(*zip(*known, strict=True), label="CPU time in the paper (1988, DADS)", color=PAPER_COLOUR, **marks)
    axes.set_ylim(0, 1.1)
    axes.set_xticks(list(places), [beam_count(row.pieces) for row in rows])
    axes.set_xlim(-0.5, len(rows) - 0.5)
    axes.tick_params(length=3)
    axes.grid(axis="x", visible=False)
    axes.set_ylabel(f"{frames[0]} / {frames[1]}")
    axes.set_xlabel("the rod is cut into")


def _bars(axes: Axes, rows: Sequence[FrameComparison]) -> None:
    """Draw the measured CPU times, with their spread."""
    ratios = [row.times.integration_ratio for row in rows]
    middle = [r.median for r in ratios]
    spread = [[r.median - r.least for r in ratios], [r.most - r.median for r in ratios]]
    places, label = range(len(rows)), f"CPU time of an integration, its spread in {rows[0].times.runs} runs"
    axes.bar(places, middle, 0.56, color=MEASURED, alpha=0.45, label=label)
    marks: Any = {"color": MEASURED, "linestyle": "none", "linewidth": 2, "capsize": 9}
    axes.errorbar(places, middle, yerr=spread, **marks)
    for place, value in zip(places, middle, strict=True):
        axes.text(place, 0.03, f"{value:.2f}", ha="center", fontweight="bold", fontsize=12)


def _values(rows: Sequence[FrameComparison]) -> list[str]:
    """The texts of the numbers of the chart, for its title."""
    return [f"{beam_count(row.pieces)}: CPU time {row.times.integration_ratio.median:.2f}" for row in rows]
