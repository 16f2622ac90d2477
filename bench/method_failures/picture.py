"""The picture of where methods fail: three panels, each with the failure that it shows and its remedy."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from bench.method_failures.small_cases import SmallCases
from bench.method_failures.small_scenes import Driven
from derive.study.methods.methods_chart import BLUE, BROWN, GREEN, ORANGE, PURPLE, MethodPanel, logarithmic, panels_svg
from derive.visual import chart_style as style


def failures_svg(cases: SmallCases) -> str:
    """The text of the picture. The same numbers give the same bytes."""
    panels = (
        MethodPanel("Multipliers ring", "unless rho < 1 (rigid crank-slider, index 3)", lambda a: _ringing(a, cases)),
        MethodPanel(
            "Dead centres: G loses rank",
            "smallest singular value, rigid crank-slider",
            lambda a: _dead_centres(a, cases),
        ),
        MethodPanel(
            "Monomials lose all digits", "Legendre polynomials (mean frame) do not", lambda a: _bases(a, cases)
        ),
    )
    return panels_svg("Where methods fail, and what avoids it", panels)


def _ringing(axes: Axes, cases: SmallCases) -> None:
    for run, colour in zip(cases.ringing, (BROWN, ORANGE, GREEN, BLUE), strict=False):
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
    logarithmic(axes)
    axes.set_ylim(1e-8, 10)
    axes.set_xlabel("step")
    axes.set_ylabel("alternating part / multipliers")


def _dead_centres(axes: Axes, cases: SmallCases) -> None:
    colours = {(Driven.CRANK, 2.0): GREEN, (Driven.CRANK, 1.0): PURPLE, (Driven.SLIDER, 2.0): ORANGE}
    names = {
        (Driven.CRANK, 2.0): "crank driven, rod longer",
        (Driven.CRANK, 1.0): "crank driven, rod as long as the crank",
        (Driven.SLIDER, 2.0): "slider driven",
    }
    for case in cases.dead_centres:
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


def _bases(axes: Axes, cases: SmallCases) -> None:
    n = [b.count for b in cases.bases]
    axes.plot(n, [b.monomials for b in cases.bases], color=ORANGE, marker="s", markersize=3.5)
    axes.plot(n, [b.legendre for b in cases.bases], color=BLUE, marker="o", markersize=3.5)
    axes.axhline(2.0**53, color=style.INK, linewidth=0.7, dashes=(2, 2))
    axes.text(2, 2.0**53 * 2, "all digits of a double", va="bottom")
    axes.text(n[-1], 60, "Legendre", color=BLUE, ha="right")
    axes.text(11, 1e10, "monomials", color=ORANGE, ha="right")
    logarithmic(axes)
    axes.set_ylim(0.5, 1e19)
    axes.set_xticks([2, 5, 10, 15, 20])
    axes.set_xlabel("number of shapes N")
    axes.set_ylabel("cond(c8)")
