"""Sparsity patterns as a picture (SVG): a square for a value, a dot for a structural zero."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

from derive.artifacts import MARK
from derive.ir.model import Model
from derive.visual.text_metrics import widest

CELL, GAP, LABEL, MARGIN, HEAD, FOOT, FEW = 28, 44, 64, 56, 56, 40, 24
TEXT, TITLE, NAMED_CELL = 13, 15, 12
"""The sizes of texts, and the side of cells above which rows have their names, in pixels."""
STYLE = """\
  <style>
    text { font: 13px system-ui, 'DejaVu Sans', sans-serif; fill: #1c2733; } .ground { fill: #ffffff; }
    .title { font-weight: 600; font-size: 15px; }
    .value { fill: #1f6f8b; } .zero { fill: #b8c2cc; } .frame { fill: none; stroke: #b8c2cc; }
    @media (prefers-color-scheme: dark) {
      text { fill: #e6edf3; } .ground { fill: #13171b; }
      .value { fill: #5fb6d4; } .zero { fill: #55606b; } .frame { stroke: #55606b; }
    }
  </style>"""


def mass_patterns(models: Sequence[Model]) -> str:
    """The patterns of the mass matrices of some models side by side, with named rows."""
    size = max(model.pattern("mass", "M").rows for model in models)
    cell = CELL if size <= FEW else max(2, FEW * CELL // size)
    names = (name for model in models for name in _names(model))
    label = max(LABEL, math.ceil(widest(names, TEXT)) + 8) if cell > NAMED_CELL else LABEL
    captions = max(widest((model.name for model in models), TITLE, bold=True), widest(map(_caption, models), TEXT))
    panel = label + max(size * cell, math.ceil(captions) - MARGIN)
    width = len(models) * panel + (len(models) - 1) * GAP + 8 + MARGIN
    height = HEAD + size * cell + FOOT
    parts = [_panel(model, 8 + k * (panel + GAP) + label, cell) for k, model in enumerate(models)]
    counts = "; ".join(f"{m.name}: {_count(m)}" for m in models)
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" role="img">',
            f"  <!-- {MARK} -->",
            f"  <title>Structural non-zeros of the mass matrix. {escape(counts)}</title>",
            STYLE,
            f'  <rect class="ground" width="{width}" height="{height}"/>',
            *parts,
            "</svg>\n",
        ]
    )


def _count(model: Model) -> str:
    pattern = model.pattern("mass", "M")
    return f"{pattern.full_nnz} of {pattern.rows * pattern.cols}"


def _names(model: Model) -> list[str]:
    """The names of the rows; those of many shapes are numbered."""
    return [name for row in model.equations for name in row.elements]


def _caption(model: Model) -> str:
    return f"{_count(model)} structural non-zeros"


def _panel(model: Model, x0: int, cell: int) -> str:
    """The pattern of a model with its left edge at x0."""
    pattern = model.pattern("mass", "M")
    present = set(pattern.entries) | {(j, i) for i, j in pattern.entries}
    n = pattern.rows
    lines = [
        f'  <text class="title" x="{x0}" y="20">{escape(model.name)}</text>',
        f'  <rect class="frame" x="{x0}" y="{HEAD - 16}" width="{n * cell}" height="{n * cell}" rx="3"/>',
    ]
    gap = 4 if cell == CELL else 0 if cell < 8 else 1
    for i, name in enumerate(_names(model)):
        y = HEAD - 16 + i * cell
        middle = y + cell // 2
        if cell > NAMED_CELL:
            lines.append(f'  <text x="{x0 - 8}" y="{middle + 4}" text-anchor="end">{escape(name)}</text>')
        for j in range(n):
            x = x0 + j * cell
            if (i, j) in present:
                side = cell - 2 * gap
                lines.append(
                    f'  <rect class="value" x="{x + gap}" y="{y + gap}" width="{side}" height="{side}" rx="2"/>'
                )
            elif cell == CELL:
                lines.append(f'  <circle class="zero" cx="{x + cell // 2}" cy="{middle}" r="2"/>')
    lines.append(f'  <text x="{x0}" y="{HEAD + n * cell + 8}">{_caption(model)}</text>')
    return "\n".join(lines)
