"""`tisserand sweep`: its files, what it prints, its picture, and what it refuses."""

from __future__ import annotations

import csv
import json
import math
import os
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sweep_scenes import SLIDER, kill_at_seven, slider

from derive.cli.main import main
from derive.spec.toml.read import parse
from derive.study.sweep import executors
from derive.study.sweep.picture import sweep_svg
from derive.study.sweep.result import SweepResult
from derive.study.sweep.run import sweep
from derive.study.sweep.samples import Samples, grid, random_samples, uniform
from explicit_motion import moved


@pytest.fixture
def spec(tmp_path: Path) -> Path:
    path = tmp_path / "slider.toml"
    path.write_text(SLIDER)
    return path


@pytest.fixture
def in_process(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A thread in place of processes, which would load again what this one has loaded; other tests have processes."""
    with ThreadPoolExecutor(1) as threads:
        monkeypatch.setattr(executors, "_Processes", lambda workers: executors._Given(threads))
        yield


def run(spec: Path, *arguments: str) -> int:
    return main(["sweep", str(spec), "--out", str(spec.parent), "--workers", "1", *arguments])


@pytest.mark.usefixtures("in_process")
def test_the_files_hold_all_samples(spec: Path, capsys: pytest.CaptureFixture[str]) -> None:
    given = ["--set", "EI=8:12:3", "--set", "radius=0.1,0.31", "--set", "drives.motor.offset=1.5"]
    assert run(spec, *given, "--output", "peak", "--output", "final:slider_s") == 0
    output = capsys.readouterr()
    assert output.err == ""
    assert "set bodies.rod.bending_stiffness: 12 N m^2 -> 3 values, 8 ... 12, the parameter EI" in output.out
    assert "set drives.motor.offset: not given -> 1.5" in output.out
    assert "6 samples, a grid of 3 x 2 x 1" in output.out and "1 compiled model, 2 initial states" in output.out
    assert "warning: 3 samples failed and have no values (nan):" in output.out
    assert "3 samples, the first at EI = 8, radius = 0.31: no positions near the initial guess" in output.out
    folder = spec.parent / "slider"
    assert sorted(path.name for path in folder.iterdir()) == ["sweep.csv", "sweep.json", "sweep.npz", "sweep.svg"]
    result = sweep(*_same_sweep())
    with (folder / "sweep.csv").open() as file:
        head, *rows = csv.reader(file)
    assert head == ["EI", "radius", "drives.motor.offset", "peak_deflection", "final_slider_s", "failure"]
    values = np.array([[float(cell) for cell in row[3:5]] for row in rows])
    assert values.tobytes() == result.values.tobytes()
    assert [bool(row[5]) for row in rows] == [False, True] * 3 and "crank_pin" in rows[1][5]
    arrays = np.load(folder / "sweep.npz")
    assert arrays["values"].tobytes() == result.values.tobytes()
    assert arrays["samples"].tobytes() == result.samples.values.tobytes() and arrays["shape"].tolist() == [3, 2, 1]
    assert list(arrays["names"]) == head[:3] and list(arrays["outputs"]) == head[3:5]
    assert [bool(text) for text in arrays["failures"]] == [False, True] * 3
    record = json.loads((folder / "sweep.json").read_text())
    assert record["notes"] == [] and "warning: at EI = 8, radius = 0.1: rod in 1 beam: its axial force" in output.out
    assert record["failed"] == 3 and record["outputs"][1]["name"] == "final_slider_s"
    before = {path: path.read_bytes() for path in folder.iterdir()}
    assert run(spec, *given, "--output", "peak", "--output", "final:slider_s", "--json", "--resume") == 0
    failure = json.loads(capsys.readouterr().out)["failures"][0]
    assert failure["samples"] == 3 and failure["rows"] == [1, 3, 5]
    assert {path: path.read_bytes() for path in folder.iterdir()} == before


def _same_sweep() -> tuple[object, Samples, list[str]]:
    samples = grid({"EI": [8, 10, 12], "radius": [0.1, 0.31], "drives.motor.offset": [1.5]})
    return slider(), samples, ["peak", "final:slider_s"]


def test_an_interrupted_sweep_is_resumed(
    spec: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    given = ["--set", "EI=8:12:9", "--output", "peak"]
    with monkeypatch.context() as patch:
        patch.setattr(executors, "failed", _interrupt)
        patch.setattr(executors, "run_chunk", kill_at_seven)
        assert run(spec, *given) == 130
    store = spec.parent / "slider" / "sweep.partial"
    assert store.exists() and capsys.readouterr().err == "interrupted\n"
    assert run(spec, *given) == 2
    assert "continue it with --resume" in capsys.readouterr().err
    assert run(spec, "--set", "EI=8:12:8", "--output", "peak", "--resume") == 2
    assert "the samples changed since these samples were finished" in capsys.readouterr().err
    assert run(spec, *given, "--resume") == 0
    assert "samples resumed" in capsys.readouterr().out and not store.exists()
    resumed = (spec.parent / "slider" / "sweep.csv").read_bytes()
    assert run(spec, *given) == 0
    assert (spec.parent / "slider" / "sweep.csv").read_bytes() == resumed


def test_a_finished_sweep_is_not_computed_again(
    spec: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    given, folder = ["--set", "EI=8:12:3", "--output", "peak"], spec.parent / "slider"
    assert run(spec, *given) == 0
    first = capsys.readouterr().out
    contents = {path: path.read_bytes() for path in folder.iterdir()}
    assert run(spec, *given) == 0 and capsys.readouterr().out
    assert {path: path.read_bytes() for path in folder.iterdir()} == contents
    with monkeypatch.context() as patch:
        patch.setattr(executors, "run_chunk", _interrupt)
        (folder / "sweep.svg").unlink()
        assert run(spec, *given, "--resume") == 0
    again, extremes = capsys.readouterr(), [line for line in first.splitlines() if line.startswith("  peak_")]
    assert "; all 3 samples are finished already, so nothing is computed again" in again.out and not again.err
    assert len(extremes) == 1 and extremes[0] in again.out
    assert {path: path.read_bytes() for path in folder.iterdir()} == contents
    assert run(spec, *given, "--resume", "--json") == 0
    assert json.loads(capsys.readouterr().out)["resumed"] == 3
    # Where a file is lost or the samples are others, they are computed, and a line says that nothing is resumed.
    (folder / "sweep.csv").unlink()
    for other in (given, ["--set", "EI=8:12:2", "--output", "peak"]):
        assert run(spec, *other, "--resume") == 0
        printed = capsys.readouterr()
        assert "holds no sweep of these samples" in printed.err and "already" not in printed.out
        assert (folder / "sweep.csv").exists()


def _interrupt(*_: object) -> None:
    raise KeyboardInterrupt


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--set", "EJ=1,2", "--output", "peak"], '--set: "EJ" is no parameter'),
        (["--set", "EI=1:2", "--output", "peak"], "EI=1:2: expected start:stop:count"),
        (["--set", "EI=1,2", "--output", "mean"], 'there is no statistic "mean"; known: peak, rms, final'),
        (["--set", "EI=1,2", "--output", "peak:rod_ph"], 'did you mean "rod_phi"'),
        (["--set", "EI=1,2", "--output", "peak", "--until", "rod > 1"], "simulation.until"),
        (["--set", "radius=0.4,0.5", "--set", "drives.motor.offset=1.5", "--output", "peak"], "none of the 2 samples"),
    ],
)
def test_errors(spec: Path, arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(spec, *arguments) == 2
    assert message in capsys.readouterr().err
    assert not list((spec.parent / "slider").glob("sweep.*"))


@pytest.mark.usefixtures("in_process")
def test_the_lines_of_a_table(spec: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = spec.parent / "samples.csv"
    table.write_text("EI,speed\n8,100\n12,150\n")
    assert run(spec, "--list", str(table), "--output", "peak") == 0
    assert "slider: 2 samples\n" in capsys.readouterr().out
    rows = list(csv.reader((spec.parent / "slider" / "sweep.csv").read_text().splitlines()))
    assert [row[:2] for row in rows] == [["EI", "speed"], ["8.0", "100.0"], ["12.0", "150.0"]]


def test_progress(spec: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    assert run(spec, "--set", "EI=8:12:9", "--output", "peak") == 0
    text = capsys.readouterr().err
    stages = ["deriving and compiling model 1", "slider: 0 of 9 samples", "samples, about", "slider: 9 of 9 samples"]
    places = [text.find(stage) for stage in stages]
    assert -1 not in places and places == sorted(places) and text.endswith("\r\x1b[K")


def test_linear_algebra_has_no_threads_beside_the_workers(spec: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("OPENBLAS_NUM_THREADS")
    assert run(spec, "--set", "EI=1:2", "--output", "peak") == 2
    assert os.environ["OPENBLAS_NUM_THREADS"] == "1"


def test_files_of_others_are_left_alone(spec: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (spec.parent / "slider").mkdir()
    (spec.parent / "slider" / "sweep.csv").write_text("mine")
    assert run(spec, "--set", "EI=8,9", "--output", "peak") == 2
    assert "sweep.csv: it was not generated by Tisserand" in capsys.readouterr().err


def made_up(samples: Samples, failed: bool = False) -> SweepResult:
    """The result of runs that need no time: x^2 + y, or x^2."""
    output = sweep_outputs()
    values = samples.values[:, :1] ** 2 + samples.values[:, 1:].sum(axis=1, keepdims=True)
    failures = {1: "no positions"} if failed else {}
    values[list(failures)] = math.nan
    return SweepResult("made_up", samples, output, values, failures, {}, {}, 1, 1, dict.fromkeys(samples.names, "N"))


def sweep_outputs() -> tuple[object, ...]:
    from derive.study.sweep.outputs import Statistic, SweepOutput

    return (SweepOutput(Statistic.PEAK, "s", "m"),)


def test_pictures_are_lines_and_maps() -> None:
    x, y = np.linspace(1, 2, 5), np.geomspace(1, 100, 5)
    line = sweep_svg(made_up(grid({"a.x": x})))
    assert line and "peak of s over x" in line and "<image" not in line
    assert line == sweep_svg(made_up(grid({"a.x": x})))
    drawn = sweep_svg(made_up(grid({"a.x": x, "b.y": y}), failed=True))
    assert drawn and "<image" in drawn and "largest 104" in drawn and "least 2" in drawn and "failed" in drawn
    assert "failed" not in (sweep_svg(made_up(grid({"a.x": x, "b.y": y}))) or "")
    points = sweep_svg(made_up(random_samples({"a.x": uniform(0, 1), "b.x": uniform(0, 1)}, 20)))
    assert points and "peak of s over a.x and b.x" in points and points.count("<use") > 20
    assert sweep_svg(made_up(grid({"x": x, "y": y, "z": [1, 2]}))) is None


@pytest.mark.long
def test_pictures_do_not_depend_on_the_last_bits_of_values() -> None:
    """The bar's colours change at limits of rounding, which its bytes would show."""
    result = made_up(grid({"a.x": np.linspace(1, 2, 5), "b.y": np.geomspace(1, 100, 5)}))
    others = [replace(result, values=result.values * (1 + k * 2.0**-50)) for k in range(-6, 7)]
    assert {sweep_svg(other) for other in others} == {sweep_svg(result)}


CHAIN = """
name = "chain"
ground.markers = { hook = [0, 0] }
scene.gravity = [0, -9.81]
[bodies.link]
count = 4
mass = 0.05
inertia = 1e-4
markers = { left = [0, 0], right = [0.1, 0] }
start = { position = ["0.1*i", 0] }
[joints.hinge]
kind = "revolute"
between = ["ground.hook", "link[0].left"]
[joints.pin]
count = 3
kind = "revolute"
between = ["link[i].right", "link[i+1].left"]
[simulation]
duration = 0.2
output = 0.01
"""


def test_numbers_of_instances_are_swept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Each number has a model of its own, whose outputs are those of a simulation with these counts."""
    spec, table = tmp_path / "chain.toml", tmp_path / "counts.csv"
    spec.write_text(CHAIN)
    table.write_text("bodies.link.count,joints.pin.count\n2,1\n5,4\n")
    assert run(spec, "--list", str(table), "--output", "final:link[1]_phi") == 0
    printed = capsys.readouterr().out
    assert "set bodies.link.count: 4 -> 2 values, 2 ... 5\n" in printed and "2 compiled models" in printed
    assert "link.count = 5, pin.count = 4" in printed
    rows = list(csv.reader((tmp_path / "chain" / "sweep.csv").read_text().splitlines()))
    for given_count, given_joints, value, failure in rows[1:]:
        count, joints = (int(float(text)) for text in (given_count, given_joints))
        text = CHAIN.replace("count = 4", f"count = {count}").replace("count = 3", f"count = {joints}")
        assert float(value) == moved(parse(text))["link[1]_phi"][-1] and not failure


def test_counts_that_do_not_go_together_have_the_lines_of_the_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    spec = tmp_path / "chain.toml"
    spec.write_text(CHAIN)
    assert run(spec, "--set", "bodies.link.count=4,3", "--output", "final:link[1]_phi") == 2
    assert f"{spec}:17: joints.pin.between[1]: for i = 2: there is no link[3]" in capsys.readouterr().err
