"""Reports give the reason of each zero: of integrals, entries of the mass matrix, terms, and in the picture."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import pages
import pytest

from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.terms import Reason
from derive.report.document.page import Paragraph, Picture
from derive.report.notation.expressions import notation
from derive.report.notation.integral_formulas import reason
from derive.report.sections.mass_matrix import mass_matrix, picture

BODIES = (
    "point",
    "mean",
    "block",
    "loops",
    "beam_point_8",
    "heavy",
    "carrying",
    "flat",
    "loops_given",
    "rigid",
    "forty",
)


def told(name: str, why: Reason | str) -> str:
    return pages.plain(reason(why, notation(pages.built(name).equations)))


@pytest.mark.parametrize("name", BODIES)
def test_every_reason_is_on_the_page(name: str) -> None:
    built = pages.built(name)
    cells = {pages.plain(c.text) for t in pages.tables(pages.page_blocks(name)) for row in t.rows for c in row}
    reasons = {v.reason for v in built.equations.vanished}
    if not isinstance(built.equations, IndexedEquations):
        reasons |= {c.zero for c in built.equations.coefficients if c.zero}
    else:
        reasons |= {t.zero for t in built.equations.tables if t.zero}
    reasons |= set(mass_matrix(built.model, built.equations).reasons.values())
    assert {told(name, r) for r in reasons} <= cells


def test_a_beam_that_carries_a_mass_shows_what_is_left_of_its_zeros() -> None:
    """In the mean frame M of the beam alone is diagonal; a mass in the middle couples what does not vanish there."""
    alone, carrying = (pages.built(name) for name in ("beam_mean_3", "carrying"))
    counts = [len(mass_matrix(built.model, built.equations).entries) for built in (alone, carrying)]
    assert counts == [6, 6 + 2 * (2 + 4 + 1 + 1)]  # c and phi, c and both even shapes, phi and the odd one, even shapes
    cells = {pages.plain(c.text) for t in pages.tables(pages.page_blocks("carrying")) for row in t.rows for c in row}
    assert "condition (19) (no mean rotation) and a zero of the integrand at the attached masses" in cells
    assert "these shapes (no slope at the attached masses)" in cells
    text = "".join(pages.plain(b.text) for b in pages.page_blocks("carrying") if isinstance(b, Paragraph))
    assert "those of the beam without its attached masses" in text


@pytest.mark.parametrize("name", ["point", "mean", "block", "loops", "heavy", "carrying"])
def test_every_vanished_term_is_told_with_its_reason(name: str) -> None:
    vanished = pages.built(name).equations.vanished
    written = notation(pages.built(name).equations)
    tables = [t for t in pages.tables(pages.section(name, "zeros")) if t.caption == "Terms that vanish"]
    rows = [tuple(pages.plain(cell.text) for cell in row) for t in tables for row in t.rows]
    expected = [(v.term.name, written.delta(v.term.row), told(name, v.reason)) for v in vanished]
    assert [(row[0], row[1], row[3]) for row in rows] == expected


@pytest.mark.parametrize("name", BODIES)
def test_zeros_of_the_mass_matrix_are_counted(name: str) -> None:
    built = pages.built(name)
    matrix = mass_matrix(built.model, built.equations)
    assert len(matrix.entries) + len(matrix.reasons) == matrix.size**2
    tables = [t for t in pages.tables(pages.section(name, "mass")) if t.caption == "Zeros of the mass matrix"]
    assert sum(int(row[1].text[0]) for t in tables for row in t.rows) == len(matrix.reasons)


@pytest.mark.parametrize("name", BODIES)
def test_the_picture_tells_the_reason_of_each_zero(name: str) -> None:
    built = pages.built(name)
    matrix = mass_matrix(built.model, built.equations)
    (shown,) = (block for block in pages.section(name, "mass") if isinstance(block, Picture))
    assert shown.svg == picture(matrix) and matrix.count in shown.alt
    root = ElementTree.fromstring(shown.svg)
    cell = int(float(next(e for e in root.iter() if e.get("class") == "none").get("height")))
    frame = next(e for e in root.iter() if e.get("class") == "frame")
    left, top = int(frame.get("x")), int(frame.get("y"))
    found = {}
    for element in root.iter():
        if element.get("class") == "none":
            i, j = (int(element.get("y")) - top) // cell, (int(element.get("x")) - left) // cell
            for k in range(int(element.get("width")) // cell):
                found[i, j + k] = element[0].text.partition(" = 0: ")[2]
    assert found == {place: str(why) for place, why in matrix.reasons.items()}


@pytest.mark.parametrize("name", ["mean", "block"])
def test_the_picture_has_a_square_for_each_entry(name: str) -> None:
    built = pages.built(name)
    matrix = mass_matrix(built.model, built.equations)
    svg = picture(matrix)
    assert len(re.findall('class="value"', svg)) == len(matrix.entries)
    assert len(re.findall('class="zero"', svg)) == len(matrix.reasons)
    for row in built.equations.rows:
        assert notation(built.equations).label(row.name) in svg


def test_both_frames_side_by_side() -> None:
    said = pages.plain(next(b for b in pages.section("mean", "frames")).text)
    assert "5 of 25 in the mean frame against 15 of 25 in the point frame at ξ = 0" in said
    for name, first in (("mean", "mean frame"), ("point", "point frame at ξ = 0"), ("beam_chord_2", "chord frame")):
        (table,) = pages.tables(pages.section(name, "frames"))
        heads = [pages.plain(head) for head in table.head]
        assert heads[1] == first and {"mean frame", "point frame at ξ = 0"} <= set(heads)
        counts = {pages.plain(row[0].text): [int(pages.plain(c.text)) for c in row[1:]] for row in table.rows}
        both = dict(zip(heads[1:], counts["entries of the mass matrix"], strict=True))
        assert (both["mean frame"], both["point frame at ξ = 0"]) == (5, 15)
        operations = dict(zip(heads[1:], counts["operations: mass matrix and forces"], strict=True))
        assert (operations["mean frame"], operations["point frame at ξ = 0"]) == (18, 37)
