"""The picture of the stability of models: the stable ranges of each, and below them frequencies and growth rates."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from derive.percentages import percent
from derive.study.accuracy.chart_labels import COLOURS, ORDER_NAMES, colour
from derive.study.accuracy.ladder_model import Shapes
from derive.study.stability.ladder_stability import LadderStability, distance
from derive.study.stability.model_path import ModelPath
from derive.study.stability.table import loss_text, truth_sentences, verdict_text
from derive.study.stability.thresholds import Interval
from derive.visual import chart_style as style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, LEFT, RIGHT = 10.4, 2.75, 1.95
"""The picture and the margins with the names and the numbers of the models, in inches."""
ROW, FREQUENCIES, GROWTH, GAP, HEAD, FOOT = 0.25, 2.1, 1.5, 0.16, 1.12, 0.5
"""The heights of the row of a model, of both charts, and of the margins, in inches."""
SHOWN = 2
"""The number of frequencies of each model that are drawn, from the lowest on."""
STABLE, UNSTABLE, WRONG_STABLE, WRONG_UNSTABLE = style.LIGHT, "#5b6670", "#f0a8a0", "#c0271c"
SOLID, OTHER_FRAME, SEVERAL = (None, None), (2.0, 1.4), (6.0, 2.0)
Dashes = tuple[None, None] | tuple[float, float]
LANE = 165
"""The number of characters of a line of the head."""


def stability_svg(of: LadderStability) -> str:
    """The text of the picture; bars and lines have titles. The same numbers give the same bytes."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(style.SETTINGS)
        paths = drawn(of)
        bars = ROW * (len(paths) + 1)
        height = HEAD + bars + FREQUENCIES + GROWTH + 2 * GAP + FOOT
        figure = Figure(figsize=(WIDTH, height))

        def panel(top: float, size: float) -> Axes:
            place = LEFT / WIDTH, (height - top - size) / height, (WIDTH - LEFT - RIGHT) / WIDTH, size / height
            axes = figure.add_axes(place)
            axes.set_xlim(of.range.low, of.range.high)
            axes.tick_params(length=3)
            return axes

        titles: dict[str, str] = {}
        first = panel(HEAD, bars)
        _bars(first, of, paths, titles)
        second = panel(HEAD + bars + GAP, FREQUENCIES)
        third = panel(HEAD + bars + FREQUENCIES + 2 * GAP, GROWTH)
        _lines(second, third, of, paths, titles)
        for axes in (first, second):
            axes.tick_params(labelbottom=False)
        third.set_xlabel(f"{of.range.name}{f', {of.unit}' if of.unit else ''}")
        for axes in (second, third):
            if of.true_loss is not None:
                axes.axvline(of.true_loss, color=style.INK, linewidth=0.8, dashes=(3, 2))
        figure.align_ylabels([second, third])
        _head(figure, of, height)
        return style.titled(style.figure_svg(figure, _description(of)), titles)


def drawn(of: LadderStability) -> tuple[ModelPath, ...]:
    """The models that have points, the reference at the end."""
    every = (*(path for path in of.paths if path is not of.reference), of.reference)
    return tuple(path for path in every if not path.failure)


def _bars(axes: Axes, of: LadderStability, paths: Sequence[ModelPath], titles: dict[str, str]) -> None:
    """Draw a bar for the truth and for each model, with its stable, its unstable and its wrong parts."""
    axes.grid(visible=False)
    axes.set_ylim(len(paths) + 0.5, -0.5)
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(False)
    label = "truth: given" if of.known else "truth: the richest model" if of.converged else "undecided: the richest"
    _row(axes, 0, of.truth, ())
    known = "not lost" if of.true_loss is None else f"{of.true_loss:.7g}"
    _names(axes, 0, label, known, style.INK, bold=True)
    for n, path in enumerate(paths, 1):
        wrong = of.wrong(path)
        titles |= dict.fromkeys(_row(axes, n, path.intervals, wrong), bar_title(path, wrong))
        near = distance(path.loss, of.true_loss)
        number = loss_text(path) + (f"  ({percent(near, signed=True)})" if near is not None else "")
        _names(axes, n, path.model.label, number, colour(path.model))
    if of.true_loss is not None:
        axes.axvline(of.true_loss, color=style.INK, linewidth=0.8, dashes=(3, 2))


