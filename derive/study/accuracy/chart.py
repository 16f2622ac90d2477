"""The chart of a ladder: error over CPU time and over operations, a line for each model. A work-precision diagram."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

from derive.percentages import percent
from derive.study.accuracy.chart_labels import colour, colour_names, duration, group_label, label_groups, spread
from derive.study.accuracy.doubts import doubt, doubt_lines
from derive.study.accuracy.headline import candidates, front, headline_texts
from derive.study.accuracy.ladder_chart import LadderChart
from derive.study.accuracy.ladder_model import COMPONENT_MODES, FAMILIES, LadderModel, Shapes
from derive.study.accuracy.measurement import Line, Point
from derive.visual import chart_style as style
from derive.visual.text_metrics import wrapped

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, PANEL, HEIGHT, LEFT, GAP, MARGIN = 11.2, 3.55, 4.3, 0.78, 0.2, 2.95
"""The picture, its two panels, and the margins to their left, between them and to their right, in inches."""
LABEL = 0.165
"""The least distance of labels, in inches."""
LABELLED = 1.7
"""The powers of ten on an axis below which ticks between them have labels as well."""
ROW, EDGE = 0.19, 0.4
"""The height of a line of the head, and the margin to its right, in inches."""
SMALL, POINTS = 8.5, 72
"""The size of the text of the head, in points, and the points of an inch."""
DASHES: dict[str, tuple[float | None, ...]] = {
    "adaptive": (None, None),
    "rk4": (1, 1),
    "generalised-alpha": (6, 1.5, 1, 1.5),
}
"""The dashes of lines by their integrators."""
FAR = 10.0
"""The largest error on the axis: of a motion that grows without bounds it would be 1e12."""
KNOWN = 100.0
"""The error of the reference over the least error on the axis."""
SIGNS = {
    "x": "x rigid",
    "o": "● natural modes",
    "s": "■ one beam",
    "^": "▲ several beams",
    "v": "▼ finite elements",
}
"""The texts of markers."""
DASH_NAMES = {"rk4": "dotted", "generalised-alpha": "dash-dotted"}


def accuracy_svg(chart: LadderChart, alone: bool = True) -> str:
    """The text of the chart, whose points and lines have titles. The same numbers give the same bytes.

    alone: with the title, the headline and the doubts, which a page around the chart shows itself.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    lane = _wrapped(doubt_lines(chart.lines, chart.shown, drawn=True), 8) if alone else []
    above = _title(chart) if alone else []
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(style.SETTINGS)
        head = 0.68 + ROW * (len(above) + len(_subtitle(chart))) + (0.07 if alone else 0)
        foot = 0.62 + 0.17 * len(lane)
        height = head + HEIGHT + foot
        figure = Figure(figsize=(WIDTH, height))

        def panel(number: int) -> Axes:
            place = (LEFT + number * (PANEL + GAP)) / WIDTH, foot / height, PANEL / WIDTH, HEIGHT / height
            return figure.add_axes(place)

        costs: tuple[tuple[str, Callable[[Point], float]], ...] = (
            ("CPU time of the integration in C, ms", lambda p: 1e3 * p.seconds[0]),
            ("arithmetic operations of all evaluations", lambda p: float(p.operations)),
        )
        titles: dict[str, str] = {}
        for number, (label, cost) in enumerate(costs):
            axes = panel(number)
            _panel(axes, chart, cost, number, titles)
            axes.set_xlabel(label)
            if number:
                axes.tick_params(labelleft=False)
            else:
                axes.set_ylabel("error, rms of the peak")
        _labels(figure, chart, foot, height)
        _head(figure, chart, above, height)
        for k, text in enumerate(lane):
            figure.text(LEFT / WIDTH, (0.17 * (len(lane) - k) - 0.05) / height, text, fontsize=8, color=style.INK)
        return style.titled(style.figure_svg(figure, _description(chart)), titles)


