"""Line charts as SVG: curves, their reference, and the deviations from it. The same input gives the same bytes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from derive.simulation.observables.axis_ticks import plain_numbers
from derive.visual.chart_style import COLOURS, REFERENCE, SETTINGS, figure_svg
from derive.visual.text_metrics import widest, wrapped

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

Array = NDArray[np.float64]

DASHES: tuple[tuple[float, ...], ...] = ((), (6, 2), (6, 1.6, 1.4, 1.6), (2, 1.4), (9, 2), (1, 1))
"""The dashes of the curves of a panel, by which colour-blind people distinguish them; the first is solid."""

MAX_POINTS = 800
"""The largest number of points of a curve that a reader can distinguish."""

TITLE_WIDTH = 78
"""Characters of a line of the title."""

WIDTH, HEIGHT, SHARED_HEIGHT, DEVIATIONS_HEIGHT = 8.3, 3.7, 2.3, 1.5
"""Width of the picture, heights of a panel, of one of several, and of the deviations below them, in inches."""
LEFT, RIGHT = 0.82, 0.24
"""The margins beside the panels, in inches."""
ROOM = WIDTH - LEFT - RIGHT
"""The width of the panels, of the title and of the legend above them, in inches."""
TITLE, TEXT, POINTS = 11, 10, 72
"""The sizes of the title and of other texts, in points, and the points of an inch."""
LEGEND: dict[str, Any] = {
    "borderaxespad": 0,
    "borderpad": 0,
    "handlelength": 3,
    "columnspacing": 3,
    "labelspacing": 0.35,
}
"""The distances in the legend, in sizes of its text."""
LABEL_LINES = 2
"""The largest number of lines of the label of an axis."""
HANDLE, APART = 0.55, 0.42
"""The width of a line of the legend with its distance from the text, and the distance of columns, in inches."""


@dataclass(frozen=True, eq=False)
class Curve:
    """y (n,) over x (n,), and its label in the legend.

    deviation: x (m,), and the deviation (m,) from the reference in percent of its peak, if it is known.
    """

    label: str
    x: Array
    y: Array
    deviation: tuple[Array, Array] | None = None


@dataclass(frozen=True, eq=False)
class Panel:
    """Curves of one unit over each other, with the label of their axis and the unit, and their reference."""

    y_label: str
    unit: str
    curves: tuple[Curve, ...]
    reference: Curve | None = None


@dataclass(frozen=True, eq=False)
class Chart:
    """Panels below each other, of which each has an axis of its own; a chart of one quantity has one.

    Below them are the deviations of the curves from the reference, where they are known. x_unit: the unit of x; angles
    in rad have ticks at multiples of pi.
    """

    title: str
    x_label: str
    x_unit: str
    panels: tuple[Panel, ...]

    @property
    def curves(self) -> tuple[Curve, ...]:
        """The curves of all panels."""
        return tuple(curve for panel in self.panels for curve in panel.curves)

    @property
    def references(self) -> tuple[str, ...]:
        """The labels of the references; that of several panels is one."""
        return tuple(dict.fromkeys(panel.reference.label for panel in self.panels if panel.reference is not None))


def svg(chart: Chart) -> str:
    """The text of a chart as SVG."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(SETTINGS)
        title = wrapped(chart.title, POINTS * ROOM, TITLE, bold=True)
        columns, labels = _legend_columns(chart)
        panels = [HEIGHT if len(chart.panels) == 1 else SHARED_HEIGHT] * len(chart.panels)
        deviations = any(curve.deviation is not None for curve in chart.curves)
        panels += [DEVIATIONS_HEIGHT] if deviations else []
        below = 0.14 + 0.2 * len(title)
        head, foot, gap = below + 0.08 + _legend_height(columns, labels), 0.55, 0.18
        height = head + foot + sum(panels) + gap * (len(panels) - 1)
        figure = Figure(figsize=(WIDTH, height))
        left, top, axes = LEFT / WIDTH, height - head, []
        for panel in panels:
            axes.append(figure.add_axes((left, (top - panel) / height, ROOM / WIDTH, panel / height)))
            top -= panel + gap
        handles = _curves(axes, chart)
        if deviations:
            _deviations(axes[-1], chart)
        for axis in axes:
            axis.set_xlim(*_range(chart))
            _ticks(axis, chart.x_unit)
            axis.tick_params(length=3, labelbottom=axis is axes[-1])
        axes[-1].set_xlabel(", ".join(part for part in (chart.x_label, chart.x_unit) if part))
        figure.align_ylabels(axes)
        figure.text(left, 1 - 0.1 / height, "\n".join(title), va="top", fontweight="bold", fontsize=TITLE)
        if columns:
            where: dict[str, Any] = {"loc": "upper left", "bbox_to_anchor": (left, 1 - below / height)}
            figure.legend(handles, labels, ncols=columns, **where, **LEGEND)
        return figure_svg(figure, "; ".join([chart.title, *chart.references, *(c.label for c in chart.curves)]))


