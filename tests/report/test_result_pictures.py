"""The pictures of studies in the report of a scene: each of them, rasters within them, and nothing from elsewhere."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from conftest import ROOT
from derive.artifacts import MARK
from derive.cli.main import main

SCENE = ROOT / "scenes" / "four_bar.toml"
OUTPUTS = """[outputs.z]
kind = "position"
marker = "coupler.right"

[outputs.a]
kind = "rotation"
marker = "coupler.right"

"""
PLOTTED = ("z", "a", "coupler_bends", "crank_bends")
"""The plots of outputs, then those of the file, in its order."""
KEPT = ("accuracy", "stability", "methods", "sweep")
FOREIGN = f'<svg xmlns="http://www.w3.org/2000/svg"><!-- {MARK} --><image href="http://example.org/a.png"/></svg>'


@pytest.mark.parametrize("ending", [[], ["--markdown"]])
def test_all_pictures_of_studies_are_shown(
    ending: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "results" / "four_bar"
    folder.mkdir(parents=True)
    spec = tmp_path / SCENE.name
    spec.write_text(SCENE.read_text().replace("[simulation]", f"{OUTPUTS}[simulation]"))
    for name in PLOTTED:
        (folder / f"{name}.svg").write_text((ROOT / "docs" / "crank_slider.svg").read_text())
    for name in KEPT:
        (folder / f"{name}.svg").write_text((ROOT / "docs" / f"{name}.svg").read_text())
    assert "data:image/png" in (folder / "sweep.svg").read_text()
    (folder / "foreign.svg").write_text(FOREIGN)
    (folder / "broken.svg").write_text(f"<svg><!-- {MARK} --><g></svg>")
    (folder / "own.svg").write_text("<svg/>")
    assert main(["report", str(spec), *ending]) == 0
    said = capsys.readouterr().err
    assert "foreign.svg: left out of the report: a picture holds href='http://example.org/a.png'" in said
    assert "broken.svg: left out of the report: mismatched tag" in said and "own.svg" not in said
    page = (folder / "four_bar.report.html").read_text()
    assert re.findall(r"Result (\w+)", page) == [*PLOTTED, *sorted(KEPT)]
    assert "data:image/png;base64," in page and "example.org" not in page
