"""Faults of plots, columns and conditions are detected before the first run, in all variants of a scene."""

from __future__ import annotations

from pathlib import Path

import pytest

import derive
from derive.cli.main import main
from derive.simulation.initial.contradictions import InitialValue
from derive.simulation.prepared_run import PreparedRun
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse

BEAM = """
name = "hanging"
ground.markers = { hook = [0, 0] }
[bodies.rod]
ansatz = ["1", "xi", "xi^2"]
mass = 1
length = 1
markers = { top = -1, tip = 1 }
pieces = 2
[joints.hinge]
kind = "revolute"
between = ["ground.hook", "rod.top"]
[inputs.push]
unit = "N"
value = "t"
[torques.push]
at = "rod.tip"
value = { input = "push" }
[simulation]
duration = 1
output = 0.5
"""


@pytest.fixture
def runs(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The runs that have begun."""
    begun: list[str] = []
    monkeypatch.setattr(PreparedRun, "trajectory", lambda self, *_: begun.append(self.spec.name))
    return begun


def refused(folder: Path, more: str, capsys: pytest.CaptureFixture[str], *options: str) -> str:
    """The message of the command for a scene with something more; nothing is written."""
    spec = folder / "hanging.toml"
    spec.write_text(BEAM + more)
    assert main(["simulate", str(spec), "--out", str(folder / "out"), *options]) == 2
    assert not (folder / "out").exists()
    return capsys.readouterr().err


def test_columns_of_a_scene_with_other_pieces(
    runs: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """rod_2_phi exists with two pieces, which the scene has, and not with one."""
    plot = '[plots.angle]\ny = "rod_2_phi"\n'
    message = refused(tmp_path, f'{plot}cut = "rod"\npieces = [2, 1]\n', capsys)
    assert 'hanging.toml:23: plots.angle.y: there is no column "rod_2_phi"; did you mean "rod_phi' in message
    assert runs == []


def test_all_faults_of_plots_and_conditions_at_once(
    runs: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """One shape function is left of the ansatz, so that these columns might be, and are not."""
    plots = '[plots.a]\ny = ["rod_1_alpha3", "t"]\n[plots.b]\ny = "t"\nx = "rod_2_alpha2"\n'
    lines = refused(tmp_path, plots, capsys, "--until", "rod_3_phi > 1").splitlines()
    assert len(lines) == 3 and runs == []
    assert "simulation.until" in lines[0] and "plots.a.y" in lines[1] and "plots.b.x" in lines[2]


def test_two_columns_of_one_name() -> None:
    """An input has a column if a function in Python gives it: its name is that of an output here."""
    scene = parse(BEAM + '[outputs.u_push]\nkind = "energy"\n[outputs.u]\nkind = "position"\nmarker = "rod.tip"\n')
    assert isinstance(scene, Scene)
    PreparedRun(scene)
    scene = parse(BEAM + '[outputs.u_push]\nkind = "distance"\nbetween = ["ground.hook", "rod.tip"]\n')
    assert isinstance(scene, Scene)
    PreparedRun(scene)
    with pytest.raises(
        derive.SpecError, match=r'^outputs\.u_push: two columns are called "u_push"; choose other names'
    ):
        PreparedRun(scene, inputs={"push": lambda t: 0.0})


def test_files_are_planned_by_their_names(runs: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Files of default plots are planned, too, which a scene with plots of its own does not have."""
    spec, folder = tmp_path / "hanging.toml", tmp_path / "out/hanging"
    folder.mkdir(parents=True)
    (folder / "angles.svg").write_text("mine")
    spec.write_text(BEAM)
    assert main(["simulate", str(spec), "--out", str(tmp_path / "out")]) == 2
    assert "angles.svg" in capsys.readouterr().err and runs == []
    spec.write_text(BEAM + '[plots.first]\ny = "rod_1_phi"\n')
    with pytest.raises(TypeError):  # the stand-in of a run has no result
        main(["simulate", str(spec), "--out", str(tmp_path / "out")])
    assert runs == ["hanging"]


def test_contradictions_of_the_initial_state_have_their_lines(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    more = "[bodies.rod.start]\nposition = [0.7, 0]\nangle = 0\n"
    message = refused(tmp_path, more, capsys)
    assert "hanging.toml:23: bodies.rod.start.position: component 1: 0.7 m contradicts the joint hinge (off" in message


def test_rounding_errors_of_zero_are_zero() -> None:
    """The value replaces 0.3 m, or 1e-9 m; nobody has chosen -2.4e-33 m."""
    shown = [
        str(InitialValue("x", "m", specified, value, False, True))
        for specified, value in ((0.3, -2.4e-33), (0.3, 1e-12), (1e-9, 1e-12), (0.0, -2.4e-33))
    ]
    assert shown == ["x: 0.3 m -> 0 m", "x: 0.3 m -> 1e-12 m", "x: 1e-09 m -> 1e-12 m", "x: 0 m -> -2.4e-33 m"]
