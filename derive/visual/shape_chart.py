"""The shape functions of a beam as SVG: a panel for each kind of deformation, as narrow as a phone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.simulation.observables.axis_ticks import plain_numbers
from derive.visual.chart_style import COLOURS, FAINT, SETTINGS, figure_svg
from derive.visual.line_chart import DASHES
from derive.visual.text_metrics import widest

WIDTH, HEIGHT, GAP, HEAD, FOOT, LEFT, RIGHT = 4.6, 1.3, 0.38, 0.3, 0.5, 0.5, 0.12
"""The width of the picture, the height of a panel and the distances around the panels, in inches."""
TEXT, POINTS, LINE = 10, 72, 0.2
"""The size of texts in points, the points of an inch, and the height of a line of a legend in inches."""
HANDLE = 0.42
"""The width of a line of a legend with its distances, in inches."""

TICKS = (-1.0, -0.5, 0.0, 0.5, 1.0)
"""The places xi that are marked."""


@dataclass(frozen=True, eq=False)
class ShapePanel:
    """The shapes of one kind of deformation by the numbers of their amplitudes: values (n,) at xi from -1 to 1."""

    title: str
    shapes: tuple[tuple[int, NDArray[np.float64]], ...]


def shape_chart(panels: Sequence[ShapePanel], title: str) -> str:
    """The panels below each other over one axis xi, each with the numbers of its shapes beside it.

    The legend of many shapes has as many columns as its panel has room for below each other.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(SETTINGS)
        height = HEAD + FOOT + HEIGHT * len(panels) + GAP * (len(panels) - 1)
        figure = Figure(figsize=(WIDTH, height))
        rows = int(HEIGHT / LINE)
        columns = max(-(-len(panel.shapes) // rows) for panel in panels)
        label = max(widest(_labels(panel), TEXT) for panel in panels) / POINTS
        beside = columns * (label + HANDLE) + RIGHT
        top = height - HEAD
        for k, panel in enumerate(panels):
            place = (LEFT / WIDTH, (top - HEIGHT) / height, (WIDTH - LEFT - beside) / WIDTH, HEIGHT / height)
            axes = figure.add_axes(place)
            axes.set_title(panel.title, loc="left", fontsize=TEXT, fontweight="bold", pad=5)
            axes.axhline(0, color=FAINT, linewidth=2.5, alpha=0.6, solid_capstyle="butt")
            for number, (_, values) in enumerate(panel.shapes):
                xi = np.linspace(-1, 1, len(values))
                axes.plot(xi, values, linewidth=1.6, **_look(number))
            axes.set_xlim(-1, 1)
            axes.set_xticks(TICKS, labels=[plain_numbers([xi])[0] for xi in TICKS])
            axes.tick_params(length=3, labelbottom=k + 1 == len(panels))
            legend: dict[str, Any] = {"loc": "upper left", "bbox_to_anchor": (1.02, 1), "borderaxespad": 0}
            look: dict[str, Any] = {"handlelength": 1.8, "handletextpad": 0.4, "columnspacing": 0.8, "borderpad": 0}
            axes.legend(axes.lines[1:], _labels(panel), ncols=columns, labelspacing=0.25, **legend, **look)
            top -= HEIGHT + GAP
        axes.set_xlabel("ξ")
        return figure_svg(figure, title)


def _labels(panel: ShapePanel) -> list[str]:
    return [str(number) for number, _ in panel.shapes]


def _look(number: int) -> dict[str, Any]:
    """The colour and the dashes of a curve, by which colour-blind people distinguish it."""
    dashes = DASHES[number % len(DASHES)]
    return {"color": COLOURS[number % len(COLOURS)], "dashes": dashes or (None, None), "dash_capstyle": "butt"}
