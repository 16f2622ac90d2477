"""The page of the audit: tables of rows, long equations in full, statements in words, assumptions."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Literal

from derive.report.document.formula import Equation, Fenced, FormulaRow, OperatorToken, Part
from derive.report.document.page import (
    Block,
    Cell,
    CodeSpan,
    EquationBlock,
    Heading,
    Hyperlink,
    Math,
    Page,
    Paragraph,
    Strong,
    TableBlock,
    Text,
)
from derive.report.notation.expressions import row as in_a_row
from derive.report.notation.formula_reader import equation, marked_text, summands
from derive.report.notation.line_breaking import width
from derive.report.notation.spacing import factors
from derive.report.notation.spoken_math import words as spoken
from derive.report.paper_audit.model import Assumption, AuditRow, AuditSection, Statement, Verdict

LONG = 18.0
"""The width (em) above which a bracket is broken."""

Mark = Literal["", "zero", "entry", "good", "bad"]

TITLE = "The paper, equation by equation"
SUBTITLE = (
    "W. P. Koppens, A. A. H. J. Sauren, F. E. Veldpaus, D. H. van Campen: The dynamics of a deformable body "
    "experiencing large displacements. Journal of Applied Mechanics 55 (1988), 676-680"
)
MEANINGS: dict[Verdict, str] = {
    "equal": "The derivation gives the equation as the text shows it; a test compares the two.",
    "equal after the correction": "The derivation gives the equation once the errors of the recognised text are "
    "corrected; a test compares the two.",
    "definition": "The statement defines a name; the place of the definition in Tisserand is given.",
    "assumption": "The statement is a choice; in Tisserand the specification makes it.",
}
MARKS: dict[str, Mark] = {
    "equal": "good",
    "equal after the correction": "good",
    "holds": "good",
    "holds after the correction": "good",
    "not compared": "bad",
}


def build(sections: Sequence[AuditSection], statements: Sequence[Statement], assumptions: Sequence[Assumption]) -> Page:
    """The page of these rows. Everything that is derived is derived now."""
    rows = [row for section in sections for row in section.rows]
    blocks: list[Block] = [*_introduction(rows)]
    blocks.append(_overview(sections))
    for section in sections:
        blocks.append(Heading(section.title, section.anchor))
        blocks += [block for row in section.rows for block in _record(row)]
    blocks += [*_statements(statements), *_assumptions(assumptions)]
    return Page(TITLE, (SUBTITLE,), tuple(blocks))


def counts(rows: Sequence[AuditRow]) -> dict[Verdict, int]:
    """The number of rows with each verdict."""
    return {verdict: sum(row.verdict == verdict for row in rows) for verdict in MEANINGS}


def _introduction(rows: Sequence[AuditRow]) -> Iterator[Block]:
    yield Paragraph(
        marked_text(
            "This page compares every equation of the paper, and every line of its appendix, with what Tisserand "
            "derives. The text of the paper went through character recognition, which loses dots and mistakes letters; "
            "this page shows it as it came out. No derivation uses the printed equations: they follow from $x = c + Q "
            ". (X + u)$ and virtual work. The column of derived equations is computed for this page; terms in "
            "components are read back as products of vectors, which have the same components."
        )
    )
    yield Paragraph(
        marked_text(
            "A row is called equal only if a test compares the equation. Another test checks that each named test "
            "exists and uses the equation, and evaluates every formula shown, with its correction. Tests are named as "
            "`file::name` in the folder `tests/paper`. If the derivation does not need an equation, a test derives it. "
            "Vectors and columns are bold italic, tensors and matrices bold."
        )
    )
    result = counts(rows)
    yield TableBlock(
        "Verdicts",
        (("Verdict",), ("Rows",), ("Meaning",)),
        tuple(
            (Cell((verdict,), mark=MARKS.get(verdict, "")), Cell((str(result[verdict]),)), Cell((meaning,)))
            for verdict, meaning in MEANINGS.items()
        ),
        align="lrl",
    )


def _overview(sections: Sequence[AuditSection]) -> TableBlock:
    """The table of all equations, with one line for each."""
    return TableBlock(
        "The equations and their verdicts",
        (("",), ("Equation",), ("Verdict",), ("Tests",)),
        tuple(
            (
                Cell((Hyperlink(name(row), f"#{row.anchor}"),)),
                Cell((row.title,)),
                Cell((row.verdict,), title=plain(row.correction), mark=MARKS.get(row.verdict, "")),
                Cell((str(len(row.tests)),)),
            )
            for section in sections
            for row in section.rows
        ),
        align="lllr",
    )


def name(row: AuditRow) -> str:
    """The name of a row in the paper: (5), or J of the appendix."""
    return f"({row.number})" if row.number.isdigit() else row.number


def _record(row: AuditRow) -> Iterator[Block]:
    """The blocks of a row: its description, its formulas below each other, its tests."""
    words = " ".join(part for part in (row.correction, row.note) if part)
    places = (" Here: ", *_listed(row.where)) if row.where else ()
    yield Paragraph(
        (Strong(f"{name(row)} {row.title}"), f": {row.verdict}. ", *marked_text(words, row.scalars), *places)
    )
    yield EquationBlock(
        (
            *_numbered(_read(row, row.shown), row.number, row.anchor),
            *_numbered(_read(row, row.lines if row.misread else ()), f"{row.number} corrected"),
            *_numbered(row.derived() if row.derived else map(equation, row.stated), f"{row.number} {row.source}"),
        )
    )
    yield Paragraph(tests(row.tests))


def _read(row: AuditRow, lines: Sequence[str]) -> tuple[Equation, ...]:
    return tuple(broken(equation(line, row.scalars)) for line in lines)


def broken(equation: Equation) -> Equation:
    """An equation whose long brackets are several parts, between which it may break on a narrow page."""
    return replace(equation, parts=tuple(piece for part in equation.parts for piece in _pieces(part)))


def _pieces(part: Part) -> Sequence[Part]:
    """The summands of the long bracket in a part, if there is one: the first opens the bracket, the last closes it."""
    items = factors(FormulaRow((part.formula,)))
    long = [(k, item) for k, item in enumerate(items) if isinstance(item, Fenced) and width(item) > LONG]
    if len(long) != 1:
        return (part,)
    ((at, bracket),) = long
    first, *others = summands(factors(FormulaRow((bracket.of,))))
    if not others:
        return (part,)
    sign = [OperatorToken("-")] if first.sign == "-" else []
    opening = in_a_row([*items[:at], OperatorToken(bracket.left), *sign, first.formula])
    closing = in_a_row([others[-1].formula, OperatorToken(bracket.right), *items[at + 1 :]])
    return (replace(part, formula=opening), *others[:-1], replace(others[-1], formula=closing))


def _numbered(equations: Iterable[Equation], number: str, anchor: str = "") -> Iterator[Equation]:
    """The equations, of which the first gets the number and the anchor."""
    for k, item in enumerate(equations):
        yield item if k else replace(item, number=number, anchor=anchor)


def tests(names: Sequence[str]) -> Text:
    """The names of tests."""
    return ("Tests: " if len(names) > 1 else "Test: ", *_listed(names)) if names else ("No test.",)


def _listed(words: Sequence[str]) -> Text:
    """Words of code with commas between them."""
    return tuple(part for k, item in enumerate(words) for part in (", " if k else "", CodeSpan(item)) if part)


def _statements(statements: Sequence[Statement]) -> Iterator[Block]:
    yield Heading("Statements in words", "statements")
    yield Paragraph(("These are statements of the paper besides its equations, each with whether it holds.",))
    for s in statements:
        first = (Strong(s.place[0].upper() + s.place[1:]), f": {s.verdict}. The text: ")
        yield Paragraph((*first, *marked_text(s.shown), " Here: ", *marked_text(s.holds), " ", *tests(s.tests)))


def _assumptions(assumptions: Sequence[Assumption]) -> Iterator[Block]:
    yield Heading("Assumptions", "assumptions")
    yield Paragraph(
        (
            "The table lists the assumptions of the paper, most of them in words, with the option of a specification "
            "that lifts each of them, if there is one.",
        )
    )
    yield TableBlock(
        "Assumptions and options",
        (("Assumption",), ("Option",), ("What it lifts",)),
        tuple(
            (
                Cell((*marked_text(a.name), f"; {a.place}. ", *marked_text(a.here))),
                Cell(_listed(a.options) or ("none",)),
                Cell(marked_text(a.lifts)),
            )
            for a in assumptions
        ),
        align="lll",
    )


def plain(text: str) -> str:
    """Marked text in words, for tooltips."""
    return "".join(spoken(part.formula) if isinstance(part, Math) else _words(part) for part in marked_text(text))


def _words(part: str | CodeSpan) -> str:
    return part if isinstance(part, str) else part.text
