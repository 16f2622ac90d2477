"""A page as one HTML file that needs nothing else: no script, no font, no picture from outside."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from itertools import count

from derive.artifacts import MARK
from derive.rendering import render
from derive.report.document.anchors import address
from derive.report.document.page import (
    Block,
    Cell,
    CodeSpan,
    Columns,
    Details,
    EquationBlock,
    Heading,
    Hyperlink,
    Inline,
    Listing,
    Math,
    Page,
    Paragraph,
    Picture,
    Strong,
    TableBlock,
    Text,
)
from derive.report.notation import spoken_math
from derive.report.writers.equation_html import equations_html
from derive.report.writers.listings import listing_html
from derive.report.writers.mathml import math_in_text
from derive.report.writers.picture import inline

ALIGN = {"r": ' class="r"', "c": ' class="c"'}
MARKS = tuple(",.;:)!?'\u2019")
LONG, SOME = 40, 16
"""Columns of more characters keep room for them."""
MANY = 200
"""Tables with more annotated cells than this are not reached by the tab key."""


def html(page: Page) -> str:
    """The page as HTML."""
    values = {
        "mark": MARK,
        "title": escape(page.title),
        "subtitle": text(page.subtitle),
        "contents": _contents([block for block in page.blocks if isinstance(block, Heading)]),
        "body": _Writer().blocks(page.blocks),
    }
    return render("report/page.html.jinja", values)


def _contents(headings: Sequence[Heading]) -> str:
    lines = [
        f'<li class="h{heading.level}"><a href="#{escape(heading.anchor)}">{escape(heading.text)}</a></li>'
        for heading in headings
    ]
    return "\n".join(lines)


class _Writer:
    """A writer of blocks, which counts the pictures, whose names have to differ."""

    def __init__(self) -> None:
        self._pictures = count(1)

    def blocks(self, blocks: Sequence[Block]) -> str:
        return "\n".join(self._block(block) for block in blocks)

    def _block(self, block: Block) -> str:
        match block:
            case Heading(words, anchor, level):
                return f'<h{level} id="{escape(anchor)}">{escape(words)}</h{level}>'
            case Paragraph(words):
                return f"<p>{text(words)}</p>"
            case EquationBlock(rows):
                return equations_html(rows)
            case TableBlock():
                return _table(block)
            case Picture(svg, alt, caption, hint):
                drawn = inline(svg, f"picture-{next(self._pictures)}", alt)
                listed = f' <span class="hint">{escape(hint)}</span>' if hint else ""
                words = f"<figcaption>{escape(caption)}{listed}</figcaption>" if caption or hint else ""
                return f'<figure class="picture">{drawn}{words}</figure>'
            case Listing():
                return listing_html(block)
            case Details(summary, inner):
                return f"<details><summary>{escape(summary)}</summary>\n{self.blocks(inner)}\n</details>"
            case Columns(columns):
                sides = "\n".join(f"<div>\n{self.blocks(item)}\n</div>" for item in columns)
                return f'<div class="columns">\n{sides}\n</div>'


def text(parts: Text) -> str:
    """Text with its formulas, links and words of code. No line ends between a formula and a mark behind it."""
    out = []
    for k, part in enumerate(parts):
        following = parts[k + 1] if k + 1 < len(parts) else None
        close = isinstance(part, Math) and isinstance(following, str) and following[:1] in MARKS
        out.append(_inline(part) + ("\u2060" if close else ""))
    return "".join(out)


def _inline(part: Inline) -> str:
    match part:
        case str():
            return escape(part, quote=False)
        case Math(formula):
            return math_in_text(formula)
        case Hyperlink(words, to):
            return f'<a href="{escape(address(to))}">{escape(words, quote=False)}</a>'
        case CodeSpan(words):
            return f"<code>{escape(words, quote=False)}</code>"
        case Strong(words):
            return f"<strong>{escape(words, quote=False)}</strong>"


def _table(table: TableBlock) -> str:
    align = [ALIGN.get(item, "") for item in table.align.ljust(len(table.head), "l")]
    listed = sum(bool(cell.title) for row in table.rows for cell in row) <= MANY
    head = "".join(_head(table, k, side) for k, side in enumerate(align))
    rows = "\n".join(f"<tr>{_cells(row, align, listed)}</tr>" for row in table.rows)
    caption = f"<caption>{escape(table.caption)}</caption>" if table.caption else ""
    label = escape(table.caption or "Table")
    kind, role = ("table wide", "region") if table.wide else ("table", "group")
    scrolled = f'role="{role}" aria-label="{label}" tabindex="0"'  # by keys, where a window is narrow
    content = f"{caption}\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}\n</tbody>"
    return f'<div class="{kind}" {scrolled}><table>{content}</table></div>'


def _head(table: TableBlock, column: int, side: str) -> str:
    """A head; that of a column of much text keeps room for it. A column without a title has a cell that is no head."""
    if not table.head[column]:
        return "<td></td>"
    longest = max((sum(map(_length, row[column].text)) for row in table.rows), default=0)
    names = [*([side[8:-1]] if side else []), *(["long"] if longest > LONG else ["some"] if longest > SOME else [])]
    kind = f' class="{" ".join(names)}"' if names else ""
    return f'<th scope="col"{kind}>{text(table.head[column])}</th>'


def _length(part: Inline) -> int:
    """Characters that a line may break between."""
    return len(part) if isinstance(part, str) else 0 if isinstance(part, Math | CodeSpan) else len(part.text)


def _cells(row: Sequence[Cell], align: Sequence[str], listed: bool) -> str:
    out = []
    for k, (cell, side) in enumerate(zip(row, align, strict=True)):
        tag = "td" if k else 'th scope="row"'
        names = [name for name in (cell.mark, side[8:-1]) if name]
        kind = f' class="{" ".join(names)}"' if names else ""
        title = f' title="{escape(cell.title)}"' + (' tabindex="0"' if listed else "") if cell.title else ""
        if not k and cell.text and all(isinstance(part, Math) for part in cell.text):
            spoken = " ".join(spoken_math.words(part.formula) for part in cell.text if isinstance(part, Math))
            title += f' aria-label="{escape(spoken)}"'  # some programs do not read formulas in heads
        out.append(f"<{tag}{kind}{title}>{text(cell.text)}</{tag[:2]}>")
    return "".join(out)
