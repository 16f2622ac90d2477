"""The initial state in the generated code: that of a simulation, the same on every machine, and exact."""

from __future__ import annotations

import ctypes
from dataclasses import replace
from functools import cache
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from toolchain import scene, text_of

import beams
import derive
from conftest import QUICK, ROOT
from derive.cli.main import main
from derive.ir.model import StartState
from derive.pipeline import build
from derive.runtime.interpreted_scene import InterpretedScene
from derive.runtime.loading import load_scene
from derive.runtime.native_scene import NativeScene
from derive.simulation.initial import start_state as module
from derive.simulation.initial.initial_state import initial_state
from derive.simulation.initial.start_state import start_state
from explicit_motion import moved


@cache
def start(name: str) -> StartState:
    made = scene(name)
    return start_state(made.spec, made.model)


@cache
def native(name: str) -> NativeScene:
    """The compiled scene with its initial state."""
    made = scene(name)
    return load_scene(derive.model_files(replace(made.model, start=start(name)), made.spec), QUICK)


@pytest.mark.parametrize("name", ["four_bar", "crank_slider_3"])
def test_it_is_the_initial_state_of_a_simulation(name: str) -> None:
    compiled, state = native(name), start(name)
    expected = initial_state(scene(name).spec, compiled)
    assert np.array(state.q) == pytest.approx(expected.q, abs=1e-12)
    assert np.array(state.v) == pytest.approx(expected.v, abs=1e-9)
    k = compiled.setup()
    assert np.abs(compiled.constraints(0.0, np.array(state.q), k)).max() < 3e-16
    assert np.abs(compiled.constraint_rates(0.0, np.array(state.q), np.array(state.v), k)).max() < 1e-13


def test_numbers_of_the_specification_stay_and_others_are_exact() -> None:
    """The crank of the four-bar stands upright, and nothing is deformed."""
    names, q = native("four_bar").coordinates, start("four_bar").q
    assert q[names.index("crank_phi")] == pi / 2
    deformed = {name: x for name, x in zip(names, q, strict=True) if "alpha" in name}
    assert deformed and set(deformed.values()) == {0.0}


def test_rounding_errors_of_a_machine_do_not_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    """Other libraries of linear algebra give other last digits."""
    made, rng = scene("four_bar"), np.random.default_rng(1)
    exact = module.state_of(made.spec, InterpretedScene(made.model))

    def elsewhere(*_: Any) -> Any:
        noise = 2e-15 * rng.uniform(-1, 1, (2, len(exact.q)))
        return replace(exact, q=exact.q + noise[0], v=exact.v + noise[1])

    monkeypatch.setattr(module, "state_of", elsewhere)
    for _ in range(3):
        assert start_state(made.spec, made.model) == start("four_bar")


def test_the_generated_function_returns_it() -> None:
    compiled, q, v = native("crank_slider_3"), np.empty(16), np.empty(16)
    doubles = ctypes.POINTER(ctypes.c_double)
    assert compiled.function("start")(q.ctypes.data_as(doubles), v.ctypes.data_as(doubles)) == 0
    assert (tuple(q), tuple(v)) == (start("crank_slider_3").q, start("crank_slider_3").v)


def test_files_made_in_python_are_those_of_build() -> None:
    """Python writes the same bytes as `build`, with the initial state."""
    made, path = scene("four_bar"), ROOT / "scenes/four_bar.toml"
    files = derive.model_files(made.model, made.spec)
    assert files == build(path).files
    header = next(file.text for file in files if file.path.endswith(".h"))
    assert "int four_bar_start(\n    double *q,\n    double *v);\n" in header


def test_a_body_has_none() -> None:
    assert not beams.native("point", 2).function("start")
    assert "_start(" not in text_of(beams.made("point", 2), ".h")


