"""Drives that follow functions of every kind: their derivatives, the velocities at the start, and what is at rest."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import derive
from derive.roles import Role
from derive.simulation.errors import SimulationError
from derive.simulation.initial.kinematics import Kinematics
from derive.simulation.initial.start_state import start_state
from derive.simulation.time_derivatives import derivatives_at
from derive.spec.model.scene import Scene
from derive.spec.model.time_function import value_at
from derive.spec.parsing.time_expression import time_function
from derive.spec.toml.read import parse
from explicit_motion import moved

ARM = """
name = "driven_arm"
ground.markers = { bearing = [0, 0], second = [0, 1], third = [0, 2], fourth = [0, 3], fifth = [0, 4] }
parameters = { A = { default = 0.3, unit = "rad" } }
tables = { lift = { file = "lift.csv", x = "t", y = "s" } }
inputs = { angle = { unit = "rad", value = "A*t" } }
bodies.free = { mass = 1, inertia = 1 }
"""
DRIVES = {
    "by_parameter": '"A*sin(t)"',
    "accelerated": '"min(t^2, 2*t^2)"',
    "by_step": '"A*step(t, 0, 0.5)"',
    "by_table": '"lift(t)^3"',
    "by_input": '{ input = "angle" }',
}
"""The third and the fourth are at rest at t = 0."""


def arms(folder: Path) -> Scene:
    (folder / "lift.csv").write_text("t,s\n0,0\n1,1\n2,3\n")
    text = ARM
    for marker, (name, motion) in zip(("bearing", "second", "third", "fourth", "fifth"), DRIVES.items(), strict=True):
        body = f"[bodies.arm_{name}]\nmass = 1\ninertia = 0.1\nmarkers = {{ hub = [0, 0] }}\n"
        joint = f'[joints.hinge_{name}]\nkind = "revolute"\nbetween = ["ground.{marker}", "arm_{name}.hub"]\n'
        text += f'{body}{joint}[drives.{name}]\njoint = "hinge_{name}"\nmotion = {motion}\n'
    result = parse(text, str(folder / "arms.toml"))
    assert isinstance(result, Scene)
    return result


def test_an_equilibrium_needs_drives_at_rest_whatever_their_functions_are(tmp_path: Path) -> None:
    with pytest.raises(SimulationError) as caught:
        derive.modes(arms(tmp_path))
    assert "no static equilibrium: by_parameter, accelerated and by_input." in str(caught.value)


@pytest.mark.parametrize(
    ("motion", "t", "expected"),
    [
        ("3*t^2 - t", 0.5, (0.25, 2.0, 6.0)),
        ("step(t, 0, 2)", 1.0, (0.5, 0.9375, 0.0)),
        ("step(t, 0, 2)", 0.0, (0.0, 0.0, 0.0)),
        ("piecewise(t < 1, t, t < 2, t^2, 0)", 1.5, (2.25, 3.0, 2.0)),
        ("abs(t - 2)^3", 1.0, (1.0, -3.0, 6.0)),
        ("min(t^2, 1 + t) + max(t, 2)", 0.5, (2.25, 1.0, 2.0)),
        ("exp(2*t)", 0.0, (1.0, 2.0, 4.0)),
        ("atan2(t, 1)", 0.0, (0.0, 1.0, 0.0)),
        ("t^2*sqrt(t)", 0.0, (0.0, 0.0, 0.0)),
    ],
)
def test_derivatives_of_functions_of_time(motion: str, t: float, expected: tuple[float, ...]) -> None:
    assert derivatives_at(time_function(motion), t, "") == pytest.approx(expected, rel=1e-14, abs=1e-14)


@pytest.mark.parametrize(
    ("motion", "speed"),
    [
        ("step(t, 0, 0.5)", 0.0),
        ("step(t, 0.001, 0.5)", 0.0),
        ("max(t, 0)", 1.0),
        ("piecewise(t < 0, 0, t)", 1.0),
        ("3*t + t*abs(t)", 3.0),
        ("t + t^2*sqrt(t)", 1.0),
        ("piecewise(t < 0.001, t, 0.001)", 1.0),
        ("log(1 + t)", 1.0),
        ("0.0005*sin(100*t)", 0.05),
        ("1e-8*t", 1e-8),
        ("sin(2*pi*t)", 2 * np.pi),
        ("tanh(1000*t)", 1000.0),
        ("150*t", 150.0),
        ("0*t", 0.0),
    ],
)
def test_bodies_begin_with_the_velocity_behind_the_start(motion: str, speed: float) -> None:
    """The velocity is that of the function at t > 0, which may have no value before, or another one.

    Its error is the rounding of a pose over the time in which the function is smooth, or which the run could take.
    """
    function = time_function(motion)

    def poses(t: float, q: Any, k: Any) -> Any:
        angle = value_at(function, t)
        return np.array([[np.cos(angle + 0.4), np.sin(angle + 0.4), angle]])

    native: Any = SimpleNamespace(roles=(Role.ROTATION,), poses=poses)
    drifts = Kinematics(native, np.zeros(0), 0.0, np.zeros(1), 1.0, moving=True).drifts
    expected = speed * np.array([[-np.sin(0.4), np.cos(0.4), 1.0]])
    np.testing.assert_allclose(drifts, expected, rtol=5e-9, atol=0.0)


CRANK = """
name = "started_crank"
ground.markers = { bearing = [0, 0] }
[bodies.crank]
mass = 0.3
inertia = 0.01
markers = { hub = [0, 0], pin = [0.2, 0] }
[bodies.rod]
mass = 1
inertia = 0.1
markers = { left = [-0.5, 0] }
start = { position = [0.7, 0], spin = 0 }
[joints.bearing]
kind = "revolute"
between = ["ground.bearing", "crank.hub"]
[joints.pin]
kind = "revolute"
between = ["crank.pin", "rod.left"]
[drives.motor]
joint = "bearing"
motion = "MOTION"
[simulation]
duration = 0.01
output = 0.01
"""


def test_a_smooth_start_is_at_rest_and_a_kink_at_the_start_is_refused() -> None:
    """A rod on a driven crank is at rest at the start of a step; |t| has no speed at t = 0, where the run begins."""
    scene = parse(CRANK.replace("MOTION", "step(t, 0, 0.5)"), "crank.toml")
    assert isinstance(scene, Scene)
    trajectory = moved(scene)
    assert {name: trajectory[name][0] for name in trajectory.columns if name.endswith("dot")} == {"rod_phidot": 0.0}
    kinked = parse(CRANK.replace("MOTION", "2*abs(t)"), "crank.toml")
    assert isinstance(kinked, Scene)
    with pytest.raises(derive.SpecError, match="its speed is 0 rad/s there in the generated code, and 2 rad/s behind"):
        moved(kinked)


def test_a_given_spin_of_zero_is_kept_beside_a_fast_drive() -> None:
    """Rounding errors of fast bodies are no contradiction."""
    scene = parse(CRANK.replace("MOTION", "150*t"), "crank.toml")
    assert isinstance(scene, Scene)
    assert moved(scene)["rod_phidot"][0] == pytest.approx(0.0, abs=1e-12)


def test_a_table_moves_a_joint_that_is_a_constraint(tmp_path: Path) -> None:
    """The initial state of the generated code is computed in decimal arithmetic, which reads the table as well."""
    (tmp_path / "lift.csv").write_text("t,s\n0,0.25\n1,1\n2,3\n")
    text = CRANK.replace('"MOTION"', '"lift(t)"').replace("inertia = 0.01", "inertia = 0.01\nkeep_coordinates = true")
    table = 'tables = { lift = { file = "lift.csv", x = "t", y = "s" } }\n'
    scene = parse(table + text.replace("start = { position = [0.7, 0], spin = 0 }", ""), str(tmp_path / "crank.toml"))
    assert isinstance(scene, Scene)
    start = start_state(scene, derive.lower(derive.derive(scene)))
    assert start.q[2] == 0.25
