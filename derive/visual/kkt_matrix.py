"""The pattern of a KKT matrix in the order in which it is eliminated, with what is filled in."""

from __future__ import annotations

from html import escape

from derive.artifacts import MARK
from derive.ir.model import Kkt

CELL, EDGE, WIDTH = 14, 6, 640

STYLE = """\
  <style>
    .value { fill: #1f6f8b; } .fill { fill: #d98a3d; } .frame { fill: none; stroke: #b8c2cc; }
    .line { stroke: #b8c2cc; stroke-width: 1; fill: none; }
    @media (prefers-color-scheme: dark) {
      .value { fill: #5fb6d4; } .fill { fill: #e0a564; } .frame, .line { stroke: #55606b; }
    }
  </style>"""


def factor_entries(kkt: Kkt) -> tuple[frozenset[tuple[int, int]], frozenset[tuple[int, int]]]:
    """Entries below the diagonal, by places in the order: those of the matrix, and those that are filled in."""
    place = {node: k for k, node in enumerate(kkt.order)}
    pairs = ((place[i], place[j]) for i, j in kkt.pattern.entries if i != j)
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
    """The lower triangle as SVG; `names` are those of coordinates and multipliers, told on hover."""
    own, filled = factor_entries(kkt)
    n = len(kkt.order)
    cell = min(CELL, max(2, WIDTH // n))
    size = n * cell + 2 * EDGE
    gap = 1 if cell > 4 else 0
    lines = [f'  <rect class="frame" x="{EDGE}" y="{EDGE}" width="{n * cell}" height="{n * cell}" rx="3"/>']
    diagonal = {(k, k) for k in range(n)}
    for kind, entries in (("value", own | diagonal), ("fill", filled)):
        for i, j in sorted(entries):
            what = names[kkt.order[i]] if i == j else f"{names[kkt.order[i]]}, {names[kkt.order[j]]}"
            said = f"{what}: filled in" if kind == "fill" else f"pivot of {what}" if i == j else what
            lines.append(
                f'  <rect class="{kind}" x="{EDGE + j * cell + gap}" y="{EDGE + i * cell + gap}" '
                f'width="{cell - 2 * gap}" height="{cell - 2 * gap}"><title>{escape(said, quote=False)}</title></rect>'
            )
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size} {size}" width="{size}" role="img">'
    return "\n".join([head, f"  <!-- {MARK} -->", STYLE, *lines, "</svg>\n"])
