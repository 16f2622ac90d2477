"""docs/hosts.md: its commands run as printed, it has every interface, and the versions are those that are tried."""

from __future__ import annotations

from pathlib import Path

import pytest

from conftest import ROOT
from derive.export.registry import INTERFACES
from markdown_pages import copy_tree, run_page

PAGE = ROOT / "docs/hosts.md"


@pytest.mark.hosts
def test_the_commands_of_the_page(tmp_path: Path) -> None:
    assert run_page(PAGE, copy_tree(tmp_path))


def test_every_interface_has_a_section() -> None:
    headings = [line for line in PAGE.read_text().splitlines() if line.startswith("## ")]
    for kind in INTERFACES:
        assert any(f"`{kind}`" in heading for heading in headings), kind