def _row(axes: Axes, y: int, known: Sequence[Interval], wrong: Sequence[Interval]) -> list[str]:
    """Draw a bar, with the verdict in wrong parts if there is room; returns the identifiers of its parts."""
    coloured = [(i, STABLE if i.stable else UNSTABLE) for i in known if i.stable is not None]
    coloured += [(i, WRONG_STABLE if i.stable else WRONG_UNSTABLE) for i in wrong]
    low, high = axes.get_xlim()
    inch = (WIDTH - LEFT - RIGHT) / (high - low)
    for number, (part, fill) in enumerate(coloured):
        (bar,) = axes.barh(y, part.high - part.low, left=part.low, height=0.72, color=fill, linewidth=0)
        bar.set_gid(f"bar_{y}_{number}")
        if number >= len(coloured) - len(wrong) and inch * (part.high - part.low) > 1.25:
            text, ink = ("wrong: stable", "#5a1009") if part.stable else ("wrong: unstable", "#ffffff")
            middle = (part.low + part.high) / 2
            axes.text(middle, y, text, ha="center", va="center", fontsize=7.5, color=ink)
    return [f"bar_{y}_{number}" for number in range(len(coloured))]


def _names(axes: Axes, y: int, label: str, number: str, ink: str, bold: bool = False) -> None:
    """Draw the name of a row on its left, and the value at which stability is lost on its right."""
    shown: dict[str, Any] = {"va": "center", "fontsize": 8.5, "color": ink, "transform": axes.get_yaxis_transform()}
    shown |= {"fontweight": "bold"} if bold else {}
    axes.text(-0.015, y, label, ha="right", **shown)
    axes.text(1.015, y, number, ha="left", **shown)


def _lines(
    frequencies: Axes, growth: Axes, of: LadderStability, paths: Sequence[ModelPath], titles: dict[str, str]
) -> None:
    """Draw the lowest frequencies and the largest growth rates, the reference as a broad line behind the others."""
    frequencies.set_ylabel("two lowest\nfrequencies, rad/s")
    growth.set_ylabel("growth rate,\n1/s")
    top = 0.0
    for n, path in reversed(list(enumerate(paths, 1))):
        look: dict[str, Any] = {"color": colour(path.model), "linewidth": 1.4, "dashes": _dashes(path)}
        if path is of.reference:
            look = {"color": style.REFERENCE, "linewidth": 5, "alpha": 0.55, "solid_capstyle": "butt"}
        for k in range(SHOWN):
            x, y = frequency_line(path, k)
            frequencies.plot(x, y, gid=f"frequency_{n}_{k}", **look)
            titles[f"frequency_{n}_{k}"] = path.model.label
            top = max(top, *y, 0.0) if path is of.reference or not top else top
        x, y = growth_line(path)
        growth.plot(x, y, gid=f"growth_{n}", **look)
        titles[f"growth_{n}"] = path.model.label
    frequencies.set_ylim(0, 1.15 * top or 1)
    growth.set_ylim(0, growth.get_ylim()[1] if any(path.thresholds for path in paths) else 1)
    _legend(frequencies, of, paths)


def _dashes(path: ModelPath) -> Dashes:
    """The dashes of a model: a solid line for one beam in the mean frame, dashes for others."""
    if path.model.pieces > 1:
        return SEVERAL
    return SOLID if path.model.frame == "mean" else OTHER_FRAME


