"""`[plots]` of a single body: the same tables as in a scene, of columns alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import derive
from conftest import ROOT
from derive.backends.model_files import fingerprint
from derive.cli.main import main
from derive.spec.toml.read import parse

BEAM = """
name = "thrown"
[beam]
start = { velocity = [1, 2], spin = 3 }
[simulation]
duration = 0.2
output = 0.05
"""
PLOTS = """
[plots.path]
x = "beam_c1"
y = "beam_c2"
reference = { file = "path.csv", x = "x", y = "y" }
[plots.angle]
y = "beam_phi"
"""


def test_a_beam_is_plotted_and_compared(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """c2 = 2 c1 is the reference as well."""
    (tmp_path / "path.csv").write_text("x,y\n0,0\n0.1,0.2\n0.2,0.4\n")
    (tmp_path / "thrown.toml").write_text(BEAM + PLOTS)
    assert main(["simulate", str(tmp_path / "thrown.toml"), "--out", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert "path: beam_c2; over beam_c1, m" in text and "rms error" in text
    pictures = {path.name for path in (tmp_path / "thrown").glob("*.svg")}
    assert pictures == {"path.svg", "angle.svg"}


def test_a_body_in_space_is_plotted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (ROOT / "scenes/block.toml").read_text().replace("block.npz", str(ROOT / "scenes/block.npz"))
    text = text.replace("modes = 8", "modes = 0")
    (tmp_path / "block.toml").write_text(text + '\n[plots.spin]\ny = ["omega1", "omega2"]\n')
    arguments = ["simulate", str(tmp_path / "block.toml"), "--out", str(tmp_path), "--duration", "0.1"]
    assert main([*arguments, "--output", "0.05"]) == 0
    assert "spin: omega1, omega2; over time, s" in capsys.readouterr().out
    assert [path.name for path in (tmp_path / "block").glob("*.svg")] == ["spin.svg"]
    (tmp_path / "block.toml").write_text(text + '\n[plots.spin]\ny = "omega4"\n')
    assert main([*arguments, "--output", "0.05"]) == 2
    assert 'plots.spin.y: there is no column "omega4"; did you mean "omega' in capsys.readouterr().err


def test_what_needs_a_scene_is_refused() -> None:
    wrong = '[plots.bending]\ndeflection = "beam.middle"\nchord = ["beam.left", "beam.right"]\ndivided_by = 1\n'
    with pytest.raises(derive.SpecError) as caught:
        parse(BEAM + wrong + '[plots.path]\ny = "beam_c2"\ncut = "beam"\npieces = [1, 2]\n')
    refused = [problem.path for problem in caught.value.problems]
    assert refused == [
        f"plots.{key}"
        for key in ("bending.deflection", "bending.chord", "bending.divided_by", "path.cut", "path.pieces")
    ]
    assert "plots of a body alone draw columns" in str(caught.value)
    with pytest.raises(derive.SpecError, match="plots: a symbolic body has no numbers to simulate with"):
        parse('name = "b"\n[body]\nintegrals = "symbolic"\nmodes = 1\n[plots.c]\ny = "c1"\n')


def test_plots_do_not_change_the_model() -> None:
    plain, plotted = parse(BEAM), parse(BEAM + '[plots.angle]\ny = "beam_phi"\n')
    assert isinstance(plotted, derive.PlanarBeam) and len(plotted.plots) == 1
    assert derive.validated(plotted) == plotted and replace(plotted, plots=()) == plain
    assert fingerprint(plotted) == fingerprint(plain)