def _curves(axes: Sequence[Axes], chart: Chart) -> list[Line2D]:
    """Draw the curves with their references, and return the lines of the legend."""
    references: dict[str, Line2D] = {}
    lines: list[Line2D] = []
    for axis, panel in zip(axes, chart.panels, strict=False):
        axis.set_ylabel(_y_label(panel, HEIGHT if len(chart.panels) == 1 else SHARED_HEIGHT))
        if panel.reference is not None:
            look: dict[str, Any] = {"color": REFERENCE, "linewidth": 5, "alpha": 0.55, "solid_capstyle": "round"}
            x, y = panel.reference.x, panel.reference.y
            references[panel.reference.label] = axis.plot(*_thinned(x, y), **look)[0]
        for number, curve in enumerate(panel.curves):
            lines += axis.plot(*_thinned(curve.x, curve.y), linewidth=1.6, **_look(len(lines), number))
    return [*references.values(), *lines]


def _deviations(axes: Axes, chart: Chart) -> None:
    """Draw the deviations of the curves in the colours and dashes of the curves."""
    axes.set_ylabel("deviation,\n% of peak")
    axes.axhline(0, color=REFERENCE, linewidth=2, alpha=0.55)
    numbered = [(number, curve) for panel in chart.panels for number, curve in enumerate(panel.curves)]
    for n, (number, curve) in enumerate(numbered):
        if curve.deviation is not None:
            axes.plot(*_thinned(*curve.deviation), linewidth=1.2, **_look(n, number))


def _look(number: int, in_panel: int) -> dict[str, Any]:
    """The colour of a curve by its number in the chart, and its dashes by that in its panel."""
    dashes = DASHES[in_panel % len(DASHES)]
    return {"color": COLOURS[number % len(COLOURS)], "dashes": dashes or (None, None), "dash_capstyle": "butt"}


def _y_label(panel: Panel, inches: float) -> str:
    """The label and the unit of a panel of this height; the unit alone if there is no room for both."""
    lines = wrapped(", ".join(part for part in (panel.y_label, panel.unit) if part), POINTS * inches, TEXT)
    return "\n".join(lines) if len(lines) <= LABEL_LINES else panel.unit


def _thinned(x: Array, y: Array) -> tuple[Array, Array]:
    stride = max(1, math.ceil((len(x) - 1) / MAX_POINTS))
    chosen = np.unique(np.append(np.arange(0, len(x), stride), len(x) - 1))
    return x[chosen], y[chosen]


def _range(chart: Chart) -> tuple[float, float]:
    """The range of x of the curves; that of the reference may be larger."""
    low, high = min(c.x.min() for c in chart.curves), max(c.x.max() for c in chart.curves)
    return (low, high) if high > low else (low - 1, low + 1)


def _ticks(axes: Axes, unit: str) -> None:
    """Set the ticks as plain numbers, without a factor at the end of the axis; of an angle, at multiples of pi."""
    from matplotlib.ticker import Formatter, FuncFormatter, MultipleLocator

    class PlainNumbers(Formatter):
        def __call__(self, x: float, _: int | None = None) -> str:
            return plain_numbers([x])[0]

        def format_ticks(self, values: Sequence[float]) -> list[str]:
            return plain_numbers(values)

    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(PlainNumbers())
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


def _legend_columns(chart: Chart) -> tuple[int, list[str]]:
    """The columns of the legend, and its labels, divided into lines where there is no room.

    There is no legend where each curve has an axis of its own, whose label names it.
    """
    if all(len(panel.curves) == 1 and panel.reference is None for panel in chart.panels):
        return 0, []
    labels = [*chart.references, *(curve.label for curve in chart.curves)]
    if widest(labels, TEXT) <= POINTS * ((ROOM - APART) / 2 - HANDLE):
        return 2, labels
    return 1, ["\n".join(wrapped(label, POINTS * (ROOM - HANDLE), TEXT)) for label in labels]


def _legend_height(columns: int, labels: Sequence[str]) -> float:
    """The height of the legend, in inches."""
    lines = sum(len(label.split("\n")) for label in labels)
    return 0.21 * math.ceil(lines / max(columns, 1))