def _legend(axes: Axes, of: LadderStability, paths: Sequence[ModelPath]) -> None:
    """Draw the legend of colours and dashes, to the right of the frequencies."""
    from matplotlib.lines import Line2D

    broad = Line2D([], [], color=style.REFERENCE, linewidth=5, alpha=0.55, label="the richest model")
    colours = dict.fromkeys(path.model.order for path in paths if path.model.shapes is not Shapes.RIGID)
    handles = [broad, *(Line2D([], [], color=COLOURS[o], linewidth=1.4, label=ORDER_NAMES[o]) for o in colours)]
    names = {SOLID: "one beam, mean frame", OTHER_FRAME: "one beam, another frame", SEVERAL: "several beams"}
    for dashes in dict.fromkeys(_dashes(path) for path in paths if path is not of.reference):
        handles.append(Line2D([], [], color=style.FAINT, linewidth=1.4, dashes=dashes, label=names[dashes]))
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.0, 1.03), fontsize=7.5, handlelength=2.4)


def frequency_line(path: ModelPath, k: int) -> tuple[list[float], list[float]]:
    """The curve of the frequency with number k at the first value, from 0 for the lowest, until its mode diverges.

    In rotating axes frequencies may also pass zero, and modes that are damped too much may begin to vibrate.
    """
    known = [(p.value, p.eigenvalues) for p in path.points if p.eigenvalues is not None]
    first = known[0][1].diverging
    numbered = [(x, of.frequencies, k + first - of.diverging) for x, of in known]
    rows = [(x, float(f[n])) for x, f, n in numbered if 0 <= n < len(f)]
    return [x for x, _ in rows], [y for _, y in rows]


def growth_line(path: ModelPath) -> tuple[list[float], list[float]]:
    """The largest growth rate over the parameter, 0 at the thresholds of stability."""
    known = [(p.value, p.eigenvalues.growth if p.eigenvalues is not None else np.nan) for p in path.points]
    known += [(c.value, 0.0) for c in path.thresholds if not (c.before and c.after)]
    x, y = zip(*sorted(known), strict=True)
    return list(x), list(y)


def bar_title(path: ModelPath, wrong: Sequence[Interval]) -> str:
    """The text of a bar."""
    changes = [f"{c.before} -> {c.after} growing modes at {c.value:.7g}" for c in path.thresholds]
    verdicts = [f"wrong: {verdict_text(interval)}" for interval in wrong]
    return "\n".join([f"{path.model.label}, {path.coordinates} coordinates", *changes, *verdicts])


def _head(figure: Figure, of: LadderStability, height: float) -> None:
    title = f"{of.name}: which models are stable?"
    figure.text(0.12 / WIDTH, 1 - 0.1 / height, title, va="top", fontweight="bold", fontsize=11)
    text = textwrap.wrap("; ".join([_wrong_count(of), *truth_sentences(of)]), LANE)[:2]
    figure.text(0.12 / WIDTH, 1 - 0.36 / height, "\n".join(text), va="top", fontsize=8.5)
    x = 0.12
    for ink, name in (
        (STABLE, "stable"),
        (UNSTABLE, "unstable"),
        (WRONG_STABLE, "wrong: stable, the truth is not"),
        (WRONG_UNSTABLE, "wrong: unstable, the truth is stable"),
    ):
        figure.text(x / WIDTH, 1 - 0.78 / height, "■", va="top", fontsize=10, color=ink)
        figure.text((x + 0.17) / WIDTH, 1 - 0.79 / height, name, va="top", fontsize=8.5, color=style.INK)
        x += 0.42 + 0.062 * len(name)
    right = (WIDTH - RIGHT + 0.08) / WIDTH
    figure.text(right, 1 - 0.98 / height, "stability lost at", va="top", fontsize=8.5, color=style.INK)


def _description(of: LadderStability) -> str:
    """The description of the picture in a sentence."""
    return f"{of.name}: stability of {len(of.paths)} models over {of.range.name}; {_wrong_count(of)}"


def _wrong_count(of: LadderStability) -> str:
    if not of.converged:
        return f"all verdicts on {len(of.paths)} models are undecided"
    wrong = sum(bool(of.wrong(path)) for path in of.paths)
    return f"{wrong} of {len(of.paths)} models are wrong somewhere"
