"""The pattern of a KKT matrix in its elimination order, with the fill-in of its factorisation."""

from __future__ import annotations

from html import escape

from derive.artifacts import MARK
from derive.ir.model import Kkt

CELL, EDGE, WIDTH = 14, 6, 640
"""Side of a cell, margin, and width of larger pictures, in pixels."""

NAMED, LETTER, FOOT, LEGEND = 45, 6.2, 24, 240
"""The most rows with names, width of a letter, height and width of the legend."""

STYLE = """\
  <style>
    text { font: 11px system-ui, 'DejaVu Sans', sans-serif; fill: #1c2733; } .ground { fill: #ffffff; }
    .value, .own { fill: #1f6f8b; } .fill, .new { fill: #d98a3d; } .frame { fill: none; stroke: #b8c2cc; }
    @media (prefers-color-scheme: dark) {
      text { fill: #e6edf3; } .ground { fill: #13171b; }
      .value, .own { fill: #5fb6d4; } .fill, .new { fill: #e0a564; } .frame { stroke: #55606b; }
    }
  </style>"""


def factor_entries(kkt: Kkt) -> tuple[frozenset[tuple[int, int]], frozenset[tuple[int, int]]]:
    """Entries below the diagonal, by places in the order: those of the matrix, and the fill-in."""
    position = {node: k for k, node in enumerate(kkt.order)}
    pairs = ((position[i], position[j]) for i, j in kkt.pattern.entries if i != j)
    own = frozenset((max(pair), min(pair)) for pair in pairs)
    below: list[set[int]] = [set() for _ in kkt.order]
    for i, j in own:
        below[j].add(i)
    for j in range(len(below)):
        if below[j]:
            first = min(below[j])
            below[first] |= below[j] - {first}
    every = frozenset((i, j) for j, rows in enumerate(below) for i in rows)
    return own, every - own


def kkt_picture(kkt: Kkt, names: tuple[str, ...]) -> str:
    """The lower triangle as SVG in its elimination order, with a legend.

    `names` are those of coordinates and multipliers; they label the rows of matrices of up to NAMED rows, and the
    pointer shows them on every entry.
    """
    own, filled = factor_entries(kkt)
    n = len(kkt.order)
    cell = min(CELL, max(2, WIDTH // n))
    left = EDGE + (round(LETTER * max(map(len, names))) + 8 if n <= NAMED else 0)
    side, gap = n * cell, 1 if cell > 4 else 0
    width, height = max(left + side + EDGE, LEGEND), side + 2 * EDGE + FOOT
    lines = [f'  <rect class="ground" width="{width}" height="{height}"/>']
    lines.append(f'  <rect class="frame" x="{left}" y="{EDGE}" width="{side}" height="{side}" rx="3"/>')
    if n <= NAMED:
        lines += [
            f'  <text x="{left - 5}" y="{EDGE + k * cell + cell - 3}" text-anchor="end">{escape(names[node])}</text>'
            for k, node in enumerate(kkt.order)
        ]
    for kind, entries in (("value", own | {(k, k) for k in range(n)}), ("fill", filled)):
        for i, j in sorted(entries):
            entry = names[kkt.order[i]] if i == j else f"{names[kkt.order[i]]}, {names[kkt.order[j]]}"
            text = f"{entry}: fill-in" if kind == "fill" else f"pivot of {entry}" if i == j else entry
            lines.append(
                f'  <rect class="{kind}" x="{left + j * cell + gap}" y="{EDGE + i * cell + gap}" '
                f'width="{cell - 2 * gap}" height="{cell - 2 * gap}"><title>{escape(text, quote=False)}</title></rect>'
            )
    lines += _legend(height - FOOT)
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" role="img">'
    return "\n".join([head, f"  <!-- {MARK} -->", STYLE, *lines, "</svg>\n"])


def _legend(top: int) -> list[str]:
    """The legend of the two colours."""
    return [
        f'  <rect class="own" x="{EDGE}" y="{top + 6}" width="11" height="11"/>',
        f'  <text x="{EDGE + 17}" y="{top + 16}">entry of M or G</text>',
        f'  <rect class="new" x="{EDGE + 130}" y="{top + 6}" width="11" height="11"/>',
        f'  <text x="{EDGE + 147}" y="{top + 16}">fill-in of L</text>',
    ]
