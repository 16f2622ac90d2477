"""The page of the audit: tables of rows, long equations in full, statements in words, assumptions."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Literal

from derive.report.document.formula import Equation
from derive.report.document.page import (
    Block,
    Cell,
    CodeSpan,
    EquationBlock,
    Heading,
    Hyperlink,
    Inline,
    Math,
    Page,
    Paragraph,
    Strong,
    TableBlock,
    Text,
)
from derive.report.notation.formula_reader import equation, formula
from derive.report.notation.spoken_math import words as spoken
from derive.report.paper_audit.breaking import broken
from derive.report.paper_audit.model import Assumption, AuditRow, AuditSection, Statement, Verdict

Mark = Literal["", "zero", "entry", "good", "bad"]

TITLE = "The paper, equation by equation"
SUBTITLE = (
    "W. P. Koppens, A. A. H. J. Sauren, F. E. Veldpaus, D. H. van Campen: The dynamics of a deformable body "
    "experiencing large displacements. Journal of Applied Mechanics 55 (1988), 676-680"
)
MEANINGS: dict[Verdict, str] = {
    "equal": "The equation as the text shows it is what is derived, and a test compares the two.",
    "equal after the correction": "So it is, once the faults of the recognised text are mended; a test compares it.",
    "definition": "It says what a name means; the place that says so here is named.",
    "assumption": "It is chosen: here the specification chooses.",
}
MARKS: dict[str, Mark] = {
    "equal": "good",
    "equal after the correction": "good",
    "holds": "good",
    "holds after the correction": "good",
    "not compared": "bad",
}
DERIVED = {"the package": "derived", "a test": "derived in a test", "the user": "specified"}


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
            "Every equation of the paper and every line of its appendix, beside what this tool derives. The text of "
            "the paper went through character recognition, which loses dots and mistakes letters: it is written down "
            "as it came out. The printed equations are used by nothing that derives; what is derived comes out of $x "
            "= c + Q . (X + u)$ and virtual work, and the column that shows it is computed for this page: terms in "
            "components are read back as products of vectors, and have the same components."
        )
    )
    yield Paragraph(
        marked_text(
            "A row is called equal only where a test compares the equation; another test holds this page against the "
            "marks of the tests, in both directions, and evaluates every formula shown, with its correction, against "
            "what they compare. Tests are named as `file::name` in the folder `tests/paper`. Where the derivation does "
            "without an equation, a test derives it. Vectors and columns are bold italic, tensors and matrices bold."
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
    places = tuple(part for k, where in enumerate(row.where) for part in (", " if k else " Here: ", CodeSpan(where)))
    yield Paragraph(
        (Strong(f"{name(row)} {row.title}"), f": {row.verdict}. ", *marked_text(words, row.scalars), *places)
    )
    yield EquationBlock(
        (
            *_numbered(_read(row, row.shown), row.number, row.anchor),
            *_numbered(_read(row, row.holds), f"{row.number} corrected"),
            *_numbered(row.derived(), f"{row.number} {DERIVED[row.by]}"),
        )
    )
    yield Paragraph(tests(row.tests))


def _read(row: AuditRow, lines: Sequence[str]) -> tuple[Equation, ...]:
    return tuple(broken(equation(line, row.scalars)) for line in lines)


def _numbered(equations: Sequence[Equation], number: str, anchor: str = "") -> Iterator[Equation]:
    """The equations, of which the first gets the number and the anchor."""
    for k, item in enumerate(equations):
        yield item if k else replace(item, number=number, anchor=anchor)


def tests(names: Sequence[str]) -> Text:
    """The node ids of tests, without the folder."""
    short = [test.removeprefix("tests/paper/") for test in names]
    result = tuple(part for k, item in enumerate(short) for part in (", " if k else "", CodeSpan(item)) if part)
    return ("Tests: " if len(short) > 1 else "Test: ", *result) if short else ("No test.",)


def _statements(statements: Sequence[Statement]) -> Iterator[Block]:
    yield Heading("Statements in words", "statements")
    yield Paragraph(
        ("What the paper says besides its equations, where this tool can tell whether it holds, and where not.",)
    )
    for s in statements:
        first = (Strong(s.place[0].upper() + s.place[1:]), f": {s.verdict}. The text: ")
        yield Paragraph((*first, *marked_text(s.shown), " Here: ", *marked_text(s.holds), " ", *tests(s.tests)))


def _assumptions(assumptions: Sequence[Assumption]) -> Iterator[Block]:
    yield Heading("Assumptions", "assumptions")
    yield Paragraph(
        (
            "What the paper assumes, mostly in words, and the option of a specification that lifts it, where there is "
            "one.",
        )
    )
    yield TableBlock(
        "Assumptions and options",
        (("Assumption",), ("Option",), ("What it lifts",)),
        tuple(
            (
                Cell((*marked_text(a.name), f"; {a.place}. ", *marked_text(a.here))),
                Cell(_options(a)),
                Cell(marked_text(a.lifts)),
            )
            for a in assumptions
        ),
        align="lll",
    )


def _options(assumption: Assumption) -> Text:
    if not assumption.options:
        return ("none yet",)
    return tuple(
        part for k, item in enumerate(assumption.options) for part in (", " if k else "", CodeSpan(item)) if part
    )


def plain(text: str) -> str:
    """Words without markup, for tooltips."""
    return re.sub(r"\$([^$]*)\$", lambda result: spoken(formula(result[1])), text).replace("`", "")


def marked_text(text: str, scalars: bool = False) -> Text:
    """Words with formulas between dollar signs and code between backticks."""
    result: list[Inline] = []
    for part in re.split(r"(\$[^$]*\$|`[^`]*`)", text):
        if part.startswith("$"):
            result.append(Math(formula(part[1:-1], scalars)))
        elif part.startswith("`"):
            result.append(CodeSpan(part[1:-1]))
        elif part:
            result.append(part)
    return tuple(result)
