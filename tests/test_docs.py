"""The pages in docs/: the generated reference is up to date, and links lead to files and headings that exist."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from conftest import ROOT
from derive.cli.main import main

PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md"), ROOT / "bench/README.md"])


def test_reference_of_keys_is_that_of_the_schema(
    capsys: pytest.CaptureFixture[str], compare_or_update: Callable[[Path, str], None]
) -> None:
    assert main(["schema", "--markdown"]) == 0
    compare_or_update(ROOT / "docs/reference_toml.md", capsys.readouterr().out)


def test_reference_names_every_key() -> None:
    import json

    reference = (ROOT / "docs/reference_toml.md").read_text()
    schema = json.loads((ROOT / "scenes/schema.json").read_text())
    for table in (schema, *schema["$defs"].values()):
        for key in table["properties"]:
            assert f"| `{key}` |" in reference, key


def anchors(page: Path) -> set[str]:
    """The anchors that GitHub gives to the headings of a page."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if target.startswith("https:"):
            continue
        name, _, anchor = target.partition("#")
        file = page.parent / name if name else page
        assert file.exists(), target
        assert not anchor or anchor in anchors(file), target
