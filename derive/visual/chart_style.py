"""The style of charts: colours, their dark scheme, and figures of matplotlib in that style as SVG."""

from __future__ import annotations

import io
import math
import re
from html import escape
from typing import TYPE_CHECKING, Any

from derive.artifacts import MARK
from derive.visual.text_metrics import FONT

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.transforms import Bbox

INK, FAINT, LIGHT, REFERENCE, BACKGROUND = "#1c2733", "#8a949e", "#c9d0d6", "#9aa5af", "#ffffff"
DARK = {INK: "#e6edf3", FAINT: "#7d8790", LIGHT: "#3a434c", REFERENCE: "#76828d", BACKGROUND: "#13171b"}
"""Colours of text, axes, grid, reference and background, and those of the dark colour scheme.

The background is opaque: the colours of text follow the colour scheme of the desktop, which need not be that of the
page around the picture.
"""

SETTINGS: Any = {
    "svg.hashsalt": "tisserand",
    "svg.fonttype": "none",
    "font.family": FONT,
    "font.size": 10,
    "figure.facecolor": BACKGROUND,
    "axes.facecolor": "none",
    "axes.labelcolor": INK,
    "axes.edgecolor": FAINT,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": LIGHT,
    "grid.linewidth": 0.6,
    "text.color": INK,
    "text.parse_math": False,  # names of files may contain $
    "xtick.color": FAINT,
    "ytick.color": FAINT,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "legend.frameon": False,
    "path.simplify": False,
}
"""The settings (rcParams) of matplotlib."""

COLOURS = ("#d0702a", "#8661c1", "#1f8fbf", "#b3468a", "#5c8a2b", "#8c6d46")
"""Colours of curves, which differ on white and on black."""

OVERHANG = 0.08
"""The margin beside what a figure of a given size would cut off, in inches."""


def head(title: str) -> str:
    """The first elements of a picture: our mark, `title` for readers who do not see it, the dark colour scheme."""
    rules = [
        f'    [style*="{kind}: {light}"] {{ {kind}: {dark} !important; }}'
        for light, dark in DARK.items()
        for kind in ("fill", "stroke")
    ]
    return "\n".join(
        [
            f"  <!-- {MARK} -->",
            f"  <title>{escape(title, quote=False)}</title>",
            "  <style>",
            "    @media (prefers-color-scheme: dark) {",
            *rules,
            "    }",
            "  </style>",
        ]
    )


def figure_svg(figure: Figure, title: str) -> str:
    """The text of a figure of matplotlib as SVG, with `title` for readers who do not see it.

    It carries our mark, uses the fonts of the page, follows the dark colour scheme, and has the same bytes each time.
    It is larger than the figure where a label would be cut off.
    """
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    stream = io.StringIO()
    FigureCanvasSVG(figure)
    metadata = {"Date": None, "Creator": None, "Format": None, "Type": None}
    figure.savefig(stream, format="svg", metadata=metadata, bbox_inches=_whole(figure))
    return in_page_style(stream.getvalue(), title)


def in_page_style(svg: str, title: str) -> str:
    """A picture that matplotlib has written with SETTINGS in the style of pages, with a `title` for screen readers.

    It carries our mark, uses the fonts of the page and follows the dark colour scheme; what matplotlib says about the
    time and itself is left out.
    """
    svg = re.sub(r" *<metadata>.*?</metadata>\n", "", svg, flags=re.DOTALL)
    svg_tag = re.compile(r"<\?xml.*?<svg ([^>]*)>\n", re.DOTALL)
    text = svg_tag.sub(lambda m: f'<svg role="img" {m[1]}>\n{head(title)}\n', svg)
    text = re.sub(r'(?<= d=")[^"]*', lambda m: _shorter(m[0]), text)
    text = text.replace(f"font-family: '{FONT}'", f"font-family: system-ui, '{FONT}', sans-serif")
    return "".join(line.rstrip() + "\n" for line in text.splitlines())


def _whole(figure: Figure) -> Bbox | None:
    """The rectangle of a figure with all artists that reach beyond it, in inches; None if none does."""
    from matplotlib.transforms import Bbox

    width, height = figure.get_size_inches()
    drawn = figure.get_tightbbox()
    beyond = [
        math.ceil(100 * (distance + OVERHANG)) / 100 if distance > 0 else 0.0
        for distance in (-drawn.x0, -drawn.y0, drawn.x1 - width, drawn.y1 - height)
    ]
    if not any(beyond):
        return None
    return Bbox.from_extents(-beyond[0], -beyond[1], width + beyond[2], height + beyond[3])


def titled(svg: str, titles: dict[str, str]) -> str:
    """A picture with texts that browsers show for the groups with these identifiers."""
    for group, text in titles.items():
        svg = svg.replace(f'<g id="{group}">', f'<g id="{group}"><title>{escape(text, quote=False)}</title>')
    return svg


def _shorter(path: str) -> str:
    """A path on one line, to a hundredth of a point."""
    return re.sub(r"-?\d+\.\d+", lambda m: f"{float(m[0]):.2f}".rstrip("0").rstrip("."), " ".join(path.split()))
