"""Tables as text."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence

WIDTH = 116
"""Characters of a line of words."""


def table(rows: Sequence[Sequence[str]], left: int = 1) -> list[str]:
    """Rows of cells, the first `left` columns to the left, the others to the right; short rows end early."""
    widths = [max(len(row[i]) for row in rows if i < len(row)) for i in range(max(map(len, rows)))]
    lines = (
        "  ".join(f"{c:<{w}}" if i < left else f"{c:>{w}}" for i, (c, w) in enumerate(zip(row, widths, strict=False)))
        for row in rows
    )
    return [f"  {line}".rstrip() for line in lines]


def wrapped(said: Iterable[str], before: str = "") -> list[str]:
    """Sentences on lines of their own, as many as each needs."""
    return [
        line
        for one in said
        for line in textwrap.wrap(one, WIDTH, initial_indent=before, subsequent_indent=f"{before}  ")
    ]


def beams(pieces: int) -> str:
    """A number of beams."""
    return f"{pieces} beam{'s' if pieces > 1 else ''}"


def short(value: float) -> str:
    """A number whose size alone matters."""
    return f"{value:.1e}" if value else "0"
