"""The picture of a study of methods: six panels, each with the failure that it shows and its remedy."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from derive.study.methods.cases import Driven
from derive.study.methods.method_study import MethodStudy
from derive.study.methods.scene_methods import Method
from derive.study.methods.step_limits import GROWTH
from derive.visual import chart_style as style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH, HEIGHT, COLUMNS = 11.2, 7.6, 3
"""The size of the picture, inches, and the number of panels of a row."""
LEFT, RIGHT, GAP, HEAD, FOOT, ABOVE = 0.62, 0.12, 0.72, 0.3, 0.55, 0.62
"""Margins, the gap between columns, and the height above each row of panels for its title, inches."""
EMPTY = 36
"""The number of characters of a line of an empty panel."""
FLOOR, FAILED = 1e-17, 1e-3
"""The value that stands for zero on logarithmic axes; the error of failed runs above which a label has room."""
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

Drawing = Callable[["Axes", MethodStudy], None]


def methods_svg(study: MethodStudy) -> str:
    """The text of the picture. The same numbers give the same bytes."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    panels: tuple[tuple[str, str, Drawing], ...] = (
        ("Explicit steps have a limit", "implicit ones do not", _growth),
        ("Constraints drift", "unless each step is projected", _position),
        ("Energy is kept, or not", "less the work of the drives, over the kinetic energy", _energy),
        ("Multipliers ring", "unless rho < 1 (rigid crank-slider, index 3)", _ringing),
        ("Dead centres: G loses rank", "smallest singular value, rigid crank-slider", _dead_centres),
        ("Monomials lose all digits", "Legendre polynomials (mean frame) do not", _bases),
    )
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update({**style.SETTINGS, "font.size": 8.5})
        figure = Figure(figsize=(WIDTH, HEIGHT))
        rows = -(-len(panels) // COLUMNS)
        width = (WIDTH - LEFT - RIGHT - (COLUMNS - 1) * GAP) / COLUMNS
        height = (HEIGHT - HEAD - rows * (ABOVE + FOOT)) / rows
        for number, (title, text, draw) in enumerate(panels):
            row, column = divmod(number, COLUMNS)
            x = LEFT + column * (width + GAP)
            top = HEIGHT - HEAD - row * (ABOVE + height + FOOT)
            axes = figure.add_axes((x / WIDTH, (top - ABOVE - height) / HEIGHT, width / WIDTH, height / HEIGHT))
            axes.tick_params(length=3)
            draw(axes, study)
            y = (top - ABOVE + 0.34) / HEIGHT
            figure.text(x / WIDTH, y, title, fontweight="bold", fontsize=9.5)
            figure.text(x / WIDTH, y - 0.19 / HEIGHT, text, fontsize=8.5)
        title = f"{study.name}: where methods fail, and what avoids it"
        figure.text(LEFT / WIDTH, 1 - 0.12 / HEIGHT, title, va="top", fontweight="bold", fontsize=11)
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
    axes.text(4.4, 1.025, Method.TRAPEZOIDAL.value, color=BROWN, ha="center")
    axes.text(4.4, 0.93, Method.GENERALISED_ALPHA.value, color=GREEN, ha="center", va="top")
    found = [line for line in study.limits if np.isfinite(line.theory)]
    for line in found:
        at = line.measured * study.frequency.largest
        axes.plot([at], [1], marker="o", markersize=6, color=METHODS[line.method], markeredgecolor=style.INK)
        axes.text(at - 0.1, 1.05, f"{at:.2f}", ha="right", fontweight="bold")
    axes.set_ylim(0.55, 1.75)
    axes.set_xlim(0, 7.5)
    axes.set_xlabel("ω_max h (dots: experiment on this scene)")
    axes.set_ylabel("growth of a vibration per step")


def _position(axes: Axes, study: MethodStudy) -> None:
    _over_time(axes, study, lambda run: run.position, FLOOR)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (high / low) ** 0.75)
    axes.legend(loc="upper left", fontsize=7.5, handlelength=2.6, labelspacing=0.15, borderaxespad=0.1)
    axes.set_ylabel("largest |g|, m")


