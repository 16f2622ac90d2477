"""The notebooks of the documentation are valid, have no outputs, and run when the site is built."""

from __future__ import annotations

import ast
import json
from pathlib import Path

import pytest

from conftest import ROOT

NOTEBOOKS = sorted((ROOT / "docs/notebooks").glob("*.ipynb"))


def settings() -> dict[str, object]:
    """The settings of the site that are constants."""
    tree = ast.parse((ROOT / "docs/conf.py").read_text(encoding="utf-8"))
    result: dict[str, object] = {}
    for node in tree.body:
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant):
            result |= {target.id: node.value.value for target in node.targets if isinstance(target, ast.Name)}
    return result


def test_there_are_three_notebooks() -> None:
    assert [path.stem for path in NOTEBOOKS] == ["accuracy_against_speed", "mechanism", "optimal_control"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_valid_and_has_no_outputs(path: Path) -> None:
    notebook = json.loads(path.read_text(encoding="utf-8"))
    assert (notebook["nbformat"], notebook["nbformat_minor"]) >= (4, 5)
    assert notebook["metadata"]["kernelspec"]["name"] == "python3"
    cells = notebook["cells"]
    assert "".join(cells[0]["source"]).startswith("# ")
    assert {cell["cell_type"] for cell in cells} == {"markdown", "code"}
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert len(code) >= 5
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in code)
    for cell in code:
        ast.parse("".join(cell["source"]))
    ids = [cell["id"] for cell in cells]
    assert len(set(ids)) == len(ids)


def test_the_site_runs_all_notebooks_and_stops_at_an_error() -> None:
    known = settings()
    assert known["nb_execution_mode"] in ("cache", "force", "auto")
    assert known["nb_execution_raise_on_error"] is True
    assert "nb_execution_excludepatterns" not in known
