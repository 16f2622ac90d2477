"""A page as GitHub flavoured Markdown, with formulas between dollars and in `math` blocks."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import count

from derive.artifacts import MARK
from derive.report.document.anchors import address, linked
from derive.report.document.formula import Equation, Formula
from derive.report.document.page import (
    Block,
    CodeSpan,
    Columns,
    Details,
    EquationBlock,
    Heading,
    Hyperlink,
    Listing,
    Math,
    Page,
    Paragraph,
    Picture,
    Strong,
    TableBlock,
    Text,
)
from derive.report.writers.latex_math import equation_latex, latex_math
from derive.report.writers.listings import gaps
from derive.report.writers.picture import standalone

ROOM = 44.0
"""The width of a line of formulas, in em."""
SIDES = {"l": "---", "r": "---:", "c": ":---:"}
SAFER = {"\\{": "\\lbrace ", "\\}": "\\rbrace ", "\\,": "\\thinspace ", "\\\\": "\\cr ", "<": "\\lt ", ">": "\\gt "}
"""LaTeX commands and signs that Markdown might interpret within a line, and their replacements."""


def markdown(page: Page, pictures: str = "") -> str:
    """The page as Markdown. Its pictures become words, or files in the folder `pictures` (see `picture_files`)."""
    head = [f"<!-- {MARK} -->", f"# {plain(page.title)}", *([text(page.subtitle)] if page.subtitle else [])]
    writer = _Writer(pictures, linked(page))
    return "\n\n".join([*head, *writer.blocks(page.blocks)]) + "\n"


def picture_files(page: Page) -> tuple[tuple[str, str], ...]:
    """The names and texts of the pictures of a page."""
    return tuple((f"picture-{k}.svg", standalone(svg)) for k, svg in enumerate(_pictures(page.blocks), 1))


def _pictures(blocks: Sequence[Block]) -> list[str]:
    result: list[str] = []
    for block in blocks:
        match block:
            case Picture(svg):
                result.append(svg)
            case Details(_, inner):
                result += _pictures(inner)
            case Columns(columns):
                result += [svg for item in columns for svg in _pictures(item)]
    return result


class _Writer:
    """A writer of blocks, which counts the pictures and knows the anchors that links lead to."""

    def __init__(self, folder: str, wanted: frozenset[str]) -> None:
        self._folder = folder
        self._wanted = wanted
        self._pictures = count(1)

    def blocks(self, blocks: Sequence[Block]) -> list[str]:
        return [piece for block in blocks for piece in self._block(block)]

    def _block(self, block: Block) -> list[str]:
        match block:
            case Heading(words, anchor, level):
                return [*self._anchors([anchor]), f"{'#' * level} {plain(words)}"]
            case Paragraph(words):
                return [text(words)]
            case EquationBlock(rows):
                anchors = [item for row in rows for item in (row.anchor, *(part.anchor for part in row.parts))]
                return [*self._anchors(anchors), _equations(rows)]
            case TableBlock():
                return [*([f"*{plain(block.caption)}*"] if block.caption else []), _table(block)]
            case Picture(_, alt, caption):
                name = f"picture-{next(self._pictures)}.svg"
                shown = f"![{plain(alt)}]({self._folder}/{name})" if self._folder else f"> {plain(alt)}"
                return [shown, *([f"*{plain(caption)}*"] if caption else [])]
            case Listing():
                return [*([f"*{plain(block.caption)}*"] if block.caption else []), *_listing(block)]
            case Details(summary, inner):
                return [f"<details><summary>{_html(summary)}</summary>", *self.blocks(inner), "</details>"]
            case Columns(columns):
                return [piece for item in columns for piece in self.blocks(item)]

    def _anchors(self, anchors: Sequence[str]) -> list[str]:
        wanted = [item for item in anchors if item in self._wanted]
        return ["".join(f'<a id="{_html(item)}"></a>' for item in wanted)] if wanted else []


def text(words: Text) -> str:
    """Text with its formulas, links and words of code."""
    shown = "".join(_inline(part) for part in words)
    return re.sub(r"^([-+]|\d+(?=[.)]))", _guarded, shown)


def _guarded(result: re.Match[str]) -> str:
    return f"\\{result[1]}" if result[1] in "-+" else f"{result[1]}\u200b"


def plain(words: str) -> str:
    """Text in which the marks of Markdown are escaped."""
    joined = " ".join(words.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").split("\n"))
    return re.sub(r"([\\`*_{}\[\]#|~$!])", r"\\\1", joined)


def _html(words: str) -> str:
    return words.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace('"', "&quot;")


def _inline(part: str | Math | Hyperlink | CodeSpan | Strong) -> str:
    match part:
        case str():
            return plain(part)
        case Math(formula):
            return f"${math(formula)}$"
        case Hyperlink(words, to):
            return f"[{plain(words)}](<{address(to).replace('<', '%3C').replace('>', '%3E')}>)"
        case CodeSpan(words):
            return _code(words)
        case Strong(words):
            return f"**{plain(words)}**"


def math(formula: Formula) -> str:
    """A formula within a line."""
    return _safer(latex_math(formula, _odd))


def _safer(shown: str) -> str:
    return re.sub(r"\\[{},\\]|[<>]", lambda result: SAFER[result[0]], shown)


def _odd(words: str) -> str:
    """A word within a formula, in which the marks of LaTeX, Markdown and HTML are escaped."""
    return "".join(c if c.isalnum() or c in " .:;()/+=-" else "?" for c in words)


def _code(words: str) -> str:
    longest = max((len(run) for run in re.findall("`+", words)), default=0)
    fence, room = "`" * (longest + 1), " " if words[:1] in ("`", " ") or words[-1:] in ("`", " ") else ""
    return f"{fence}{room}{words}{room}{fence}" if words else ""


def _equations(rows: Sequence[Equation]) -> str:
    shown = " \\\\\n".join(_equation(item) for item in rows)
    return f"```math\n\\begin{{align}}\n{shown}\n\\end{{align}}\n```"


def _equation(equation: Equation) -> str:
    tag = f"\\tag{{{_odd(equation.number)}}}" if equation.number else "\\notag"
    return equation_latex(equation, ROOM, tag, _odd)


def _table(table: TableBlock) -> str:
    sides = [SIDES[item] for item in table.align.ljust(len(table.head), "l")]
    rows = [table.head, *(tuple(cell.text for cell in row) for row in table.rows)]
    shown = [_row([_cell(words) for words in row]) for row in rows]
    return "\n".join([shown[0], _row(sides), *shown[1:]])


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _cell(words: Text) -> str:
    return "".join(_inline(part).replace("|", "\\|") if isinstance(part, CodeSpan) else _inline(part) for part in words)


def _listing(listing: Listing) -> list[str]:
    """A block of code for each run of lines that follow each other."""
    runs: list[list[str]] = [[]]
    for line, gap in zip(listing.lines, gaps(listing.lines), strict=True):
        runs += [[]] if gap else []
        runs[-1].append(line.text)
    longest = max((len(run) for line in listing.lines for run in re.findall("`+", line.text)), default=0)
    fence = "`" * max(3, longest + 1)
    return ["\n".join([f"{fence}{listing.language}", *run, fence]) for run in runs if run]
