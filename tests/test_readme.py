"""The README: every command and every piece of code as printed, and what its readers look for."""

from __future__ import annotations

from pathlib import Path

import pytest

from conftest import ROOT
from markdown_pages import README, RUN_BY_CI, blocks, copy_tree, run_page


@pytest.fixture(scope="module")
def outputs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The output of each block of the README; the blocks must leave the committed files as they are."""
    tree = copy_tree(tmp_path_factory.mktemp("readme"))
    committed = {p: p.read_bytes() for folder in ("generated", "docs") for p in (tree / folder).rglob("*.*")}
    outputs = run_page(README, tree)
    assert {p: p.read_bytes() for p in committed} == committed
    return {block.text: output for block, output in outputs.items()}


def test_commands_run(outputs: dict[str, str]) -> None:
    commands = [line for block in blocks(README, "sh") for line in block.commands()]
    assert len(commands) == 8 and "make run" in commands[0]
    assert RUN_BY_CI in README.read_text()
    assert "5 of 25 structural non-zeros" in "".join(outputs.values())


def test_five_lines_of_python(outputs: dict[str, str]) -> None:
    (block,) = blocks(README, "python")
    assert len(block.text.split("\n\n")[1].splitlines()) <= 5
    accelerations = [float(x) for x in outputs[block.text].strip(" []\n").split()]
    assert accelerations[3] == pytest.approx((9 - 720 * 30) * 0.01, rel=1e-6)  # (41) with EI = 30, m = l = 1


def test_shown_c_is_the_generated_one() -> None:
    (block,) = blocks(README, "c")
    assert block.text in (ROOT / "generated/free_beam_mean/free_beam_mean.c").read_text()
    assert block.text.startswith("int free_beam_mean_mass(") and block.text.endswith("}\n")


@pytest.mark.parametrize(
    "phrase",
    ["flexible multibody dynamics", "floating frame of reference", "assumed modes", "generalised velocities", "plane"],
)
def test_a_specialist_meets_the_terms_of_the_field_at_once(phrase: str) -> None:
    assert phrase in " ".join(README.read_text().splitlines()[:10])


def test_running_needs_no_test_tools() -> None:
    makefile = (ROOT / "Makefile").read_text()
    rule = makefile.split("$(VENV)/installed:")[1].split("\n\n")[0]
    assert "--editable .\n" in rule and "[test]" not in rule
    assert "run: $(VENV)/installed\n" in makefile
    assert all("[test]" not in block.text for block in blocks(README, "sh"))


def test_it_is_read_in_five_minutes() -> None:
    text = README.read_text()
    for block in blocks(README):
        text = text.replace(block.text, "")
    assert len(text.split()) < 1300  # 250 words a minute


def test_every_example_and_page_is_there() -> None:
    for name in ("first_steps", "tutorial_mechanism", "tutorial_body", "tutorial_c", "theory", "reference_toml"):
        assert f"docs/{name}.md" in README.read_text()
        assert Path(ROOT / "docs" / f"{name}.md").exists()
