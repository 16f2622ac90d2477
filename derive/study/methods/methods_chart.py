"""The picture of a study of methods: a panel for each failure that it shows, with its remedy."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from derive.study.methods.method_study import MethodStudy
from derive.study.methods.scene_methods import Method
from derive.study.methods.step_limits import GROWTH
from derive.visual import chart_style as style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PANEL_WIDTH, PANEL_HEIGHT, COLUMNS = 3.0, 2.48, 3
"""The size of a panel, inches, and the largest number of panels in a row."""
LEFT, RIGHT, GAP, HEAD, FOOT, ABOVE = 0.62, 0.12, 0.72, 0.3, 0.55, 0.62
"""Margins, the gap between columns, and the height above each row of panels for its title, inches."""
EMPTY = 36
"""The number of characters of a line of an empty panel."""
FLOOR, FAILED = 1e-17, 1e-3
"""The value that stands for zero on logarithmic axes; the error of failed runs above which a label has room."""
BESIDE = 4.0
"""The place of the names of implicit methods, between the limits of rk4 and of the adaptive integrator, ω_max h."""
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
ORANGE, PURPLE, BLUE, PINK, GREEN, BROWN = style.COLOURS
METHODS = {
    Method.RK4: ORANGE,
    Method.ADAPTIVE: BLUE,
    Method.RK45: PINK,
    Method.GENERALISED_ALPHA: GREEN,
    Method.TRAPEZOIDAL: BROWN,
}
"""The colours of methods."""


@dataclass(frozen=True)
class MethodPanel:
    """A panel of the picture: its title, the text below that, and the function that draws it."""

    title: str
    text: str
    draw: Callable[[Axes], None]


def methods_svg(study: MethodStudy) -> str:
    """The text of the picture. The same numbers give the same bytes."""
    constrained = bool(study.conditioning.weakest)
    limits = MethodPanel("Explicit steps have a limit", "implicit ones do not", lambda axes: _growth(axes, study))
    text = "less the work of the drives, over the kinetic energy"
    energy = MethodPanel("Energy is kept, or not", text, lambda axes: _energy(axes, study, legend=not constrained))
    drift = MethodPanel("Constraints drift", "unless each step is projected", lambda axes: _position(axes, study))
    text = "smallest singular value, 0 at a dead centre"
    rank = MethodPanel("The rank of G along the motion", text, lambda axes: _singular(axes, study))
    panels = [*([limits] if study.limits else []), *([drift, energy, rank] if constrained else [energy])]
    return panels_svg(f"{study.name}: where methods fail, and what avoids it", panels)


def panels_svg(title: str, panels: Sequence[MethodPanel]) -> str:
    """The text of a picture of panels, as many of them in each row as in the others or one less."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    rows = -(-len(panels) // COLUMNS)
    columns = max(2, -(-len(panels) // rows))  # the title needs the width of two
    width = LEFT + RIGHT + columns * PANEL_WIDTH + (columns - 1) * GAP
    height = HEAD + rows * (ABOVE + PANEL_HEIGHT + FOOT)
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update({**style.SETTINGS, "font.size": 8.5})
        figure = Figure(figsize=(width, height))
        for number, panel in enumerate(panels):
            row, column = divmod(number, columns)
            x = LEFT + column * (PANEL_WIDTH + GAP)
            top = height - HEAD - row * (ABOVE + PANEL_HEIGHT + FOOT)
            at = (x / width, (top - ABOVE - PANEL_HEIGHT) / height, PANEL_WIDTH / width, PANEL_HEIGHT / height)
            axes = figure.add_axes(at)
            axes.tick_params(length=3)
            panel.draw(axes)
            y = (top - ABOVE + 0.34) / height
            figure.text(x / width, y, panel.title, fontweight="bold", fontsize=9.5)
            figure.text(x / width, y - 0.19 / height, panel.text, fontsize=8.5)
        figure.text(LEFT / width, 1 - 0.12 / height, title, va="top", fontweight="bold", fontsize=11)
        return style.figure_svg(figure, title)


def _growth(axes: Axes, study: MethodStudy) -> None:
    y = np.linspace(0.02, 7.5, 400)
    shown = [Method.RK4, Method.ADAPTIVE, Method.GENERALISED_ALPHA, Method.TRAPEZOIDAL]
    for method in shown:
        growth = GROWTH[method]()
        values = np.array([growth(float(v)) for v in y])
        axes.plot(y, np.where(values < 1.9, values, np.nan), color=METHODS[method], linewidth=1.6)
    axes.axhline(1, color=style.INK, linewidth=0.7, dashes=(2, 2))
    labels = ((Method.RK4, 3.22, 1.62, "left"), (Method.ADAPTIVE, 6.1, 1.62, "right"))
    for method, x, at, side in labels:
        axes.text(x, at, method.value, color=METHODS[method], ha=side)
    axes.text(BESIDE, 1.025, Method.TRAPEZOIDAL.value, color=BROWN, ha="center")
    axes.text(BESIDE, 0.93, Method.GENERALISED_ALPHA.value, color=GREEN, ha="center", va="top")
    bounded = [line for line in study.limits if np.isfinite(line.theory)]
    for line in bounded:
        at = line.measured * study.frequency.largest
        axes.plot([at], [1], marker="o", markersize=6, color=METHODS[line.method], markeredgecolor=style.INK)
        axes.text(at - 0.1, 1.05, f"{at:.2f}", ha="right", fontweight="bold")
    axes.set_ylim(0.55, 1.75)
    axes.set_xlim(0, 7.5)
    axes.set_xlabel("ω_max h (dots: experiment on this scene)")
    axes.set_ylabel("growth of a vibration per step")


def _position(axes: Axes, study: MethodStudy) -> None:
    _over_time(axes, study, lambda run: run.position, FLOOR)
    _legend(axes)
    axes.set_ylabel("largest |g|, m")


def _legend(axes: Axes) -> None:
    """Name the curves above them."""
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (high / low) ** 0.75)
    axes.legend(loc="upper left", fontsize=7.5, handlelength=2.6, labelspacing=0.15, borderaxespad=0.1)


def _energy(axes: Axes, study: MethodStudy, legend: bool) -> None:
    _over_time(axes, study, lambda run: run.energy, FLOOR)
    if legend and axes.lines:
        _legend(axes)
    if not axes.lines:
        text = "\n".join(textwrap.wrap(study.missing_energies, EMPTY))
        axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center")
        axes.tick_params(which="both", left=False, labelleft=False, bottom=False, labelbottom=False)
        axes.set_xlabel("")
        axes.grid(visible=False)


def _over_time(axes: Axes, study: MethodStudy, of: Callable[[Any], Any], floor: float) -> None:
    for run in study.drifts:
        values = of(run)
        if not len(values):
            continue
        dashes: Any = (None, None) if run.projected else (4, 1.5)
        axes.plot(
            run.t, np.maximum(values, floor), color=METHODS[run.method], linewidth=1.6, dashes=dashes, label=run.label
        )
        if run.failure:
            colour = METHODS[run.method]
            axes.plot(run.t[-1:], values[-1:], marker="x", markersize=7, markeredgewidth=2, color=colour)
            if values[-1] > FAILED:
                text = f"{run.method.value} fails"
                axes.text(run.t[-1] * 0.75, values[-1], text, color=colour, ha="right", va="center")
    axes.set_xscale("log")
    _powers(axes.xaxis)
    logarithmic(axes)
    axes.set_xlim(left=study.h * max(1, study.steps // 5000))
    axes.set_xlabel(f"time, s ({study.steps} steps)")


def logarithmic(axes: Axes) -> None:
    """Make the axis of ordinates logarithmic."""
    axes.set_yscale("log")
    _powers(axes.yaxis)


def _powers(axis: Any) -> None:
    """Label ticks at powers of ten as text, without the mathematics of matplotlib."""
    axis.set_major_formatter(lambda value, _: f"10{str(round(np.log10(value))).translate(SUPERSCRIPTS)}")
    axis.set_minor_formatter("")


def _singular(axes: Axes, study: MethodStudy) -> None:
    c = study.conditioning
    axes.plot(c.t, c.singular, color=GREEN, linewidth=1.6)
    axes.set_ylim(0, 1.3 * float(c.singular.max()) or 1.0)
    axes.set_xlabel("time, s")
