"""Line charts as SVG: curves, their reference, and the deviations from it. The same input gives the same bytes."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray

from derive.visual.axis_ticks import Ticks, ticks
from derive.visual.chart_style import BACKGROUND, FAINT, INK, LIGHT, REFERENCE, head

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

WIDTH, LEFT, RIGHT = 598, 80, 586
"""The width of the picture and the edges of the panels, in the units of the picture, those of a font size."""
HEIGHT, DEVIATIONS_HEIGHT, GAP, FOOT = 266, 108, 13, 40
"""Heights of the panel of the curves and of the deviations below it, the gap between them, and what is below them."""
FONT_SIZE, LETTER, LINE = 10, 6.2, 15
"""Size of the letters, the width that one may have, and the height of a line of the title or the legend."""
KEY, TICK, MARGIN = 30, 3, 0.05
"""Length of a line of the legend and of a tick; the part of its range that a panel is higher than its curves."""


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


@dataclass(frozen=True)
class Stroke:
    """How a curve is drawn."""

    colour: str
    width: float
    dashes: tuple[float, ...] = ()
    opacity: float = 1.0

    @property
    def style(self) -> str:
        """Its style in SVG; dashes are multiples of the width."""
        dashes = " ".join(_number(part * self.width) for part in self.dashes)
        faint = f"; stroke-opacity: {self.opacity:g}; stroke-linecap: round" if self.opacity < 1 else ""
        dashed = f"; stroke-dasharray: {dashes}" if dashes else ""
        return f"fill: none; stroke: {self.colour}; stroke-width: {self.width:g}{dashed}{faint}"


@dataclass(frozen=True, eq=False)
class Panel:
    """A panel from `top` with a height, its curves, and the ranges that it shows."""

    top: float
    height: float
    label: tuple[str, ...]
    curves: tuple[tuple[Curve, Stroke], ...]
    x: tuple[float, float]
    y: tuple[float, float]
    x_ticks: Ticks
    y_ticks: Ticks

    def across(self, x: Array) -> Array:
        """Positions of values from the left edge of the panel."""
        result: Array = (x - self.x[0]) / (self.x[1] - self.x[0]) * (RIGHT - LEFT)
        return result

    def down(self, y: Array) -> Array:
        """Positions of values from its upper edge."""
        result: Array = (self.y[1] - y) / (self.y[1] - self.y[0]) * self.height
        return result


def svg(chart: Chart) -> str:
    """The text of the picture."""
    title = textwrap.wrap(chart.title, TITLE_WIDTH)
    legend = _legend_entries(chart)
    columns = _columns(legend)
    above = 10 + LINE * len(title) + LINE * math.ceil(len(legend) / columns) + 8
    panels = _panels(chart, above)
    bottom = panels[-1].top + panels[-1].height
    height = bottom + FOOT
    label = ", ".join(part for part in (chart.x_label, chart.x_unit) if part)
    names = [curve.label for curve in (chart.reference, *chart.curves) if curve is not None]
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" role="img" viewBox="0 0 {WIDTH} {_number(height)}" '
            f'width="{WIDTH}pt" height="{_number(height)}pt">',
            head("; ".join([chart.title, *names])),
            f"  <g style=\"fill: {INK}; font: {FONT_SIZE}px system-ui, 'DejaVu Sans', sans-serif\">",
            f'    <path d="M 0 0 L {WIDTH} 0 L {WIDTH} {_number(height)} L 0 {_number(height)} z" '
            f'style="fill: {BACKGROUND}"/>',
            *(_text(LEFT, 18 + LINE * n, line, "font-weight: 700; font-size: 11px") for n, line in enumerate(title)),
            *_legend(legend, columns, 10 + LINE * len(title)),
            *(line for panel in panels for line in _drawn(panel, panel is panels[-1], _label_position(panels))),
            _text((LEFT + RIGHT) / 2, bottom + 31, label, "text-anchor: middle"),
            "  </g>",
            "</svg>\n",
        ]
    )


def _panels(chart: Chart, top: float) -> list[Panel]:
    x = _range(chart.curves)
    known = [] if chart.reference is None else [(chart.reference, Stroke(REFERENCE, 5, (), 0.55))]
    curves = *known, *((curve, _stroke(n, 1.6)) for n, curve in enumerate(chart.curves))
    panels = [_panel(chart, top, HEIGHT, (chart.y_label,), curves, x)]
    if chart.deviations:
        zero = Curve("", np.array(x), np.zeros(2)), Stroke(REFERENCE, 2, (), 0.55)
        curves = zero, *((curve, _stroke(n, 1.2)) for n, curve in enumerate(chart.deviations))
        label = "deviation,", "% of peak"
        panels.append(_panel(chart, top + HEIGHT + GAP, DEVIATIONS_HEIGHT, label, curves, x))
    return panels


def _panel(
    chart: Chart,
    top: float,
    height: float,
    label: tuple[str, ...],
    curves: tuple[tuple[Curve, Stroke], ...],
    x: tuple[float, float],
) -> Panel:
    values = np.concatenate([curve.y for curve, _ in curves])
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    margin = MARGIN * ((high - low) or abs(low) or 1.0)
    y = low - margin, high + margin
    most = min(9, int(height / (2 * FONT_SIZE)))
    return Panel(top, height, label, curves, x, y, ticks(*x, 9, chart.x_unit), ticks(*y, most))


def _range(curves: Sequence[Curve]) -> tuple[float, float]:
    """The range of x of the curves; that of the reference may be larger."""
    low, high = float(min(c.x.min() for c in curves)), float(max(c.x.max() for c in curves))
    return (low, high) if high > low else (low - 1, low + 1)


def _stroke(number: int, width: float) -> Stroke:
    colour, dashes = STYLES[number % len(STYLES)]
    return Stroke(colour, width, dashes)


def _drawn(panel: Panel, lowest: bool, label_position: float) -> Iterator[str]:
    """The lines of a panel; the lowest one has the labels of x."""
    bottom, height = panel.top + panel.height, _number(panel.height)
    xs = [_number(LEFT + x) for x in panel.across(np.array(panel.x_ticks.positions))]
    ys = [_number(panel.top + y) for y in panel.down(np.array(panel.y_ticks.positions))]
    grid = [f"M {x} {_number(panel.top)} v {height}" for x in xs] + [f"M {LEFT} {y} h {RIGHT - LEFT}" for y in ys]
    yield f'    <path d="{" ".join(grid)}" style="fill: none; stroke: {LIGHT}; stroke-width: 0.6"/>'
    yield f'    <svg x="{LEFT}" y="{_number(panel.top)}" width="{RIGHT - LEFT}" height="{height}">'
    for curve, stroke in panel.curves:
        yield f'      <path d="{_path(panel, curve)}" style="{stroke.style}; stroke-linejoin: round"/>'
    yield "    </svg>"
    axes = [f"M {LEFT} {_number(panel.top)} v {height} h {RIGHT - LEFT}"]
    axes += [f"M {x} {_number(bottom)} v {TICK}" for x in xs] + [f"M {LEFT} {y} h -{TICK}" for y in ys]
    yield f'    <path d="{" ".join(axes)}" style="fill: none; stroke: {FAINT}; stroke-width: 0.8"/>'
    for y, text in zip(ys, panel.y_ticks.labels, strict=True):
        yield _text(LEFT - TICK - 4, float(y) + 3.6, text, "text-anchor: end")
    if panel.y_ticks.common:
        yield _text(LEFT + 2, panel.top - 3, panel.y_ticks.common)
    if lowest:
        for x, text in zip(xs, panel.x_ticks.labels, strict=True):
            yield _text(float(x), bottom + 15, text, "text-anchor: middle")
        if panel.x_ticks.common:
            yield _text(RIGHT, bottom + 31, panel.x_ticks.common, "text-anchor: end")
    for n, line in enumerate(reversed(panel.label)):
        x, y = _number(label_position - 12 * n), _number(panel.top + panel.height / 2)
        yield f'    <text transform="translate({x} {y}) rotate(-90)" style="text-anchor: middle">{escape(line)}</text>'


def _label_position(panels: Sequence[Panel]) -> float:
    """The position of the labels of y, left of all labels of ticks."""
    longest = max(len(text) for panel in panels for text in panel.y_ticks.labels)
    lines = max(len(panel.label) for panel in panels)
    return max(12.0 * lines - 2, LEFT - TICK - 10 - LETTER * longest)


def _path(panel: Panel, curve: Curve) -> str:
    """The points of a curve, to a hundredth; values that are no numbers interrupt it."""
    stride = max(1, math.ceil((len(curve.x) - 1) / MAX_POINTS))
    chosen = np.unique(np.append(np.arange(0, len(curve.x), stride), len(curve.x) - 1))
    x, y = panel.across(curve.x[chosen]), panel.down(curve.y[chosen])
    parts, command = [], "M"
    for a, b in zip(x.tolist(), y.tolist(), strict=True):
        if math.isfinite(a) and math.isfinite(b):
            parts.append(f"{command} {_number(a)} {_number(b)}")
            command = "L"
        else:
            command = "M"
    return " ".join(parts)


def _legend_entries(chart: Chart) -> list[tuple[str, Stroke]]:
    """The labels of the curves, the reference first; none of a single curve."""
    known = [] if chart.reference is None else [(chart.reference.label, Stroke(REFERENCE, 5, (), 0.55))]
    entries = known + [(curve.label, _stroke(n, 1.6)) for n, curve in enumerate(chart.curves)]
    return entries if len(entries) > 1 else []


def _columns(entries: Sequence[tuple[str, Stroke]]) -> int:
    """Two columns, or one where two are too wide."""
    longest = max((len(label) for label, _ in entries), default=0)
    return 2 if 2 * (KEY + 8 + LETTER * longest) + KEY <= RIGHT - LEFT else 1


def _legend(entries: Sequence[tuple[str, Stroke]], columns: int, top: float) -> Iterator[str]:
    """The legend below the title, column by column."""
    rows = math.ceil(len(entries) / columns)
    for n, (label, stroke) in enumerate(entries):
        longest = max(len(text) for text, _ in entries[:rows])
        x = LEFT + (n // rows) * (KEY + 8 + LETTER * longest + KEY)
        y = top + LINE * (n % rows) + 12
        yield f'    <path d="M {_number(x)} {_number(y - 3.5)} h {KEY}" style="{stroke.style}"/>'
        yield _text(x + KEY + 8, y, label)


def _text(x: float, y: float, text: str, style: str = "") -> str:
    attribute = f' style="{style}"' if style else ""
    return f'    <text x="{_number(x)}" y="{_number(y)}"{attribute}>{escape(text, quote=False)}</text>'


def _number(value: float) -> str:
    """A number to a hundredth."""
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
