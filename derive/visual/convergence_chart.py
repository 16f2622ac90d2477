"""Errors of the modes of a body over their number, as SVG."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from derive.visual.chart_style import COLOURS, SETTINGS, figure_svg
from derive.visual.line_chart import DASHES

WIDTH, HEIGHT = 5.2, 2.7
"""The size of the picture, in inches."""

LEAST = 1e-9
"""Errors below this, in percent, are drawn there: they are rounding."""

FEW_DECADES = 100
"""Powers of ten alone would label an axis with less than this between its ends at one or two places."""


def convergence_chart(counts: Sequence[int], errors: Sequence[tuple[str, Sequence[float]]], title: str) -> str:
    """A curve for each label of `errors`, relative ones, over the number of modes; gaps where errors are infinite."""
    import matplotlib as mpl
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator, MaxNLocator

    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(SETTINGS)
        figure = Figure(figsize=(WIDTH, HEIGHT))
        axes = figure.add_axes((0.14, 0.2, 0.83, 0.66))
        for number, (label, values) in enumerate(errors):
            percent = np.maximum(100 * np.array(values), LEAST)
            dashes = DASHES[number % len(DASHES)] or (None, None)
            axes.plot(
                counts,
                np.where(np.isfinite(percent), percent, np.nan),
                marker="o",
                markersize=3.5,
                color=COLOURS[number % len(COLOURS)],
                dashes=dashes,
                label=label,
            )
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.minorticks_off()
        low, high = axes.get_ylim()
        if high < FEW_DECADES * low:
            axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        axes.set_xlabel("number of modes")
        axes.set_ylabel("largest error, %")
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=2, borderaxespad=0.2)
        return figure_svg(figure, title)
