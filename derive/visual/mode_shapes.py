"""Mode shapes as a picture (SVG): a panel for each mode, with the undeformed and the displaced lines, to scale."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray

from derive.artifacts import MARK

Array = NDArray[np.float64]

COLUMNS, WIDTH, GAP, HEAD = 3, 236, 24, 44
"""Panels in a row, two at least; width of a panel, the gap between panels, height of a title above, in pixels."""
LETTER, LINE = 6.6, 18
"""Width of a letter and height of a line of the note, in pixels."""
LEAST, MOST = 90, 260
"""The least and the greatest height of the drawing in a panel, in pixels."""
DOT = 3
"""The radius of a point, in pixels."""
MANY = 60
"""The number of lines of a panel above which they are thin."""

STYLE = """\
  <style>
    text { font: 13px system-ui, 'DejaVu Sans', sans-serif; fill: #1c2733; } .ground { fill: #ffffff; }
    .title { font-weight: 600; font-size: 15px; } .mode { font-weight: 600; } .note { fill: #5b6773; }
    path { fill: none; stroke-linejoin: round; stroke-linecap: round; }
    .rest { stroke: #b8c2cc; stroke-width: 2; } circle.rest { fill: #b8c2cc; }
    .there { stroke: #1f6f8b; stroke-width: 2.4; } circle.there { fill: #1f6f8b; }
    .back { stroke: #d0702a; stroke-width: 1.4; stroke-dasharray: 5 4; } circle.back { fill: #d0702a; stroke: none; }
    .point { fill: #1c2733; } .mesh path { stroke-width: 0.8; }
    @media (prefers-color-scheme: dark) {
      text { fill: #e6edf3; } .ground { fill: #13171b; } .note { fill: #9aa6b2; }
      .rest { stroke: #55606b; } circle.rest { fill: #55606b; } .there { stroke: #5fb6d4; }
      circle.there { fill: #5fb6d4; } .back { stroke: #ee9557; } circle.back { fill: #ee9557; }
      .point { fill: #e6edf3; }
    }
  </style>"""


@dataclass(frozen=True, eq=False)
class ModePanel:
    """A mode: its title, and its lines (points, 2) at rest, displaced, and displaced the other way; in m."""

    title: str
    rest: Sequence[Array]
    there: Sequence[Array]
    back: Sequence[Array]


def mode_picture(title: str, note: str, panels: Sequence[ModePanel], points: Array) -> str:
    """The picture of modes, with a title above, a note below, and the points (n, 2) that do not move in each panel."""
    every = [points, *(line for panel in panels for line in (*panel.rest, *panel.there, *panel.back))]
    low, high = (extreme(np.concatenate(every), axis=0) for extreme in (np.min, np.max))
    span = np.maximum(high - low, 1e-12)
    scale = float(min((WIDTH - 2 * DOT) / span[0], (MOST - 2 * DOT) / span[1]))
    drawn = max(LEAST, math.ceil(float(span[1]) * scale) + 2 * DOT)
    columns = max(2, min(COLUMNS, len(panels)))
    rows = math.ceil(len(panels) / columns)
    width = columns * (WIDTH + GAP) + GAP
    notes = textwrap.wrap(note, int((width - 2 * GAP) / LETTER))
    bottom = HEAD + rows * (drawn + HEAD) + LINE
    height = bottom + len(notes) * LINE
    middle = (low + high) / 2
    lines = []
    for number, panel in enumerate(panels):
        left = GAP + number % columns * (WIDTH + GAP)
        top = HEAD + number // columns * (drawn + HEAD)
        centre = np.array([left + WIDTH / 2, top + HEAD / 2 + drawn / 2])
        lines.append(f'  <text class="mode" x="{left}" y="{top + 8}">{escape(panel.title)}</text>')
        for kind, shapes in (("rest", panel.rest), ("back", panel.back), ("there", panel.there)):
            lines += _lines(kind, [centre + (shape - middle) * [scale, -scale] for shape in shapes])
        for x, y in centre + (points - middle) * [scale, -scale]:
            lines.append(f'  <circle class="point" cx="{x:.1f}" cy="{y:.1f}" r="{DOT}"/>')
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" role="img">',
            f"  <!-- {MARK} -->",
            f"  <title>{escape('; '.join([title, *(panel.title for panel in panels)]))}</title>",
            STYLE,
            f'  <rect class="ground" width="{width}" height="{height}"/>',
            f'  <text class="title" x="{GAP}" y="24">{escape(title)}</text>',
            f'  <g class="{"mesh" if max(len(panel.rest) for panel in panels) > MANY else "lines"}">',
            *lines,
            "  </g>",
            *(
                f'  <text class="note" x="{GAP}" y="{bottom + k * LINE}">{escape(text)}</text>'
                for k, text in enumerate(notes)
            ),
            "</svg>\n",
        ]
    )


def _lines(kind: str, shapes: Sequence[Array]) -> list[str]:
    """One path through all lines (points, 2), in pixels, and a dot for each line that is one point."""
    dots = [shape[0] for shape in shapes if np.ptp(shape, axis=0).max() < 0.05]
    paths = ["M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in s) for s in shapes if np.ptp(s, axis=0).max() >= 0.05]
    texts = [f'  <path class="{kind}" d="{"".join(paths)}"/>'] if paths else []
    return texts + [f'  <circle class="{kind}" cx="{x:.1f}" cy="{y:.1f}" r="{DOT + 1}"/>' for x, y in dots]