def test_build_says_why_there_is_none(tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    spec = tmp_path / "far.toml"
    spec.write_text(
        'name = "far"\n[ground.markers]\na = [0, 0]\nb = [9, 0]\n[bodies.bar]\nmass = 1\ninertia = 1\n'
        'markers = { p = [0, 0], q = [1, 0] }\n[joints.left]\nkind = "revolute"\nbetween = ["ground.a", "bar.p"]\n'
        '[joints.right]\nkind = "revolute"\nbetween = ["ground.b", "bar.q"]\n'
    )
    assert main(["build", str(spec), "--out", str(tmp_path)]) == 0
    assert "no function far_start, since there is no initial state: " in capsys.readouterr().out
    assert "far_start" not in (tmp_path / "far/far.h").read_text()
    far = derive.read(spec)
    with pytest.warns(UserWarning, match="no function far_start, since there is no initial state: ") as caught:
        files = derive.model_files(derive.lower(derive.derive(far)), far)
    assert caught[0].filename == __file__
    assert files[0].text == (tmp_path / files[0].path).read_text()


def test_interpreted_functions_are_the_compiled_ones() -> None:
    """Sums and products have the same order; sines may differ in the last digit."""
    compiled, slow = native("crank_slider_3"), InterpretedScene(scene("crank_slider_3").model)
    rng = np.random.default_rng(2)
    q, v, r = rng.uniform(-0.1, 0.1, (3, 16))
    k, r = np.array(compiled.setup()), r[: compiled.nlambda]
    pairs = [
        (slow.setup(), k),
        (slow.mass(q, k), compiled.mass(q, k)),
        (slow.force(0.1, q, v, k), compiled.force(0.1, q, v, k)),
        (slow.constraint_jacobian(0.1, q, k), compiled.constraint_jacobian(0.1, q, k)),
        (slow.project_velocity(0.1, q, k, r), compiled.project_velocity(0.1, q, k, r)),
        (np.hstack(slow.solve(0.1, q, v, k)), np.hstack(compiled.solve(0.1, q, v, k))),
        (slow.poses(0.1, q, k), compiled.poses(0.1, q, k)),
        *zip(slow.marker(slow.markers[0], q, v, k), compiled.marker(slow.markers[0], q, v, k), strict=True),
    ]
    for one, other in pairs:
        assert one == pytest.approx(other, rel=1e-12, abs=1e-12 * (np.abs(other).max(initial=0.0) + 1e-300))
    assert (slow.coordinates, slow.roles, slow.bodies) == (compiled.coordinates, compiled.roles, compiled.bodies)
    assert slow.multipliers == compiled.multipliers and slow.markers == compiled.markers


def test_inputs_have_their_values_at_the_start(tmp_path, capsys) -> None:
    """A prescribed motion that is an input, and a force that is one: built, reported, and started as simulated."""
    text = """
name = "pushed"
ground.markers = { o = [0, 0] }
[bodies.crank]
mass = 1
inertia = 0.1
markers = { hub = [0, 0], pin = [1, 0] }
[bodies.rod]
mass = 1
inertia = 0.1
markers = { left = [-1, 0], right = [1, 0] }
start = { position = [1.5, 0.5], guess = true }
[joints.bearing]
kind = "revolute"
between = ["ground.o", "crank.hub"]
[joints.pin]
kind = "revolute"
between = ["crank.pin", "rod.left"]
[inputs.turn]
unit = "rad"
value = "0.3 + 2*t"
[inputs.push]
value = "5"
[drives.motor]
joint = "bearing"
motion = { input = "turn" }
[forces.push]
at = "rod.right"
components = [{ input = "push" }, 0]
[outputs.tip]
kind = "position"
marker = "rod.right"
[simulation]
duration = 0.1
output = 0.1
"""
    (tmp_path / "pushed.toml").write_text(text)
    assert main(["build", str(tmp_path / "pushed.toml"), "--out", str(tmp_path)]) == 0
    assert "warning" not in capsys.readouterr().out
    assert "pushed_start" in next(tmp_path.rglob("pushed.h")).read_text()
    assert main(["report", str(tmp_path / "pushed.toml"), "--out", str(tmp_path / "pushed.html")]) == 0
    page = (tmp_path / "pushed.html").read_text()
    assert "Inputs u" in page and "Outputs" in page
    made = build(tmp_path / "pushed.toml")
    assert made.model.start is not None
    expected = moved(derive.read(tmp_path / "pushed.toml"))
    assert np.array(made.model.start.q) == pytest.approx(expected.q[0], abs=1e-9)
    assert np.array(made.model.start.v) == pytest.approx(expected.v[0], abs=1e-8)
    (tmp_path / "none.toml").write_text(text.replace('value = "5"', 'unit = "N"').replace("pushed", "none"))
    assert main(["build", str(tmp_path / "none.toml"), "--out", str(tmp_path)]) == 0
    assert "no function none_start" in capsys.readouterr().out


@pytest.mark.parametrize("motion", ["0.4 + lift(t)", "exp(t) - tanh(t - 0.3) + atan2(1 + t, 2)*lift(t)"])
def test_a_drive_follows_any_function_at_the_start(motion: str, tmp_path, capsys) -> None:
    (tmp_path / "lift.csv").write_text("t,y\n0,0.1\n0.5,0.2\n1,0\n")
    (tmp_path / "driven.toml").write_text(f"""
name = "driven"
ground.markers = {{ o = [0, 0] }}
[bodies.crank]
markers = {{ hub = [0, 0], pin = [1, 0] }}
[bodies.rod]
length = 2
mass = 1
bending_stiffness = 100
markers = {{ left = -1, right = 1 }}
[joints.bearing]
kind = "revolute"
between = ["ground.o", "crank.hub"]
[joints.pin]
kind = "revolute"
between = ["crank.pin", "rod.left"]
[drives.motor]
joint = "bearing"
motion = "{motion}"
[simulation]
duration = 0.1
output = 0.1
[tables.lift]
file = "lift.csv"
x = "t"
y = "y"
""")
    assert main(["build", str(tmp_path / "driven.toml"), "--out", str(tmp_path)]) == 0
    assert "warning" not in capsys.readouterr().out
    made = build(tmp_path / "driven.toml").model
    expected = initial_state(derive.read(tmp_path / "driven.toml"), InterpretedScene(made))
    assert np.array(made.start.q) == pytest.approx(expected.q, abs=1e-9)
    assert np.array(made.start.v) == pytest.approx(expected.v, abs=1e-8)


def test_build_computes_a_start_in_equilibrium(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "sag.toml"
    path.write_text("""
name = "sag"
[ground.markers]
o = [0, 0]
[scene]
gravity = [0, -9.81]
start = "equilibrium"
[bodies.arm]
length = 1
mass = 1
bending_stiffness = 100
markers = { root = -1 }
start = { position = [0.5, 0] }
[joints.clamp]
kind = "weld"
between = ["ground.o", "arm.root"]
[simulation]
duration = 0.1
output = 0.1
""")
    assert main(["build", str(path), "--out", str(tmp_path)]) == 0
    assert "warning" not in capsys.readouterr().out
    assert build(path).model.start.q[1] == pytest.approx(-9.81 / 2000, rel=0.04)  # m g l^3/(20 EI)
