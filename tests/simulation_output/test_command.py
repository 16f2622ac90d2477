"""`tisserand simulate` as a user meets it; its integration is a stand-in."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import slider

import derive
import derive.cli.simulate as command
from conftest import ROOT
from derive.cli.main import main
from derive.ir.model import Variable
from derive.simulation.errors import IntegrationStopped
from derive.simulation.initial.initial_state import InitialState
from derive.simulation.integration.solution import Cost, Solution
from derive.simulation.observables.beams import beam_bodies, relative_deflection
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.output_times import output_times
from derive.simulation.trajectory import RunSettings, Trajectory
from derive.simulation.validity.monitors import ERROR_LIMIT, Cause, Monitor
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene

DEFORMING = "deforming"
SCENE = ROOT / "scenes/crank_slider_3.toml"


@dataclass
class Names:
    coordinates: tuple[Variable, ...]
    velocities: tuple[Variable, ...]
    multipliers: tuple[Variable, ...]
    parameters: tuple[Variable, ...] = ()
    inputs: tuple[Variable, ...] = ()
    outputs: tuple[Variable, ...] = ()


def bent(motion: SceneMotion, beam: BeamBody) -> Monitor:
    value = relative_deflection(motion, beam)
    return Monitor(beam.name, beam.pieces, Cause.DEFLECTION, beam.beam.order, value, value, 0.0)


def simulated(scene: Scene, progress=None) -> Trajectory:
    assert scene.simulation is not None
    native = slider.Double(scene)
    t = output_times(scene.simulation)
    q = native.states(t)
    lam = np.ones((len(t), native.nlambda))
    if progress:
        progress(t[-1])
    found = Solution(t, q, 0 * q, lam, np.full((len(t), 2), 1e-12), np.zeros((len(t), 2)), Cost(1234, 99, 0.5))
    units = [Variable(name, "", "m") for name in native.coordinates]
    velocities = tuple(Variable(f"{x.name}dot", "", "m/s") for x in units)
    names = Names(tuple(units), velocities, tuple(Variable(x, "", "N") for x in native.multipliers))
    motion = SceneMotion(scene, native, np.zeros(0), t, q, 0 * q)
    return Trajectory(
        scene,
        names,
        InitialState(0.0, q[0], 0 * q[0], 0.0, 0.0, False, DEFORMING in scene.name),
        motion,
        found,
        RunSettings(scene.simulation),
        tuple(bent(motion, beam) for beam in beam_bodies(scene)),
    )


class Prepared:
    """A simulation that is ready to run, without a derivation; `asked` are the scenes that have run."""

    def __init__(self, scene: Scene, asked: list[Scene]) -> None:
        self.spec, self.settings, self.plots, self.asked = scene, RunSettings(scene.simulation), scene.plots, asked
        self.units = simulated(scene).units

    def trajectory(self, earlier: object, progress: object, announce: object) -> Trajectory:
        self.asked.append(self.spec)
        return simulated(self.spec, progress)


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> list[Scene]:
    """Scenes that were simulated, quickly."""
    asked: list[Scene] = []
    monkeypatch.setattr(command, "PreparedRun", lambda scene, *_, **__: Prepared(scene, asked))
    return asked


def test_it_writes_and_tells(quick: list[Scene], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["simulate", str(SCENE), "--out", str(tmp_path), "--duration", "0.02"]) == 0
    said = capsys.readouterr()
    assert said.err == ""  # quiet in a pipe
    rows = {line.split("  ")[1]: line.split() for line in said.out.splitlines() if line.startswith("  ")}
    assert rows["rod in 3 beams"][4:] == ["16", "2", "99", "1234", "0.50", "1.0e-12", "1.0e-12"]
    assert len(rows["2 beams"]) == 10 and rows["2 beams"][-1] == "%"
    folder = tmp_path / "crank_slider_3"
    assert sorted(p.name for p in folder.iterdir()) == [
        "crank_slider_3.csv",
        "crank_slider_3.html",
        "crank_slider_3.json",
        "deflection.svg",
    ]
    table = np.genfromtxt(folder / "crank_slider_3.csv", names=True, delimiter=",")
    assert table.dtype.names[:3] == ("t", "motor", "rod_1_c1") and len(table) == 201
    assert len(set(table.dtype.names)) == 2 + 16 + 16 + 2
    assert table["motor"][-1] == pytest.approx(3)
    assert "3 beams: rms" in (folder / "deflection.svg").read_text()
    # each number of pieces once, the scene's own first
    assert [next(b.pieces for b in s.bodies if b.name == "rod") for s in quick] == [3, 1, 2]


def test_for_machines(quick: list[Scene], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["simulate", str(SCENE), "--out", str(tmp_path), "--duration", "0.01", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["name"] == "crank_slider_3" and found["duration"] == 0.01
    assert [run["pieces"] for run in found["runs"]] == [{"rod": 1}, {"rod": 2}, {"rod": 3}]
    assert {"steps": 99, "evaluations": 1234, "cpu_seconds": 0.5, "drift": 1e-12}.items() <= found["runs"][0].items()
    (plot,) = found["plots"]
    assert [curve["label"] for curve in plot["curves"]] == ["1 beam", "2 beams", "3 beams"]
    assert set(plot["curves"][0]["error"]) == {"rms", "max"} and plot["curves"][0]["largest"]["at"] <= 1.5
    assert all(Path(file).is_file() for file in found["files"]) and len(found["files"]) == 4


def test_again_gives_the_same_and_files_of_others_are_left_alone(
    quick: list[Scene], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["simulate", str(SCENE), "--out", str(tmp_path), "--duration", "0.005"]
    assert main(arguments) == 0
    files = sorted((tmp_path / "crank_slider_3").iterdir())
    before = [file.read_bytes() for file in files]
    assert main(arguments) == 0
    assert [file.read_bytes() for file in files] == before
    files[0].write_text("t,mine\n")
    files[1].unlink()
    assert main(arguments) == 2
    assert "was not generated by Tisserand" in capsys.readouterr().err
    assert files[0].read_text() == "t,mine\n" and not files[1].exists()


def test_a_symbolic_body_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = str(ROOT / "scenes/body_symbolic.toml")
    assert main(["simulate", spec, "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.startswith(f"{spec}: all numbers of this body are parameters")
    assert "give the body by its nodes, as a beam or as a scene; or build it" in said.err
    assert not (tmp_path / "out").exists()
    with pytest.raises(derive.SpecError, match="body_symbolic: all numbers of this body are parameters"):
        derive.simulate(derive.read(spec), duration=1.0, output=0.1)  # type: ignore[call-overload]


def test_a_scene_has_to_say_how_long(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = tmp_path / "scene.toml"
    spec.write_text(SCENE.read_text().split("[simulation]")[0])
    assert main(["simulate", str(spec), "--out", str(tmp_path / "out")]) == 2
    assert "simulation: this table is missing" in capsys.readouterr().err
    assert main(["simulate", str(SCENE), "--duration", "1e9", "--out", str(tmp_path / "out")]) == 2
    assert "rows" in capsys.readouterr().err


def test_a_failing_integration_is_explained(
    quick: list[Scene], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def stopped(*_: object) -> Trajectory:
        raise IntegrationStopped(0.03, "steps are too small")

    monkeypatch.setattr(Prepared, "trajectory", stopped)
    assert main(["simulate", str(SCENE), "--out", str(tmp_path / "out")]) == 2
    assert "stops at t = 0.03 s: steps are too small" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("duration", ["0", "-1", "nan", "inf", "long"])
def test_wrong_durations(duration: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["simulate", str(SCENE), f"--duration={duration}"])
    assert stopped.value.code == 2 and "--duration" in capsys.readouterr().err


def test_what_one_should_know_is_told(
    quick: list[Scene], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(slider, "MOST", 0.09)
    spec = tmp_path / "scene.toml"
    (tmp_path / "crank_slider_A.csv").write_text((SCENE.parent / "crank_slider_A.csv").read_text())
    spec.write_text(SCENE.read_text().replace('name = "crank_slider_3"', f'name = "{DEFORMING}"'))
    assert main(["simulate", str(spec), "--out", str(tmp_path), "--duration", "0.02"]) == 0
    told = [line for line in capsys.readouterr().out.splitlines() if "warning" in line]
    assert "rod in 1 beam: it bends by 24 % of its length" in told[0]
    assert any("some bodies are deformed at t = 0" in line for line in told)


def documented_keys() -> list[str]:
    """The keys of the record of a run in the table of docs/commands.md."""
    text = (ROOT / "docs/commands.md").read_text()
    rows = text[text.index("| key | content |") :].split("\n\n")[0].splitlines()[2:]
    return [key for row in rows for key in re.findall(r"`(\w+)`", row.split("|")[1])]


def test_a_model_that_is_not_valid_is_reported_in_all_places(
    quick: list[Scene], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["simulate", str(SCENE), "--out", str(tmp_path), "--duration", "0.02", "--json"]
    folder = tmp_path / "crank_slider_3"

    def results() -> tuple[dict, dict, str]:
        assert main(arguments) == 0
        record = json.loads((folder / "crank_slider_3.json").read_text())
        return json.loads(capsys.readouterr().out)["runs"][2], record, (folder / "crank_slider_3.html").read_text()

    summary, record, page = results()
    assert summary["warnings"] == record["warnings"] == [] and "Warning" not in page
    assert list(record) == documented_keys()
    monkeypatch.setattr(slider, "MOST", 0.4)
    summary, record, page = results()
    (text,) = record["warnings"]
    assert text.startswith("rod in 3 beams: it bends by") and summary["warnings"] == [text]
    assert f'<p class="note">Warning: {text}.</p>' in page
    (monitor,) = record["validity"]
    assert summary["validity"] == [monitor]
    assert (
        monitor["quantity"] == "deflection" and monitor["passed"] and monitor["error"] > monitor["limit"] == ERROR_LIMIT
    )


def test_a_terminal_sees_how_far_it_is(
    quick: list[Scene], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    assert main(["simulate", str(SCENE), "--out", str(tmp_path), "--duration", "0.001"]) == 0
    said = capsys.readouterr().err
    assert "crank_slider_3, rod in 1 beam: 0.001 of 0.001 s" in said and said.endswith("\r\x1b[K")


@pytest.mark.parametrize("out", ["a_file", "a_file/below"])
def test_an_output_folder_that_is_a_file_is_found_before_the_run(
    quick: list[Scene], out: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a_file").write_text("")
    assert main(["simulate", str(SCENE), "--out", str(tmp_path / out)]) == 2
    assert "a_file: this is a file, not a folder; choose another --out" in capsys.readouterr().err
    assert quick == []


def test_a_disk_without_space_is_found_before_the_run(
    quick: list[Scene], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The CSV has 201 rows of 36 columns of 18 bytes, its record 4 for the drift, 145 kB, and 1 MB is for pictures."""
    arguments = ["simulate", str(SCENE), "--out", str(tmp_path), "--duration", "0.02"]
    monkeypatch.setattr("shutil.disk_usage", lambda _: SimpleNamespace(free=1_140_000))
    assert main(arguments) == 2
    assert "make room, choose another --out, or write fewer rows" in capsys.readouterr().err
    assert quick == [] and not any(tmp_path.iterdir())
    monkeypatch.setattr("shutil.disk_usage", lambda _: SimpleNamespace(free=1_150_000))
    assert main(arguments) == 0


