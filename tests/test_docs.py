"""The pages in docs/: the generated reference is up to date, and links lead to files and headings that exist."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

import derive
from conftest import ROOT
from derive.backends.model_files import specification
from derive.cli.main import main
from derive.spec.toml.read import parse
from markdown_pages import TISSERAND, blocks, copy_tree, run_page

PAGES = sorted(
    [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), ROOT / "bench/README.md", ROOT / "examples/README.md"]
)

OF_HOSTS = ("hosts", "calculix")
RUN = [page for page in PAGES if page.is_relative_to(ROOT / "docs") and blocks(page) and page.stem not in OF_HOSTS]
"""The pages with commands; tests/hosts runs those of OF_HOSTS, which need other programs."""


@pytest.mark.long
@pytest.mark.parametrize("page", RUN, ids=lambda page: page.stem)
def test_code_runs_as_printed(page: Path, tmp_path: Path) -> None:
    tree = copy_tree(tmp_path)
    committed = {p: p.read_bytes() for folder in ("generated", "docs") for p in (tree / folder).rglob("*.*")}
    outputs = run_page(page, tree)
    assert outputs
    assert {p: p.read_bytes() for p in committed} == committed


def test_tutorials_are_run() -> None:
    tutorials = {"tutorial_body", "tutorial_c", "tutorial_mechanism", "tutorial_python", "tutorial_space"}
    tasks = {"choose", "cluster", "embed_c", "finite_element_data", "fmu", "identify", "robots", "stresses"}
    assert {page.stem for page in RUN} == {"commands", "first_steps", *tutorials, *tasks}


def test_the_committed_files_are_checked() -> None:
    """A command of a page checks the committed files; its exit code is 1 if one is not up to date."""
    commands = [line for block in blocks(ROOT / "docs/commands.md", "sh") for line in block.commands()]
    assert f"{TISSERAND} check" in commands


def test_shown_specifications_are_the_scenes() -> None:
    for page in RUN:
        for block in blocks(page, "toml"):
            if not block.comment:
                shown = parse(block.text, str(ROOT / "scenes/shown.toml"))
                assert specification(shown) == specification(derive.read(ROOT / f"scenes/{shown.name}.toml"))


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


REPLACED = (
    "move far and turn a lot",
    "inertial base",
    "waits for its coordinates",
    "written out",
    "are foreseen",
    "shares no inertia",
    "on their second bodies",
    "choice of O",
    "drift of rates",
    "filled in",
    "held by nothing",
    "That the files can",
    "stand in the file",
    "know nothing of",
    "knows nothing of",
    "Of the C library",
    "Not modelled",
)
"""Phrases for which the field or plain English has other words."""


@pytest.mark.parametrize("phrase", REPLACED)
def test_pages_use_the_terms_of_the_field(phrase: str) -> None:
    scenes, examples = (ROOT / "scenes").glob("*.toml"), (ROOT / "examples").iterdir()
    for path in [
        ROOT / "README.md",
        *(ROOT / "docs").rglob("*.md"),
        *scenes,
        *(p for p in examples if p.is_file() and p.suffix != ".npz"),
    ]:
        assert phrase not in " ".join(path.read_text().split()), path.name
