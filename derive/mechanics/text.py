"""Equations as plain text that fits on a page."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence

import sympy as sp

WIDTH = 110
MOST_LINES = 3
"""Lines that one equation may take."""
MOST_EQUATIONS = 14
"""Equations of one block."""


def equation(left: str, right: sp.Expr | str) -> list[str]:
    """An equation, wrapped; of a long one the beginning."""
    lines = textwrap.wrap(f"{left} = {right}", WIDTH, subsequent_indent="        ")
    return lines if len(lines) <= MOST_LINES else [*lines[: MOST_LINES - 1], f"        ... ({len(lines)} lines in all)"]


def block(title: str, equations: Sequence[tuple[str, sp.Expr | str]]) -> list[str]:
    """A titled list of equations; of many the first ones, with their number."""
    if not equations:
        return []
    lines = [title]
    for left, right in equations[:MOST_EQUATIONS]:
        lines += [f"  {line}" for line in equation(left, right)]
    more = len(equations) - MOST_EQUATIONS
    return [*lines, f"  ... and {more} more"] if more > 0 else lines


def page(blocks: Iterable[list[str]]) -> str:
    """Blocks with an empty line between them."""
    return "\n\n".join("\n".join(lines) for lines in blocks if lines)
