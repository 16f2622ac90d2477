"""Drives whose speed is a function of t: in every form of the model the same as with its integral as the motion."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from made import Made, close, make, state

import derive
from derive.cli.main import main
from derive.export.casadi.graph import model_graph
from derive.export.host_model import host_model
from derive.simulation.drive_jumps import check_drives
from derive.spec.as_tables import scene_tables
from derive.spec.model.scene import Scene
from derive.spec.model.scene_functions import breaks
from derive.spec.set_values import with_values
from derive.spec.toml.read import parse
from explicit_motion import moved

DRIVEN = """
name = "driven"
ground.markers = { origin = [0, 0] }
[scene]
gravity = [0, -9.81]
[parameters]
Omega = { default = 2.5, unit = "rad/s" }
PHI
[bodies.crank]
mass = 1
inertia = 0.2
KEEP
markers = { hub = [0, 0], pin = [0.3, 0] }
[bodies.rod]
mass = 2
inertia = 0.3
markers = { left = [-0.5, 0], right = [0.5, 0] }
[joints.axle]
kind = "revolute"
between = ["ground.origin", "crank.hub"]
[joints.pin]
kind = "revolute"
between = ["crank.pin", "rod.left"]
[drives.motor]
joint = "axle"
DRIVE
[torques.load]
at = "rod.right"
value = "0.1*Omega"
[outputs.torque]
kind = "drive"
drive = "motor"
[simulation]
duration = 0.5
output = 0.05
"""
PAIRS = {
    "step": (
        'speed = "Omega*step(t, 0, 0.3)"',
        'motion = "Omega*piecewise(t < 0, 0, t < 0.3, (t/0.3)^6*0.3 - 3*(t/0.3)^5*0.3 + 2.5*(t/0.3)^4*0.3, t - 0.15)"',
    ),
    "sine": (
        'speed = "Omega*sin(3*t)*exp(-t) + t"\noffset = 0.2',
        'motion = "0.2 + t^2/2 + Omega*(3 - exp(-t)*(sin(3*t) + 3*cos(3*t)))/10"',
    ),
    "table": ('speed = "Omega*ramp(t)"', 'motion = "Omega*(t + t^2)"'),
}
KEPT = {"eliminated": "", "constraint": "keep_coordinates = true"}


def scene(folder: Path, drive: str, keep: str = "") -> Scene:
    (folder / "ramp.csv").write_text("t,w\n0,1\n0.4,1.8\n1,3\n2,5\n")
    text = DRIVEN.replace("DRIVE", drive).replace("KEEP", keep).replace("PHI", "")
    if "ramp" in drive:
        text += '[tables]\nramp = { file = "ramp.csv", x = "t", y = "w" }\n'
    result = parse(text, str(folder / "driven.toml"))
    assert isinstance(result, Scene)
    return result


@cache
def pair(folder: Path, name: str, keep: str) -> tuple[Made, Made]:
    first, second = (make(scene(folder, drive, KEPT[keep]), complete=True) for drive in PAIRS[name])
    return first, second


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("speeds")


@pytest.mark.parametrize(("name", "keep"), [("step", "eliminated"), ("sine", "constraint"), ("table", "eliminated")])
def test_c_and_python_are_those_of_the_written_motion(folder: Path, name: str, keep: str) -> None:
    by_speed, by_motion = pair(folder, name, keep)
    assert by_speed.native.coordinates == by_motion.native.coordinates
    k, start = by_speed.start(np.array([1.7]))
    known, expected = by_motion.start(np.array([1.7]))
    close(start.q, expected.q, 1e-13)
    assert np.abs(start.v - expected.v).max() < 1e-12
    for time in (0.1, 0.29, 0.7):
        _, q, v = state(by_speed.native, 3)
        assert np.abs(by_speed.native.poses(time, q, k) - by_motion.native.poses(time, q, known)).max() < 1e-14
        for own, other in zip(
            by_speed.native.solve(time, q, v, k), by_motion.native.solve(time, q, v, known), strict=True
        ):
            close(own, other, 1e-11)
        for own, other in zip(
            by_speed.python["solve"](time, q, v, k), by_speed.native.solve(time, q, v, k), strict=True
        ):
            close(own, other, 1e-12)


@pytest.mark.parametrize("name", PAIRS)
def test_casadi_has_the_same_motion_and_its_derivative_by_the_parameter(folder: Path, name: str) -> None:
    first, second = (model_graph(host_model(scene(folder, drive))) for drive in PAIRS[name])
    p = ca.SX.sym("p", first.size1_in("p"))
    x = np.linspace(0.1, 0.4, first.size1_in("x"))
    for graph in (first, second):
        assert graph.size1_in("x") == len(x)
    values = []
    for graph in (first, second):
        xdot = graph(0.21, x, [], p)[0]
        values.append(ca.Function("f", [p], [xdot, ca.jacobian(xdot, p)])(2.1))
    for own, other in zip(*values, strict=True):
        close(np.array(own), np.array(other), 1e-12)


def test_a_run_has_the_columns_of_the_written_motion(folder: Path) -> None:
    runs = [moved(scene(folder, drive)) for drive in PAIRS["step"]]
    own, other = runs
    assert own.columns == other.columns
    for name in ("motor", "rod_phi", "torque"):
        assert np.abs(own[name] - other[name]).max() < 1e-6 * np.abs(other[name]).max()
    assert own["motor"][-1] == pytest.approx(2.5 * 0.35, rel=1e-14)


def test_a_speed_is_written_back_set_and_stopped_at(folder: Path) -> None:
    spec = scene(folder, PAIRS["step"][0])
    assert "motion" not in scene_tables(spec)["drives"]["motor"]  # type: ignore[index]
    assert {0.0, 0.3} <= {*breaks(spec)}
    changed, (change,) = with_values(spec, {"drives.motor.speed": "3"})
    assert str(change) == "drives.motor.speed: Omega*step(t, 0, 3/10) -> 3, the parameter motor_speed_value"
    assert changed.drives[0].constant_speed is not None
    changed, _ = with_values(spec, {"drives.motor.speed": "Omega*step(t, 0, 0.4)", "Omega": "3"})
    assert {0.0, 0.4} <= {*breaks(changed)}


@pytest.mark.parametrize(
    ("drive", "text"),
    [
        (
            'speed = "exp(-t^2)*Omega"',
            r"the integral of Omega*exp(-t^2), which the motion would be, has no closed form",
        ),
        ('speed = { input = "w" }', "a run-time input prescribes the motion, not the speed"),
        ('speed = "Omega*t"\nmotion = "Omega*t^2"', "write either motion"),
        ('speed = "Omega*tt"', "tt"),
        ('speed = "sin(phi*t)*Omega"', "the integral of sin(phi*t)*Omega has no value at t = 0"),
    ],
)
def test_what_is_refused(tmp_path: Path, drive: str, text: str, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "driven.toml"
    file.write_text(DRIVEN.replace("DRIVE", drive).replace("KEEP", "").replace("PHI", "phi = { default = 0 }"))
    assert main(["build", str(file), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    line = "[drives.motor]" if "\n" in drive else "DRIVE"
    assert text in error
    assert f"driven.toml:{DRIVEN.splitlines().index(line) + 1}: drives.motor" in error


def test_a_jump_of_the_speed_is_refused(folder: Path) -> None:
    with pytest.raises(
        derive.SpecError, match=r"drives.motor.speed: at t = 0.2 s the speed jumps from 0 rad/s to 2.5 rad/s"
    ):
        check_drives(scene(folder, 'speed = "Omega*piecewise(t < 0.2, 0, 1)"'))
    check_drives(scene(folder, 'speed = "Omega*piecewise(t < 0.2, 0, t - 0.2)"'))


@pytest.mark.parametrize("drive", ['speed = "Omega*ramp(t)*step(t, 0, 1)"', 'motion = "Omega*(ramp(t) - 1)"'])
def test_a_table_builds_where_constraints_follow_it(tmp_path: Path, drive: str) -> None:
    spec = scene(tmp_path, drive, "keep_coordinates = true")
    model = derive.lower(derive.derive(spec))
    files = derive.model_files(model, spec)
    assert any(file.path.endswith("manifest.json") for file in files)
