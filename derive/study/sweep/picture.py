"""The picture of a sweep: outputs over one name as lines, or over two names as maps; random samples as points."""

from __future__ import annotations

import math
import textwrap
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from derive.runtime.native_call import Vector
from derive.study.sweep.outputs import SweepOutput
from derive.study.sweep.result import SweepResult
from derive.study.sweep.table import short_names
from derive.visual.chart_style import COLOURS, FAINT, INK, SETTINGS, figure_svg
from derive.visual.line_chart import TITLE_WIDTH, WIDTH

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LINE_HEIGHT, MAP_HEIGHT = 2.6, 4.4
"""The heights of a panel with a line or a map, in inches."""
LINE_RIGHT, MAP_RIGHT = 0.3, 1.15
"""The margins on the right of a panel with a line or a map, in inches; that of a map has the bar of its colours."""
MARKED_VALUES = 40
"""Lines with at most this number of values have a point for each."""
LEVELS = 8
"""The approximate number of contour lines of a map."""
WIDE = 30
"""Positive values whose ratio is larger have a logarithmic scale of colours."""
SHADE = "#202020"
"""The colour behind white marks on a map, so that they are visible on any colour."""
RESOLUTION = 200
"""Dots per inch of the cells of a map."""


def sweep_svg(result: SweepResult) -> str | None:
    """The text of the picture; None unless one or two names vary."""
    names = result.samples.varying
    if len(names) not in (1, 2):
        return None
    # Colours and contours change at limits of rounding: the bytes would differ with the last bits of the values.
    rounded = [float(f"{value:.9g}") for value in result.values.flat]
    result = replace(result, values=np.reshape(rounded, result.values.shape))
    import matplotlib as mpl
    from matplotlib.figure import Figure

    short = short_names(result.samples)
    over = " and ".join(short[name] for name in names)
    title = textwrap.wrap(f"{result.name}: {', '.join(o.text for o in result.outputs)} over {over}", TITLE_WIDTH)
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(SETTINGS)
        panel = LINE_HEIGHT if len(names) == 1 else MAP_HEIGHT
        head, foot = 0.25 + 0.2 * len(title), 0.6
        height = head + len(result.outputs) * (panel + foot)
        figure = Figure(figsize=(WIDTH, height), dpi=RESOLUTION)
        left = 0.95 / WIDTH
        for number, output in enumerate(result.outputs):
            bottom = height - head - panel - number * (panel + foot)
            right = LINE_RIGHT if len(names) == 1 else MAP_RIGHT
            axes = figure.add_axes((left, bottom / height, 1 - left - right / WIDTH, panel / height))
            if len(names) == 1:
                _line(axes, result, output, number)
            else:
                bar = figure.add_axes((1 - (right - 0.15) / WIDTH, bottom / height, 0.18 / WIDTH, panel / height))
                _map(axes, bar, result, output)
            axes.set_xlabel(_with_unit(short[names[0]], result.units[names[0]]))
        figure.text(left, 1 - 0.1 / height, "\n".join(title), va="top", fontweight="bold", fontsize=11)
        return figure_svg(figure, " ".join(title))


def _with_unit(text: str, unit: str) -> str:
    return f"{text}, {unit}" if unit else text


def _is_logarithmic(values: Vector) -> bool:
    """Whether positive values are spaced with a constant ratio of more than 1 %."""
    ordered = np.sort(values)
    if len(ordered) < 3 or ordered[0] <= 0:
        return False
    ratios = np.diff(np.log(ordered))
    return bool(np.ptp(ratios) < 1e-6 * ratios.max() and ratios.max() > 0.01)


def _line(axes: Axes, result: SweepResult, output: SweepOutput, number: int) -> None:
    """Draw an output over one name: a line through the values of a grid, points of random samples."""
    (name,) = result.samples.varying
    x, y = result.samples.values[:, result.samples.names.index(name)], result.column(output.label)
    order = np.argsort(x, kind="stable")
    joined = bool(result.samples.shape)
    colour = COLOURS[(number + 2) % len(COLOURS)]
    marker = "o" if not joined or len(x) <= MARKED_VALUES else None
    axes.plot(x[order], y[order], color=colour, linewidth=1.6 if joined else 0, marker=marker, markersize=3.5)
    axes.set_ylabel(_with_unit(output.label, output.unit))
    if _is_logarithmic(result.samples.axis(name)):
        axes.set_xscale("log")
        _plain_ticks(axes)
    for failed in x[np.isnan(y)]:
        axes.axvline(failed, color=FAINT, linewidth=1, dashes=(2, 2))
    if np.isnan(y).any():
        axes.annotate("dashed: failed", (0.99, 0.97), xycoords="axes fraction", ha="right", va="top", color=INK)
    axes.tick_params(length=3)


