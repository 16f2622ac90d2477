"""The page of the audit, and how its formulas are read, broken and made of components."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache

import pytest
import sympy as sp

from derive.mechanics.symbols import Family, vector
from derive.report.document.formula import Equation, Fenced, FormulaRow, Name, OperatorToken
from derive.report.document.page import EquationBlock, Heading, Hyperlink, Page, Paragraph, TableBlock
from derive.report.notation.formula_reader import equation, formula
from derive.report.notation.spoken_math import words
from derive.report.notation.vector_form import arrow, summand, summands
from derive.report.paper_audit import SECTIONS, audit_page
from derive.report.paper_audit.page import broken, counts

ROWS = tuple(row for section in SECTIONS for row in section.rows)


@cache
def page() -> Page:
    return audit_page()


def equations() -> list[Equation]:
    return [row for block in page().blocks if isinstance(block, EquationBlock) for row in block.rows]


def test_page_shows_each_row_with_what_is_derived_and_its_tests() -> None:
    numbers = [equation.number for equation in equations() if equation.number]
    for row in ROWS:
        own = [n for n in numbers if re.match(rf"{row.number}(\s|$)", n)]
        assert own[0] == row.number and len(own) == 2 + bool(row.misread), row.number
        told = [repr(block) for block in page().blocks if isinstance(block, Paragraph)]
        for test in row.tests:
            assert any(test in text for text in told)


def test_page_counts_its_verdicts() -> None:
    table = next(block for block in page().blocks if isinstance(block, TableBlock) and block.caption == "Verdicts")
    shown = {row[0].text[0]: row[1].text[0] for row in table.rows}
    assert shown == {verdict: str(n) for verdict, n in counts(ROWS).items()}
    assert sum(counts(ROWS).values()) == len(ROWS) == 53


def test_links_of_the_page_lead_somewhere() -> None:
    anchors = {block.anchor for block in page().blocks if isinstance(block, Heading)}
    anchors |= {equation.anchor for equation in equations() if equation.anchor}
    cells = [cell for block in page().blocks if isinstance(block, TableBlock) for row in block.rows for cell in row]
    links = {part.to for cell in cells for part in cell.text if isinstance(part, Hyperlink)}
    assert len(links) == len(ROWS) and {link.removeprefix("#") for link in links} <= anchors


def test_page_is_written_in_every_language() -> None:
    """The renderers' own tests look closer; here that they take all that the audit holds."""
    from derive.report.writers.html import html
    from derive.report.writers.latex import latex
    from derive.report.writers.markdown import markdown

    shown = html(page())
    assert all(f"({row.number})" in shown for row in ROWS) and len(shown) < 300_000
    for text in (latex(page()), markdown(page())):
        assert "\\nabla" in text and "\\text{?}" not in text


def test_long_brackets_are_broken_and_keep_what_they_hold() -> None:
    """The pieces of a line hold the same names in the same order as the line."""
    for row in ROWS:
        for line in (*row.shown, *row.lines):
            whole = equation(line, row.scalars)
            assert _leaves(whole.parts) == _leaves(broken(whole).parts), line


def _leaves(parts: Iterable) -> list[str]:
    text = " ".join(f"{part.sign} {_flat(part.formula)}" for part in parts)
    return text.removeprefix("+ ").split()


def _flat(formula: object) -> str:
    if isinstance(formula, FormulaRow):
        return " ".join(map(_flat, formula.parts))
    if isinstance(formula, Fenced):
        return f"{formula.left} {_flat(formula.of)} {formula.right}"
    return formula.text if isinstance(formula, OperatorToken) else repr(formula).replace(" ", "")


def test_vectors_are_read_back_from_components_or_refused() -> None:
    r, omega = arrow("r"), vector(Family.ANGULAR_VELOCITY, 3)
    part = summand(-3 * omega.cross(omega.cross(r)))
    assert (part.sign, words(part.formula)) == ("-", "3 omega cross open bracket omega cross r close bracket")
    assert len(summands(omega.cross(r) + arrow("rdot"))) == 2
    with pytest.raises(ArithmeticError, match="no product"):
        summand(sp.Matrix([r[1], r[0], r[2]]))


def test_lines_that_cannot_be_read_are_refused() -> None:
    assert formula("omega'_1") == Name("omega", 1, ("1",), style="vector")
    for text in ("Q . {X + u", "c_{i", "what", "x ~ 1", "+ )"):
        with pytest.raises(ValueError, match="'"):
            equation(text)
