"""docs/hosts.md: its commands run as printed; it has every interface, every return code, and the versions tried."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from programs import version

from conftest import ROOT
from derive.backends.c.source import ABI
from derive.export.registry import INTERFACES
from derive.ir.statements import ReturnCode
from markdown_pages import copy_tree, run_page

PAGE = ROOT / "docs/hosts.md"
TEXT = PAGE.read_text()


@pytest.mark.hosts
def test_the_commands_of_the_page(tmp_path: Path) -> None:
    said = run_page(PAGE, copy_tree(tmp_path)).values()
    assert any("100% tests passed" in text for text in said)


def rows(heading: str) -> list[list[str]]:
    """The cells of the rows of the table behind a heading, or behind another line."""
    lines = TEXT.split(f"{heading}\n", 1)[1].lstrip("\n").splitlines()
    table = lines[: next((n for n, line in enumerate(lines) if not line.startswith("|")), len(lines))]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table[2:]]


def test_every_interface_has_a_section_and_a_row() -> None:
    headings = [line for line in TEXT.splitlines() if line.startswith("## ")]
    stated = " ".join(row[0] for row in rows("## What a host has to know"))
    for kind in INTERFACES:
        assert any(f"`{kind}`" in heading for heading in headings), kind
        assert f"`{kind}`" in stated, kind


def test_every_return_code_has_a_row() -> None:
    """The page has the codes of the models, and those of the integrators by their names in the headers."""
    stated = {int(row[0]): row for row in rows("## Return codes")}
    assert all(row[3] for row in stated.values())
    codes = {int(code): "" for code in ReturnCode}
    for header in ("fixed_step.h", "adaptive.h", "ida.h", "ode.h"):
        text = (ROOT / "templates/host" / header).read_text()
        found = re.findall(r"^(?: +|enum \{ )(TISSERAND_\w+) = (\d+)", text, re.MULTILINE)
        codes |= {int(number): name for name, number in found if int(number) not in codes}
    assert codes.keys() == stated.keys()
    assert all(f"`{name}`" in stated[code][1] for code, name in codes.items() if name)


def test_the_number_of_the_interface_is_stated() -> None:
    assert f"It is now {ABI}." in TEXT and f"find_package(crank_slider_3 {ABI})" in TEXT


VERSIONS = {name: stated for names, stated in rows("## Versions tried") for name in names.split(", ")}


@pytest.mark.hosts
@pytest.mark.parametrize("name", VERSIONS)
def test_versions_are_those_that_are_tried(name: str) -> None:
    """The first number: distributions change the others."""
    assert version(name).split(".")[0] == VERSIONS[name].split(".")[0], f"tried with {version(name)}: write this"