def _energy(axes: Axes, study: MethodStudy) -> None:
    _over_time(axes, study, lambda run: run.energy, FLOOR)
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
    _logarithmic(axes)
    axes.set_xlim(left=study.h * max(1, study.steps // 5000))
    axes.set_xlabel(f"time, s ({study.steps} steps)")


def _logarithmic(axes: Axes) -> None:
    axes.set_yscale("log")
    _powers(axes.yaxis)


def _powers(axis: Any) -> None:
    """Label ticks at powers of ten as text, without the mathematics of matplotlib."""
    axis.set_major_formatter(lambda value, _: f"10{str(round(np.log10(value))).translate(SUPERSCRIPTS)}")
    axis.set_minor_formatter("")


def _ringing(axes: Axes, study: MethodStudy) -> None:
    for run, colour in zip(study.ringing, (BROWN, ORANGE, GREEN, BLUE), strict=False):
        n = np.arange(1, len(run.amplitude) + 1)
        axes.plot(n, np.maximum(run.amplitude, 1e-11), color=colour, linewidth=1.6)
        above = run.amplitude > 1e-7
        at = int(np.flatnonzero(above)[-1]) if run.rho < 1 else 100
        name = "rho = 1 (trapezoidal)" if run.rho == 1 else f"{run.rho:g}"
        axes.text(
            n[at] + 2,
            max(run.amplitude[at] * (3 if run.rho == 1 else 1.4), 1e-11),
            name,
            color=colour,
            ha="center" if run.rho == 1 else "left",
        )
    _logarithmic(axes)
    axes.set_ylim(1e-8, 10)
    axes.set_xlabel("step")
    axes.set_ylabel("alternating part / multipliers")


def _dead_centres(axes: Axes, study: MethodStudy) -> None:
    colours = {(Driven.CRANK, 2.0): GREEN, (Driven.CRANK, 1.0): PURPLE, (Driven.SLIDER, 2.0): ORANGE}
    names = {
        (Driven.CRANK, 2.0): "crank driven, rod longer",
        (Driven.CRANK, 1.0): "crank driven, rod as long as the crank",
        (Driven.SLIDER, 2.0): "slider driven",
    }
    for case in study.dead_centres:
        key = case.driven, case.rod
        axes.plot(np.degrees(case.angles), case.singular, color=colours[key], linewidth=1.6, label=names[key])
        axes.plot(
            np.degrees(case.dead),
            [0.0] * len(case.dead),
            linestyle="none",
            marker="x",
            color=colours[key],
            markeredgewidth=2,
        )
    axes.set_xticks(range(0, 361, 90))
    axes.set_ylim(-0.04, axes.get_ylim()[1] * 1.45)
    axes.legend(loc="upper left", fontsize=7.5, labelspacing=0.2, borderaxespad=0.1)
    axes.set_xlabel("crank angle, deg (crosses: singular)")


def _bases(axes: Axes, study: MethodStudy) -> None:
    n = [b.count for b in study.bases]
    axes.plot(n, [b.monomials for b in study.bases], color=ORANGE, marker="s", markersize=3.5)
    axes.plot(n, [b.legendre for b in study.bases], color=BLUE, marker="o", markersize=3.5)
    axes.axhline(2.0**53, color=style.INK, linewidth=0.7, dashes=(2, 2))
    axes.text(2, 2.0**53 * 2, "all digits of a double", va="bottom")
    axes.text(n[-1], 60, "Legendre", color=BLUE, ha="right")
    axes.text(11, 1e10, "monomials", color=ORANGE, ha="right")
    _logarithmic(axes)
    axes.set_ylim(0.5, 1e19)
    axes.set_xticks([2, 5, 10, 15, 20])
    axes.set_xlabel("number of shapes N")
    axes.set_ylabel("cond(c8)")