def _panel(axes: Axes, chart: LadderChart, cost: Callable[[Point], float], number: int, titles: dict[str, str]) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    good = front([run for run in candidates(chart.lines) if cost(run.point) > 0], cost)
    useful = {id(run.line) for run in good}
    low, high = _range(chart)

    def errors(points: Iterable[Point]) -> list[float]:
        return [min(max(point.rms, low), FAR) for point in points]

    for n, line in enumerate(chart.drawn):
        shown = [p for p in line.points if cost(p) > 0]
        if not shown:
            continue
        pale = id(line) not in useful
        look: dict[str, Any] = {"color": colour(line.model), "linewidth": 1.1 if pale else 1.9}
        look |= {"alpha": 0.5 if pale else 1, "marker": _marker(line.model), "markersize": 3.5 if pale else 5}
        look |= {} if line.valid and not line.noted else {"fillstyle": "none"}
        x, y = [cost(p) for p in shown], errors(shown)
        dashes = DASHES[line.integrator] if line.valid else (3, 2)
        axes.plot(x, y, gid=f"line_{number}_{n}", dashes=dashes, **look)
        titles[f"line_{number}_{n}"] = line_title(line, chart.shown)
    if number == 0:
        _peers(axes, chart, titles)
    if good:
        x, y = [cost(r.point) for r in good], errors(r.point for r in good)
        axes.step(x, y, where="post", color=style.INK, linewidth=0.8, alpha=0.6)
    for run, width in ((chart.headline.recommended, 1.6), (chart.headline.cheaper, 0.7)):
        if run is not None:
            ring: dict[str, Any] = {"marker": "o", "markersize": 13, "fillstyle": "none", "markeredgewidth": width}
            axes.plot([cost(run.point)], errors([run.point]), color=style.INK, linestyle="none", **ring)
    axes.set_ylim(low, high)
    axes.yaxis.set_major_formatter(lambda value, _: percent(value))
    axes.xaxis.set_major_formatter(lambda value, _: _power(value))
    axes.yaxis.set_minor_formatter("")
    axes.xaxis.set_minor_formatter(_between if _decades(axes) < LABELLED else "")
    axes.tick_params(length=3, which="both")
    axes.axhline(chart.error, color=style.INK, linewidth=0.7, dashes=(1, 2))
    if chart.reference.error:
        axes.axhspan(low, chart.reference.error, color=style.LIGHT, alpha=0.5, linewidth=0)


def _peers(axes: Axes, chart: LadderChart, titles: dict[str, str]) -> None:
    """Draw the runs of other programs, of which the time alone is known."""
    for n, peer in enumerate(chart.peers):
        look: dict[str, Any] = {"color": style.INK, "marker": "D", "markersize": 4.5, "linewidth": 1.3}
        x, y = [1e3 * seconds for seconds, _, _ in peer.runs], [rms for _, rms, _ in peer.runs]
        axes.plot(x, y, gid=f"peer_{n}", **look)
        titles[f"peer_{n}"] = "\n".join([peer.name, *(peer_text(run) for run in peer.runs)])


def peer_text(run: tuple[float, float, float]) -> str:
    """The text of a run of another program."""
    seconds, rms, largest = run
    return f"rms {percent(rms)}, largest {percent(largest)}, {duration(seconds)}"


def _decades(axes: Axes) -> float:
    """The powers of ten that the horizontal axis covers."""
    low, high = axes.get_xlim()
    return math.log10(high / low)


def _between(value: float, _: object = None) -> str:
    """The text of 2 and 5 times a power of ten, where an axis has hardly any powers: 0.2, 5, 2·10⁵; else empty."""
    exponent = math.floor(math.log10(value) + 1e-9)
    mantissa = round(value / 10.0**exponent)
    if mantissa not in (2, 5):
        return ""
    return f"{value:g}" if -3 <= exponent < 4 else f"{mantissa}·{_power(10.0**exponent)}"


def _power(value: float) -> str:
    """The text of a power of ten: 0.1, 1, 10, and 10⁵ beyond."""
    exponent = round(math.log10(value))
    raised = str(exponent).translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"{value:g}" if -4 < exponent < 4 else f"10{raised}"


def _range(chart: LadderChart) -> tuple[float, float]:
    """The ends of the logarithmic axis of errors, at which smaller and larger ones are drawn.

    The errors of the model that is the reference are those of rounding, which would take most of the axis.
    """
    errors = [p.rms for line in chart.drawn for p in line.points if p.rms > 0]
    errors += [rms for peer in chart.peers for _, rms, _ in peer.runs]
    known = [*errors, chart.error, *([chart.reference.error] if chart.reference.error else [])]
    return max(min(known), (chart.reference.error or 0.0) / KNOWN) / 1.6, min(max(known), FAR) * 1.6


def _marker(model: LadderModel) -> str:
    if model.shapes is Shapes.RIGID:
        return "x"
    if model.shapes in FAMILIES:
        return "o"
    if model.shapes in COMPONENT_MODES:
        return "v"
    return "s" if model.pieces == 1 else "^"


