"""A page as an article for LaTeX, with amsmath, longtable, booktabs and hyperref."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from derive.artifacts import MARK
from derive.rendering import render
from derive.report.document.anchors import address, targets
from derive.report.document.formula import Equation
from derive.report.document.page import (
    Block,
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
from derive.report.writers.latex_math import equation_latex, latex_math
from derive.report.writers.latex_text import escaped, tabular

ROOM = 29.0
"""The width of a line of formulas, in em, with the number of the equation taken off."""


def latex(page: Page) -> str:
    """The page as LaTeX."""
    title = escaped(page.title)
    writer = _Writer(targets(page))
    values = {
        "mark": MARK,
        "plain": "".join(c for c in page.title if c.isascii() and (c.isalnum() or c in " .,-")),
        "title": f"{title}\\\\[1ex] \\large {writer.text(page.subtitle)}" if page.subtitle else title,
        "body": writer.blocks(page.blocks),
    }
    return render("report/article.tex.jinja", values)


class _Writer:
    """A writer of blocks, which knows the names of all anchors that links lead to."""

    def __init__(self, names: Mapping[str, str]) -> None:
        self._names = names

    def blocks(self, blocks: Sequence[Block]) -> str:
        return "\n\n".join(self._block(block) for block in blocks)

    def _block(self, block: Block) -> str:
        match block:
            case Heading(words, anchor, level):
                kind = "section" if level == 2 else "subsection"
                return f"\\{kind}{{{escaped(words)}}}{self._label(anchor)}"
            case Paragraph(words):
                return self.text(words)
            case EquationBlock(rows):
                return "\n".join(["\\begin{align}", " \\\\\n".join(map(self._equation, rows)), "\\end{align}"])
            case TableBlock():
                return tabular(block, self.text)
            case Picture(_, alt, caption):
                shown = f"\\fbox{{\\parbox{{0.8\\linewidth}}{{\\itshape {escaped(alt)}}}}}"
                words = f"\n\\caption{{{escaped(caption)}}}" if caption else ""
                return f"\\begin{{figure}}[htbp]\n\\centering\n{shown}{words}\n\\end{{figure}}"
            case Listing():
                return self._listing(block)
            case Details(summary, inner):
                return f"\\paragraph{{{escaped(summary)}}}\n\n{self.blocks(inner)}"
            case Columns(columns):
                return "\n\n".join(self.blocks(item) for item in columns)

    def text(self, words: Text) -> str:
        return "".join(map(self._inline, words))

    def _inline(self, part: str | Math | Hyperlink | CodeSpan | Strong) -> str:
        match part:
            case str():
                return escaped(part)
            case Math(formula):
                return f"${latex_math(formula)}$"
            case Hyperlink():
                return self._link(part)
            case CodeSpan(words):
                return f"\\texttt{{{escaped(words)}}}"
            case Strong(words):
                return f"\\textbf{{{escaped(words)}}}"

    def _link(self, link: Hyperlink) -> str:
        words = escaped(link.text)
        if link.to.startswith("#"):
            name = self._names.get(link.to[1:])
            return f"\\hyperref[{name}]{{{words}}}" if name else words
        if not link.to.isascii() or set(link.to) & set('\\{}^ "<>`|'):
            return words
        to = "".join(f"\\{c}" if c in "#%&_$" else c for c in address(link.to))
        return f"\\href{{{to}}}{{{words}}}"

    def _label(self, anchor: str) -> str:
        return f"\\label{{{self._names[anchor]}}}" if anchor else ""

    def _equation(self, equation: Equation) -> str:
        anchors = [item for item in (equation.anchor, *(part.anchor for part in equation.parts)) if item]
        label = self._label(anchors[0]) if anchors else ""
        tag = f"\\tag{{{escaped(equation.number)}}}" if equation.number else "\\tag*{}" if label else "\\notag"
        return equation_latex(equation, ROOM, f"{tag}{label}")

    def _listing(self, listing: Listing) -> str:
        caption = f"\\noindent\\textit{{{escaped(listing.caption)}}}\n" if listing.caption else ""
        body = "\n".join(map(self._line, listing.lines))
        return f"{caption}\\begin{{code}}\n{body}\n\\end{{code}}"

    def _line(self, line: CodeLine) -> str:
        code = line.text.expandtabs(4)
        indent = len(code) - len(code.lstrip())
        links = "".join(f"\\quad\\textrm{{{self._link(link)}}}" for link in line.links)
        place = f"\\phantomsection{self._label(line.anchor)}" if line.anchor else ""
        return f"\\codeline{{{line.number}}}{{{place}{'~' * indent}{escaped(code.lstrip())}{links}}}"
