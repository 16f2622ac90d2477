"""A page as a document for Typst, and as PDF. All text is in strings, so that none of it is markup."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path

from derive.artifacts import MARK
from derive.errors import TisserandError
from derive.rendering import render
from derive.report.document.anchors import address, targets
from derive.report.document.formula import Equation, Formula
from derive.report.document.page import (
    Block,
    Cell,
    CodeLine,
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
from derive.report.notation.spoken_math import words
from derive.report.writers.equation_html import LONG
from derive.report.writers.listings import comments
from derive.report.writers.picture import standalone
from derive.report.writers.typst_math import relation_typst, string, summand_typst, typst_math

SIDES = {"l": "left", "r": "right", "c": "center"}


def typst(page: Page) -> str:
    """The page as a document for Typst."""
    writer = _Writer(targets(page))
    values = {
        "mark": MARK,
        "title": string(page.title),
        "subtitle": writer.text(page.subtitle) if page.subtitle else "none",
        "body": writer.blocks(page.blocks),
    }
    return render("report/page.typ.jinja", values)


def _list(parts: Sequence[str]) -> str:
    return f"({', '.join(parts)}{',' if len(parts) == 1 else ''})"


class _Writer:
    """A writer of blocks, which knows the names of all anchors that links lead to."""

    def __init__(self, names: Mapping[str, str]) -> None:
        self._names = names
        self._placed: set[str] = set()

    def blocks(self, blocks: Sequence[Block]) -> str:
        return "\n".join(self._block(block) for block in blocks)

    def _block(self, block: Block) -> str:
        match block:
            case Heading(content, anchor, level):
                return f"heading(level: {level - 1}, {string(content)})\n{self._place(anchor)}"
            case Paragraph(content):
                return f"par({self.text(content)})"
            case EquationBlock(rows):
                return f"rows({', '.join(self._equation(item) for item in rows)})"
            case TableBlock():
                return self._table(block)
            case Picture(svg, alt, caption):
                shown = string(caption) if caption else "none"
                return f"picture({string(standalone(svg))}, {string(alt)}, {shown})"
            case Listing():
                lines = zip(block.lines, comments(block), strict=True)
                shown = ", ".join(self._line(line, comment) for line, comment in lines)
                return f"listing({string(block.caption)}, {shown})"
            case Details(summary, inner):
                return f"details({string(summary)}, {{\n{self.blocks(inner)}\n}})"
            case Columns(columns):
                return self._columns(columns)

    def text(self, content: Text) -> str:
        return "{ " + "; ".join(self._inline(part) for part in content) + " }"

    def _inline(self, part: str | Math | Hyperlink | CodeSpan | Strong) -> str:
        match part:
            case str():
                return string(part)
            case Math(formula):
                return math(formula)
            case Hyperlink(content, to):
                name = self._names.get(to[1:])
                if to.startswith("#"):
                    return f'link(label("{name}"), {string(content)})' if name else string(content)
                return f"link({string(address(to))}, {string(content)})"
            case CodeSpan(content):
                return f"raw({string(content)})"
            case Strong(content):
                return f"strong({string(content)})"

    def _place(self, anchor: str) -> str:
        return "".join(f"at({name})" for name in self._new([anchor]))

    def _new(self, anchors: Sequence[str]) -> list[str]:
        """The names of those anchors that have not been written yet."""
        names = list(dict.fromkeys(self._names[item] for item in anchors if item))
        result = [name for name in names if name not in self._placed]
        self._placed.update(result)
        return [string(name) for name in result]

    def _equation(self, equation: Equation) -> str:
        numbered = list(enumerate(equation.parts))
        groups = [(name, list(some)) for name, some in groupby(numbered, lambda item: item[1].group)]
        listed = len(numbered) > LONG and len(groups) > 1
        shown = [
            f"(name: {string(name if listed else '')}, pieces: "
            f"{_list([_display(summand_typst(part, k == 0), words(part.formula)) for k, part in some])})"
            for name, some in groups
        ]
        anchors = (equation.anchor, *(part.anchor for part in equation.parts))
        return (
            f"(left: {_display(typst_math(equation.left), words(equation.left))}, "
            f"relation: {_display(relation_typst(equation.relation), equation.relation)}, groups: {_list(shown)}, "
            f"number: {string(equation.number)}, places: {_list(self._new(anchors))})"
        )

    def _table(self, table: TableBlock) -> str:
        align = table.align.ljust(len(table.head), "l")
        size = "9pt" if len(table.head) < 8 else "7.5pt" if len(table.head) < 12 else "6pt"
        head = _list([self.text(content) for content in table.head])
        cells = _list([self._cell(cell) for row in table.rows for cell in row])
        caption = string(table.caption) if table.caption else "none"
        return f"tabular({caption}, {size}, {_list([SIDES[item] for item in align])}, {head}, {cells})"

    def _cell(self, cell: Cell) -> str:
        return f'cell("{cell.mark}", {self.text(cell.text)})'

    def _line(self, line: CodeLine, comment: tuple[int, int]) -> str:
        indent = len(line.text) - len(line.text.lstrip())
        code = "\u00a0" * indent + line.text[indent:]
        start, stop = comment
        pieces = [code[:start], code[start:stop], code[stop:]]
        shown = [f"raw({string(pieces[0])})", f"note(raw({string(pieces[1])}))", f"raw({string(pieces[2])})"]
        body = "; ".join(item for item, piece in zip(shown, pieces, strict=True) if piece)
        place = self._new([line.anchor])
        links = _list([self._inline(link) for link in line.links])
        return (
            f'(number: "{line.number}", place: {place[0] if place else string("")}, code: {{ {body} }}, links: {links})'
        )

    def _columns(self, columns: Sequence[Sequence[Block]]) -> str:
        narrow = all(isinstance(block, Picture | Paragraph | Heading) for column in columns for block in column)
        bodies = [f"{{\n{self.blocks(column)}\n}}" for column in columns]
        if not narrow:
            return "\n".join(bodies)
        return f"grid(columns: {_list(['1fr'] * len(bodies))}, gutter: 1.5em, {', '.join(bodies)})"


def math(formula: Formula) -> str:
    """A formula within text, with its words."""
    return f"math.equation(alt: {string(words(formula))}, ${typst_math(formula)}$)"


def _display(shown: str, content: str) -> str:
    """A piece of an equation; there may be nothing to show."""
    if not shown.strip():
        return "[]"
    return f"math.equation(alt: {string(content)}, $display({shown})$)"


class TypstMissing(TisserandError):
    """The wheel that makes PDF is not installed."""


def pdf(page: Page) -> bytes:
    """The page as PDF: the same bytes for the same page and versions of Typst and Matplotlib. Raises TypstMissing.

    The fonts are those of Typst, and for pictures that of Matplotlib, with whose metrics they are laid out.
    """
    try:
        import typst as wheel
    except ImportError as error:
        raise TypstMissing("PDF needs the Python package typst: pip install 'tisserand[report]'") from error
    import matplotlib as mpl

    fonts = wheel.Fonts(include_system_fonts=False, font_paths=[Path(mpl.get_data_path()) / "fonts" / "ttf"])
    made: bytes = wheel.compile(typst(page).encode(), format="pdf", font_paths=fonts, timestamp=0)
    return made
