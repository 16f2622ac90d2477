"""Pages stay small and readable: with eight shapes, and with forty modes."""

from __future__ import annotations

import re
from pathlib import Path

import pages
import pytest

from conftest import ROOT
from derive.pipeline import build
from derive.report.document.page import FOLDED, SHOWN, folded, table
from derive.report.model_page import model_page
from derive.report.scene_page import scene_page
from derive.report.sections.files import SpecificationText
from derive.report.writers.html import html


def without_pictures(name: str) -> int:
    return len(re.sub(r"<svg.*?</svg>", "", html(pages.page(name)), flags=re.S).encode())


@pytest.mark.parametrize("name", ["beam_mean_8", "beam_point_8", "block", "forty"])
def test_pages_are_below_310_kb_without_pictures(name: str) -> None:
    assert without_pictures(name) < 310_000


def test_a_page_of_many_instances_is_hardly_longer(tmp_path: Path) -> None:
    """Besides pictures and tables of numbers, which are folded, it is that of few."""
    sizes = []
    for count in (5, 15):
        text = (ROOT / "examples" / "chain_100.toml").read_text().replace("count = 99", f"count = {count - 1}")
        path = tmp_path / "chain.toml"
        path.write_text(
            text.replace("count = 100", f"count = {count}").replace("[scene]", '[scene]\nlowering = "instances"')
        )
        page = html(scene_page(build(path), SpecificationText("chain.toml", "")))
        sizes.append(len(re.sub(r"<svg.*?</svg>", "", page, flags=re.S)))
    assert sizes[1] <= 1.01 * sizes[0]


def test_many_modes_are_counted_not_listed() -> None:
    blocks = pages.page_blocks("forty")
    assert sum(len(t.rows) for t in pages.tables(blocks)) < 200
    assert sum(len(line.parts) for line in pages.equations(blocks)) < 200
    (integrals,) = pages.tables(pages.section("forty", "integrals"))
    counts = {pages.plain(row[0].text): int(pages.plain(row[2].text)) for row in integrals.rows}
    assert counts["C sub 5"] == 6 * 40 * 41 // 2 and counts["c sub 7"] == 3 * 40 * 39 // 2
    said = pages.plain(next(b for b in pages.section("forty", "mass")).text)
    assert "292 of 2116 entries" in said


def test_long_tables_are_folded() -> None:
    def rows(n: int):
        return folded(table("", ("a",), [[k] for k in range(n)]), "numbers")

    assert len(rows(SHOWN).rows) == SHOWN
    assert rows(SHOWN + 1).summary == f"numbers: {SHOWN + 1}" and len(rows(SHOWN + 1).blocks[0].rows) == SHOWN + 1
    assert rows(FOLDED + 1).summary == f"numbers: the first {SHOWN} of {FOLDED + 1}"
    assert len(rows(FOLDED + 1).blocks[0].rows) == SHOWN


def test_the_same_body_gives_the_same_page() -> None:
    again = model_page(pages.built("block"), pages.given("block"))
    assert again == pages.page("block")
    assert html(again) == html(pages.page("block"))