def _labels(figure: Figure, chart: LadderChart, foot: float, height: float) -> None:
    """Draw the names of the lines right of the panels, at their smallest errors, with leaders where they are moved."""
    from matplotlib.lines import Line2D

    low, high = (math.log(x) for x in _range(chart))
    labels = [(group[0].best, group_label(group), colour(group[0].model)) for group in label_groups(chart.drawn)]
    labels = sorted([*labels, *((peer.best, peer.name, style.INK) for peer in chart.peers)])
    logarithms = [max(low, math.log(min(best, FAR))) if best else low for best, _, _ in labels]
    wanted = [HEIGHT * (logarithm - low) / (high - low) for logarithm in logarithms]
    places = spread(wanted, LABEL)
    edge = LEFT + 2 * PANEL + GAP
    for (best, text, tint), want, at in zip(labels, wanted, places, strict=True):
        y, y0 = (foot + at) / height, (foot + want) / height
        leader: dict[str, Any] = {"color": style.FAINT, "linewidth": 0.6}
        figure.add_artist(Line2D([(edge + 0.02) / WIDTH, (edge + 0.2) / WIDTH], [y0, y], **leader))
        figure.text((edge + 0.24) / WIDTH, y, f"{percent(best)}  {text}", va="center", fontsize=8, color=tint)


def _title(chart: LadderChart) -> list[tuple[str, bool]]:
    """The title and the headline in lines, and whether each is bold."""
    result = [(f"{chart.name}: what accuracy costs", True)]
    for title, text in headline_texts(chart.headline, chart.shown):
        result += [(line, False) for line in _wrapped([f"{title}: {text}"], SMALL)]
    return result


def _head(figure: Figure, chart: LadderChart, above: Sequence[tuple[str, bool]], height: float) -> None:
    y = 0.1

    def write(text: str, x: float = LEFT, **look: Any) -> None:
        figure.text(x / WIDTH, 1 - y / height, text, **{"va": "top", "fontsize": SMALL, **look})

    for text, bold in above:
        write(text, fontweight="bold" if bold else "normal", fontsize=11 if bold else SMALL)
        y += ROW + (0.07 if bold else 0)
    for text in _subtitle(chart):
        write(text, color=style.FAINT)
        y += ROW
    x = LEFT
    for name, tint in colour_names([line.model for line in chart.drawn]).items():
        write(f"■ {name}", x, color=tint)
        x += 0.3 + 0.072 * len(name)
    y += ROW
    drawn = {_marker(line.model) for line in chart.drawn}
    signs = "  ".join(text for marker, text in SIGNS.items() if marker in drawn)
    signs += "; stairs: no cheaper run is better"
    signs += "; hollow: in doubt" if any(line.noted or not line.valid for line in chart.drawn) else ""
    signs += "  ◆ other programs" if chart.peers else ""
    names = dict.fromkeys(line.integrator for line in chart.drawn if line.integrator != "adaptive")
    signs += "".join(f"; {DASH_NAMES[name]}: {name}" for name in names)
    signs += "  ◯ recommended" if chart.headline.recommended else ""
    signs += "  ○ cheaper, with a warning" if chart.headline.cheaper else ""
    write(signs)


def _subtitle(chart: LadderChart) -> list[str]:
    """The lines of the subtitle: the compared plot, its reference and the machine."""
    text = f"{chart.reference.plots[0].name}, against {chart.reference.source}"
    if chart.reference.error:
        text += f" (grey: its own error, {percent(chart.reference.error)})"
    return _wrapped([f"{text}; {chart.machine}"], SMALL)


def _wrapped(texts: Sequence[str], size: float) -> list[str]:
    """Texts in lines of the width of the chart."""
    room = POINTS * (WIDTH - LEFT - EDGE)
    return [line for text in texts for line in wrapped(text, room, size)]


def line_title(line: Line, shown: Sequence[str]) -> str:
    """The text of a line: its model, and for each run its setting, the error and the cost."""
    runs = [
        f"{p.setting}: rms {percent(p.rms)}, largest {percent(p.worst)}, {duration(p.seconds[0])}, "
        f"{p.evaluations} evaluations"
        for p in line.points
    ]
    reasons = [doubt(line, shown), line.warning.warning if line.warning else ""]
    reasons += [*(of.note for of in line.missed), *line.spins.values()]
    return "\n".join([f"{line.label}, {line.coordinates} coordinates", *runs, *filter(None, reasons)])


def _description(chart: LadderChart) -> str:
    chosen = chart.headline.recommended
    best = f"; the cheapest at {percent(chart.error)} is {chosen.line.label}" if chosen else ""
    return f"{chart.name}: error over cost of {len(chart.drawn)} models{best}"
