"""Tables of a report: short to write, and folded where they are long."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from derive.report.document.formula import Formula
from derive.report.document.page import Block, Cell, Code, Details, Inline, Link, Math, Strong, Table

MOST, ALL = 60, 150
"""Rows that a table shows, and up to which it is folded away as a whole; of a longer one the first are."""

Said = str | Math | Link | Code | Strong | Cell | Formula | int | tuple[Inline, ...]


def table(
    caption: str, head: Sequence[Said], rows: Sequence[Sequence[Said]], align: str = "", wide: bool = False
) -> Table:
    """A table of text, formulas and numbers."""
    return Table(
        caption, tuple(cell(h).text for h in head), tuple(tuple(map(cell, row)) for row in rows), align, wide=wide
    )


def cell(said: Said, title: str = "", mark: Literal["", "zero", "entry", "good", "bad"] = "") -> Cell:
    """A cell."""
    if isinstance(said, Cell):
        return said
    if isinstance(said, int):
        said = str(said)
    if isinstance(said, str | Math | Link | Code | Strong):
        return Cell((said,) if said else (), title, mark)
    if isinstance(said, tuple):
        return Cell(said, title, mark)
    return Cell((Math(said),), title, mark)


def folded(whole: Table, summary: str) -> Block:
    """A table as it is; folded away where it is long, and of a very long one the first rows."""
    count = len(whole.rows)
    if count <= MOST:
        return whole
    if count <= ALL:
        return Details(f"{summary}: {count}", (whole,))
    return Details(f"{summary}: the first {MOST} of {count}", (replace(whole, rows=whole.rows[:MOST]),))
