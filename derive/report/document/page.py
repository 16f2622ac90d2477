"""A report as data: headings, paragraphs, equations, tables, pictures and code, which every language lays out.

`table`, `cell` and `folded` make tables of plain values.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from derive.report.document.formula import Equation, Formula

SHOWN, FOLDED = 60, 150
"""The most rows of a table that is shown, and of one that is folded away as a whole; of longer ones the first are."""


@dataclass(frozen=True)
class Math:
    """A formula within text."""

    formula: Formula


@dataclass(frozen=True)
class Hyperlink:
    """Text that leads to an anchor of this page (`#...`), or to an address."""

    text: str
    to: str


@dataclass(frozen=True)
class CodeSpan:
    """A word of code within text."""

    text: str


@dataclass(frozen=True)
class Strong:
    """A word that is to be seen."""

    text: str


Inline = str | Math | Hyperlink | CodeSpan | Strong
Text = tuple[Inline, ...]


@dataclass(frozen=True)
class Heading:
    """A heading of level 2 or 3 (the title is 1), with an anchor."""

    text: str
    anchor: str
    level: int = 2


@dataclass(frozen=True)
class Paragraph:
    """A paragraph."""

    text: Text


@dataclass(frozen=True)
class EquationBlock:
    """Equations below each other, aligned at their relations. A long one breaks between its parts."""

    rows: tuple[Equation, ...]


@dataclass(frozen=True)
class Cell:
    """A cell of a table; `title` is its tooltip, `mark` lets it be coloured (zero, entry, good, bad)."""

    text: Text
    title: str = ""
    mark: Literal["", "zero", "entry", "good", "bad"] = ""


@dataclass(frozen=True)
class TableBlock:
    """A table with a caption; `wide` ones may scroll. `align` has l, r or c for each column."""

    caption: str
    head: tuple[Text, ...]
    rows: tuple[tuple[Cell, ...], ...]
    align: str = ""
    wide: bool = False


@dataclass(frozen=True)
class Picture:
    """A picture as SVG text, with an alternative text. `hint` explains, on a screen, what the pointer shows."""

    svg: str
    alt: str
    caption: str
    hint: str = ""


@dataclass(frozen=True)
class CodeLine:
    """A line of code with an anchor, and the anchors it leads to (with the text of each link)."""

    number: int
    text: str
    anchor: str = ""
    links: tuple[Hyperlink, ...] = ()


@dataclass(frozen=True)
class Listing:
    """Lines of code of a file."""

    language: str
    caption: str
    lines: tuple[CodeLine, ...]


@dataclass(frozen=True)
class Details:
    """Blocks that are folded away until the reader opens them, with a summary."""

    summary: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class Columns:
    """Blocks side by side, as two frames of one body; below each other where there is no room."""

    columns: tuple[tuple[Block, ...], ...]


Block = Heading | Paragraph | EquationBlock | TableBlock | Picture | Listing | Details | Columns


@dataclass(frozen=True)
class Page:
    """A whole report."""

    title: str
    subtitle: Text
    blocks: tuple[Block, ...]


Content = str | Math | Hyperlink | CodeSpan | Strong | Cell | Formula | int | tuple[Inline, ...]
"""The values from which `cell` makes a cell of a table."""


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
    """A table, folded away if it has more than SHOWN rows; of more than FOLDED rows only the first SHOWN are kept."""
    count = len(whole.rows)
    if count <= SHOWN:
        return whole
    if count <= FOLDED:
        return Details(f"{summary}: {count}", (whole,))
    return Details(f"{summary}: the first {SHOWN} of {count}", (replace(whole, rows=whole.rows[:SHOWN]),))
