"""The style of charts: colours, their dark scheme, and figures of matplotlib in that style as SVG."""

from __future__ import annotations

import io
import re
from html import escape
from typing import TYPE_CHECKING, Any

from derive.artifacts import MARK

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INK, FAINT, LIGHT, REFERENCE, BACKGROUND = "#1c2733", "#8a949e", "#c9d0d6", "#9aa5af", "#ffffff"
DARK = {INK: "#e6edf3", FAINT: "#7d8790", LIGHT: "#3a434c", REFERENCE: "#76828d", BACKGROUND: "#13171b"}
"""Colours of text, axes, grid, reference and background, and those of the dark colour scheme.

The background is opaque: the colours of text follow the colour scheme of the desktop, which need not be that of the
page around the picture.
"""

SETTINGS: Any = {
    "svg.hashsalt": "tisserand",
    "svg.fonttype": "none",
    "font.family": "DejaVu Sans",
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
"""Those of matplotlib."""


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
    """
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    stream = io.StringIO()
    FigureCanvasSVG(figure)
    figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    svg_tag = re.compile(r"<\?xml.*?<svg ([^>]*)>\n", re.DOTALL)
    text = svg_tag.sub(lambda m: f'<svg role="img" {m[1]}>\n{head(title)}\n', stream.getvalue())
    text = re.sub(r'(?<= d=")[^"]*', lambda m: _shorter(m[0]), text)
    text = re.sub(r"(font: [^;\"]*?px) [^;\"]*", r"\1 system-ui, 'DejaVu Sans', sans-serif", text)
    return "".join(line.rstrip() + "\n" for line in text.splitlines())


def titled(svg: str, titles: dict[str, str]) -> str:
    """A picture with texts that browsers show for the groups with these identifiers."""
    for group, text in titles.items():
        svg = svg.replace(f'<g id="{group}">', f'<g id="{group}"><title>{escape(text, quote=False)}</title>')
    return svg


def _shorter(path: str) -> str:
    """A path on one line, to a hundredth of a point."""
    return re.sub(r"-?\d+\.\d+", lambda m: f"{float(m[0]):.2f}".rstrip("0").rstrip("."), " ".join(path.split()))