def _map(axes: Axes, beside: Axes, result: SweepResult, output: SweepOutput) -> None:
    """Draw an output over two names: cells of a grid with contour lines, or coloured points; mark its extremes."""
    samples, names = result.samples, result.samples.varying
    x, y = (samples.values[:, samples.names.index(name)] for name in names)
    z = result.column(output.label)
    for name, scale in zip(names, (axes.set_xscale, axes.set_yscale), strict=True):
        if _is_logarithmic(samples.axis(name)):
            scale("log")
    _plain_ticks(axes)
    axes.grid(visible=False)
    axes.set_facecolor("none")
    levels = _levels(z)
    norm = "log" if isinstance(levels, list) else "linear"
    if samples.shape:
        cells = _cells(result, output)
        drawn = axes.pcolormesh(*cells, cmap="viridis", shading="nearest", rasterized=True, norm=norm)
        if min(cells[2].shape) > 2 and np.nanmin(z) < np.nanmax(z):
            lines = axes.contour(*cells, levels=levels, colors="white", linewidths=0.7)
            axes.clabel(lines, fontsize=8, fmt=_plain)
    else:
        drawn = axes.scatter(  # type: ignore[assignment]
            x, y, c=z, cmap="viridis", norm=norm, s=14, linewidths=0
        )
    if np.isnan(z).any():
        axes.plot(x[np.isnan(z)], y[np.isnan(z)], "x", color=INK, markersize=4, label="failed")
        axes.annotate(
            "\N{MULTIPLICATION X} failed", (1, 1.01), xycoords="axes fraction", ha="right", va="bottom", color=INK
        )
    bar = axes.figure.colorbar(drawn, cax=beside)
    bar.set_label(_with_unit(output.label, output.unit))
    if isinstance(levels, list):
        bar.set_ticks(levels, labels=list(map(_plain, levels)))
        bar.minorticks_off()
    bar.outline.set_visible(False)
    axes.set_ylabel(_with_unit(short_names(samples)[names[1]], result.units[names[1]]))
    axes.tick_params(length=3)
    _mark(axes, x, y, z)


def _levels(z: Vector) -> int | list[float]:
    """The contour lines of values: 1, 2, 5, 10, ... if they are positive and differ much, or else their number."""
    least, largest = float(np.nanmin(z)), float(np.nanmax(z))
    if not (least > 0 and largest > WIDE * least):
        return LEVELS
    decades = range(math.floor(math.log10(least)), math.ceil(math.log10(largest)) + 1)
    numbers = [factor * 10.0**decade for decade in decades for factor in (1, 2, 5)]
    return [number for number in numbers if least <= number <= largest]


def _plain(value: float) -> str:
    return f"{value:.3g}"


def _plain_ticks(axes: Axes) -> None:
    """Label the ticks of logarithmic axes with plain numbers: 1, 2, 3, 5, 10, ..."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    for axis, scale in ((axes.xaxis, axes.get_xscale()), (axes.yaxis, axes.get_yscale())):
        if scale == "log":
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 3.0, 5.0)))
            axis.set_major_formatter(FuncFormatter(lambda x, _: _plain(x)))
            axis.set_minor_locator(NullLocator())


def _mark(axes: Axes, x: Vector, y: Vector, z: Vector) -> None:
    """Draw circles around the smallest and the largest value, with their numbers."""
    from matplotlib.patheffects import withStroke

    for index, text in ((int(np.nanargmin(z)), "least"), (int(np.nanargmax(z)), "largest")):
        axes.plot(
            x[index],
            y[index],
            "o",
            markersize=9,
            markerfacecolor="none",
            markeredgecolor="white",
            clip_on=False,
            path_effects=[withStroke(linewidth=2.5, foreground=SHADE)],
        )
        at_left = x[index] < np.median(x)
        above = y[index] < np.median(y)
        axes.annotate(
            f"{text} {z[index]:.4g}", (x[index], y[index]), xytext=(8 if at_left else -8, 8 if above else -8),
            textcoords="offset points", ha="left" if at_left else "right", va="bottom" if above else "top",
            color="white", fontweight="bold", zorder=10,
            bbox={"facecolor": SHADE, "alpha": 0.85, "edgecolor": "none", "pad": 1.5},
        )  # fmt: skip


def _cells(result: SweepResult, output: SweepOutput) -> tuple[Vector, Vector, Vector]:
    """The axes (m,), (n,) of a grid in increasing order, and the values (n, m)."""
    samples, names = result.samples, result.samples.varying
    values = result[output.label].squeeze()
    first, second = (samples.axis(name) for name in names)
    by_first, by_second = np.argsort(first), np.argsort(second)
    return first[by_first], second[by_second], values[np.ix_(by_first, by_second)].T