def test_a_foreign_file_is_found_before_the_run(quick: list[Scene], tmp_path: Path) -> None:
    (tmp_path / "crank_slider_3").mkdir()
    (tmp_path / "crank_slider_3/deflection.svg").write_text("mine")
    assert main(["simulate", str(SCENE), "--out", str(tmp_path)]) == 2
    assert quick == []


def test_the_record_has_units_settings_and_the_last_state(quick: list[Scene], tmp_path: Path) -> None:
    assert main(["simulate", str(SCENE), "--out", str(tmp_path), "--duration", "0.02"]) == 0
    folder = tmp_path / "crank_slider_3"
    record = json.loads((folder / "crank_slider_3.json").read_text())
    names = (folder / "crank_slider_3.csv").read_text().splitlines()[0].split(",")
    assert [column["name"] for column in record["columns"]] == names
    assert [column["unit"] for column in record["columns"]][:3] == ["s", "rad", "m"]
    assert (record["integrator"], record["tolerance"], record["duration"]) == ("adaptive", 1e-9, 0.02)
    assert record["last_state"]["t"] == 0.02 and len(record["last_state"]["q"]) == 16


def test_set_prints_old_and_new_values_and_simulates_with_the_new_ones(
    quick: list[Scene], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["simulate", str(SCENE), "--out", str(tmp_path), "--duration", "0.002"]
    options = ["--set", "bodies.rod.bending_stiffness=30", "--set", "simulation.output = 1e-3", "--tolerance", "1e-8"]
    assert main([*arguments, *options]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[:2] == [
        "set bodies.rod.bending_stiffness: 12.7234502 -> 30, the parameter rod_bending_stiffness",
        "set simulation.output: 0.0001 -> 1e-3",
    ]
    rod = next(body for body in quick[0].bodies if body.name == "rod")
    assert rod.beam.bending_stiffness.default == 30.0
    assert (quick[0].simulation.output, quick[0].simulation.tolerance) == (1e-3, 1e-8)
    assert main([*arguments, "--set", "EI=3", "--json"]) == 2
    assert '--set: "EI" is no parameter and no key' in capsys.readouterr().err
    assert main([*arguments, "--set", "a=1", "--set", "a=2"]) == 2
    assert capsys.readouterr().err == "--set: a has several values; give one\n"


@pytest.mark.parametrize(
    "option", [["--set", "EI"], ["--set", "=3"], ["--tolerance", "1"], ["--output", "-1"], ["--step", "x"]]
)
def test_wrong_options(option: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["simulate", str(SCENE), *option])
    assert stopped.value.code == 2 and f"argument {option[0]}: expected" in capsys.readouterr().err


PENDULUM = """name = "pendulum"
[ground.markers]
o = [0, 0]
[bodies.rod]
mass = 1
inertia = 1
markers = { o = [0, 0], end = [0.5, 0] }
[joints.hinge]
kind = "revolute"
between = ["ground.o", "rod.o"]
[outputs.place]
kind = "position"
marker = "rod.end"
[simulation]
duration = 0.1
output = 0.1
[plots.angle]
y = "rod_phi"
[outputs.bearing]
kind = "reaction"
joint = "hinge"
[plots.about]
y = ["rod_phi", "rod_phidot"]
"""


def test_plots_are_in_the_order_of_the_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Plots of outputs are among the others; each curve has its unit in the summary and in the animation."""
    spec = tmp_path / "pendulum.toml"
    spec.write_text(PENDULUM)
    assert main(["simulate", str(spec), "--out", str(tmp_path), "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert [plot["name"] for plot in summary["plots"]] == ["place", "angle", "bearing", "about"]
    assert [curve["unit"] for curve in summary["plots"][-1]["curves"]] == ["rad", "rad/s"]
    pictures = [Path(file).stem for file in summary["files"] if file.endswith(".svg")]
    assert pictures == ["place", "angle", "bearing", "about"]
    page = (tmp_path / "pendulum" / "pendulum.html").read_text()
    curves = re.findall(r'"name":"(\w+)","unit":"([^"]*)","values"', page.split('"curves":')[1])
    assert curves[:3] == [("place_1", "m"), ("place_2", "m"), ("rod_phi", "rad")] and curves[-1] == (
        "rod_phidot",
        "rad/s",
    )
