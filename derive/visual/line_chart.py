"""Line charts as SVG: curves, their reference, and the deviations from it. The same input gives the same bytes."""

from __future__ import annotations

import math
import textwrap
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from derive.visual.chart_style import REFERENCE, SETTINGS, figure_svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

STYLES = (
    ("#d0702a", (6, 2)),
    ("#8661c1", (6, 1.6, 1.4, 1.6)),
    ("#1f8fbf", ()),
    ("#b3468a", (2, 1.4)),
    ("#5c8a2b", (9, 2)),
    ("#8c6d46", (1, 1)),
)
"""Colours that differ on white and on black, also for colour-blind people, who have the dashes as well; and dashes."""

MAX_POINTS = 800
"""The largest number of points of a curve that a reader can distinguish."""

TITLE_WIDTH = 78
"""Characters of a line of the title."""

WIDTH, HEIGHT, DEVIATIONS_HEIGHT = 8.3, 3.7, 1.5
"""Width of the picture, heights of the chart and of the deviations below it, in inches."""


@dataclass(frozen=True, eq=False)
class Curve:
    """y (n,) over x (n,), and its label in the legend."""

    label: str
    x: Array
    y: Array


@dataclass(frozen=True, eq=False)
class Chart:
    """Curves and their reference; below them the deviations from the reference, in percent of its peak, if known.

    x_unit: the unit of x; angles in rad have ticks at multiples of pi.
    """

    title: str
    x_label: str
    x_unit: str
    y_label: str
    curves: tuple[Curve, ...]
    reference: Curve | None = None
    deviations: tuple[Curve, ...] = ()


def svg(chart: Chart) -> str:
    """The text of the picture."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(SETTINGS)
        title = textwrap.wrap(chart.title, TITLE_WIDTH)
        panels = [HEIGHT, DEVIATIONS_HEIGHT] if chart.deviations else [HEIGHT]
        below = 0.14 + 0.2 * len(title)
        head, foot, gap = below + 0.08 + 0.21 * len(_legend_rows(chart)), 0.55, 0.18
        height = head + foot + sum(panels) + gap * (len(panels) - 1)
        figure = Figure(figsize=(WIDTH, height))
        left, right = 0.82 / WIDTH, 1 - 0.24 / WIDTH
        axes, top = [], height - head
        for panel in panels:
            axes.append(figure.add_axes((left, (top - panel) / height, right - left, panel / height)))
            top -= panel + gap
        _curves(axes[0], chart)
        if chart.deviations:
            axes[0].tick_params(labelbottom=False)
            _deviations(axes[1], chart)
        for axis in axes:
            axis.set_xlim(*_range(chart))
            _ticks(axis, chart.x_unit)
            axis.tick_params(length=3)
        axes[-1].set_xlabel(", ".join(part for part in (chart.x_label, chart.x_unit) if part))
        figure.align_ylabels(axes)
        figure.text(left, 1 - 0.1 / height, "\n".join(title), va="top", fontweight="bold", fontsize=11)
        _legend(figure, axes[0], chart, left, 1 - below / height)
        labels = [curve.label for curve in chart.curves]
        reference = [] if chart.reference is None else [chart.reference.label]
        return figure_svg(figure, "; ".join([chart.title, *reference, *labels]))


def _curves(axes: Axes, chart: Chart) -> None:
    axes.set_ylabel(chart.y_label)
    if chart.reference is not None:
        x, y = _thinned(chart.reference)
        axes.plot(x, y, color=REFERENCE, linewidth=5, alpha=0.55, solid_capstyle="round", label=chart.reference.label)
    for number, curve in enumerate(chart.curves):
        axes.plot(*_thinned(curve), label=curve.label, **_style(number))


def _deviations(axes: Axes, chart: Chart) -> None:
    axes.set_ylabel("deviation,\n% of peak")
    axes.axhline(0, color=REFERENCE, linewidth=2, alpha=0.55)
    for number, curve in enumerate(chart.deviations):
        axes.plot(*_thinned(curve), **_style(number, 1.2))


def _style(number: int, width: float = 1.6) -> dict[str, Any]:
    colour, dashes = STYLES[number % len(STYLES)]
    return {"color": colour, "linewidth": width, "dashes": dashes or (None, None), "dash_capstyle": "butt"}


def _thinned(curve: Curve) -> tuple[Array, Array]:
    stride = max(1, math.ceil((len(curve.x) - 1) / MAX_POINTS))
    chosen = np.unique(np.append(np.arange(0, len(curve.x), stride), len(curve.x) - 1))
    return curve.x[chosen], curve.y[chosen]


def _range(chart: Chart) -> tuple[float, float]:
    """The range of x of the curves; that of the reference may be larger."""
    low, high = min(c.x.min() for c in chart.curves), max(c.x.max() for c in chart.curves)
    return (low, high) if high > low else (low - 1, low + 1)


def _ticks(axes: Axes, unit: str) -> None:
    """Ticks of an angle over more than half a revolution: multiples of pi."""
    from matplotlib.ticker import FuncFormatter, MultipleLocator

    low, high = axes.get_xlim()
    if unit != "rad" or high - low < math.pi:
        return
    step = next((s for s in (0.25, 0.5, 1, 2, 4, 10, 20, 100) if (high - low) / math.pi / s <= 10), None)
    if step is not None:
        axes.xaxis.set_major_locator(MultipleLocator(step * math.pi))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: _multiple_of_pi(x / math.pi)))


def _multiple_of_pi(value: float) -> str:
    text = f"{abs(value):.2f}".rstrip("0").rstrip(".")
    sign = "\N{MINUS SIGN}" if value < 0 else ""
    return "0" if text == "0" else f"{sign}π" if text == "1" else f"{sign}{text}π"


def _legend_rows(chart: Chart) -> range:
    count = len(chart.curves) + (chart.reference is not None)
    return range(0 if count == 1 else math.ceil(count / 2))


def _legend(figure: Figure, axes: Axes, chart: Chart, left: float, top: float) -> None:
    """The legend below the title, in two columns."""
    if not _legend_rows(chart):
        return
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(
        handles,
        labels,
        loc="upper left",
        bbox_to_anchor=(left, top),
        ncols=2,
        borderaxespad=0,
        borderpad=0,
        handlelength=3,
        columnspacing=3,
        labelspacing=0.35,
    )
