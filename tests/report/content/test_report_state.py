"""Coordinates, velocities and symbols: the tables are complete, and the two meanings of c are distinguished."""

from __future__ import annotations

import pages
import pytest

from derive.report.document.page import Details


@pytest.mark.parametrize("name", ["block", "loops", "rigid", "flat"])
def test_all_velocities_of_a_body_in_space_are_listed(name: str) -> None:
    model = pages.built(name).model
    (table,) = (t for t in pages.tables(pages.section(name, "coordinates")) if t.caption == "Generalised velocities v")
    assert [pages.plain(row[1].text) for row in table.rows] == [v.name for v in model.velocities]


@pytest.mark.parametrize("name", ["mean", "block"])
def test_the_nomenclature_tells_position_from_integrals(name: str) -> None:
    blocks = pages.section(name, "nomenclature")
    text = pages.plain(blocks[0].text)
    assert "the letter c has two meanings" in text and "component 1 of the first shape integral" in text
    (folded,) = (block for block in blocks if isinstance(block, Details))
    symbols = [pages.plain(row[0].text) for row in folded.blocks[0].rows]
    assert len(set(symbols)) == len(symbols)
    assert {"c", "c sub 1", "c sub 8", "alpha sub i", "M"} <= set(symbols)


@pytest.mark.parametrize("name", ["mean", "block", "heavy"])
def test_terms_that_vanish_are_counted_by_reason(name: str) -> None:
    vanished = pages.built(name).equations.vanished
    tables = pages.tables(pages.section(name, "zeros"))
    (table,) = (t for t in tables if t.caption == "Terms that vanish, by reason")
    assert len(table.rows) == len({v.reason for v in vanished})
    assert sum(int(row[1].text[0]) for row in table.rows) == len(vanished)
