"""Tables of a report: short to write, and folded where they are long."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from derive.report.document.formula import Formula
from derive.report.document.page import Block, Cell, CodeSpan, Details, Hyperlink, Inline, Math, Strong, TableBlock

MOST, ALL = 60, 150
"""Rows that a table shows, and up to which it is folded away as a whole; of a longer one the first are."""

Content = str | Math | Hyperlink | CodeSpan | Strong | Cell | Formula | int | tuple[Inline, ...]


def table(
    caption: str, head: Sequence[Content], rows: Sequence[Sequence[Content]], align: str = "", wide: bool = False
) -> TableBlock:
    """A table of text, formulas and numbers."""
    return TableBlock(
        caption, tuple(cell(h).text for h in head), tuple(tuple(map(cell, row)) for row in rows), align, wide=wide
    )


def cell(words: Content, title: str = "", mark: Literal["", "zero", "entry", "good", "bad"] = "") -> Cell:
    """A cell."""
    if isinstance(words, Cell):
        return words
    if isinstance(words, int):
        words = str(words)
    if isinstance(words, str | Math | Hyperlink | CodeSpan | Strong):
        return Cell((words,) if words else (), title, mark)
    if isinstance(words, tuple):
        return Cell(words, title, mark)
    return Cell((Math(words),), title, mark)


def folded(whole: TableBlock, summary: str) -> Block:
    """A table as it is; folded away where it is long, and of a very long one the first rows."""
    count = len(whole.rows)
    if count <= MOST:
        return whole
    if count <= ALL:
        return Details(f"{summary}: {count}", (whole,))
    return Details(f"{summary}: the first {MOST} of {count}", (replace(whole, rows=whole.rows[:MOST]),))
