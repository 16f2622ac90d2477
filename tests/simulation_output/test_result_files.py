"""The files that a command writes for a model do not overwrite those of another command."""

from __future__ import annotations

from pathlib import Path

import pytest

from derive.cli import accuracy, methods, stability, study, sweep
from derive.cli.main import main
from derive.cli.result_files import STUDY_FILES, picture_names, planned_files
from derive.errors import SpecError
from derive.spec.model.plots import ColumnCurves, Plot

ARM = """
name = "NAME"
[scene]
gravity = [0, -9.81]
[ground.markers]
pivot = [0, 0]
[bodies.arm]
mass = 1
inertia = { symbol = "J", default = 0.1 }
markers = { pin = [0, 0], tip = [0.5, 0] }
[joints.bearing]
kind = "revolute"
between = ["ground.pivot", "arm.pin"]
[outputs.sweep]
kind = "position"
marker = "arm.tip"
[plots.Methods]
y = "arm_phi"
[simulation]
duration = 0.2
output = 0.01
"""


@pytest.fixture
def spec(tmp_path: Path) -> Path:
    path = tmp_path / "arm.toml"
    path.write_text(ARM.replace("NAME", "arm"))
    return path


def test_a_plot_with_the_name_of_a_study_has_a_picture_of_its_own(
    spec: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = ["--out", str(spec.parent)]
    assert main(["simulate", str(spec), *out]) == 0
    folder = spec.parent / "arm"
    assert "sweep_plot.svg" in capsys.readouterr().out
    names = {path.name for path in folder.iterdir()}
    assert names == {"arm.csv", "arm.json", "arm.html", "sweep_plot.svg", "Methods_plot.svg"}
    before = {name: (folder / name).read_bytes() for name in names}
    assert main(["sweep", str(spec), "--set", "J=0.1,0.2", "--output", "final:arm_phi", "--workers", "1", *out]) == 0
    assert {name: (folder / name).read_bytes() for name in names} == before
    added = {path.name for path in folder.iterdir()} - names
    assert added == {f"sweep.{ending}" for ending in STUDY_FILES["sweep"]}


def test_a_model_with_the_name_of_a_study(spec: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec.write_text(ARM.replace("NAME", "sweep"))
    options = ["--set", "J=0.1,0.2", "--output", "final:arm_phi", "--out", str(spec.parent)]
    assert main(["sweep", str(spec), *options]) == 2
    message = f'{spec}:2: name: simulations of a model called "sweep" write sweep.csv, sweep.json to '
    assert message in capsys.readouterr().err and not (spec.parent / "sweep").exists()


def test_every_study_has_files_that_no_plot_and_no_simulation_has() -> None:
    assert {*STUDY_FILES} == {study.FRAMES, *(command.NAME for command in (accuracy, methods, stability, sweep))}
    names = [*STUDY_FILES, "sweep_plot", "deflection"]
    pictures = picture_names([Plot(name, ColumnCurves(("t",))) for name in names])
    assert (
        len({name.lower() for name in pictures.values()}) == len(names) and pictures["deflection"] == "deflection.svg"
    )
    assert not {*pictures.values()} & {f"{name}.svg" for name in STUDY_FILES}
    for name in STUDY_FILES:
        assert planned_files(name, "slider", Path("results/slider")) and planned_files(name, name, Path("elsewhere"))
        if name != "frames":
            with pytest.raises(SpecError, match="choose another name"):
                planned_files(name, name.upper(), Path("results") / name.upper())
