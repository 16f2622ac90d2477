"""A start in steady motion in the plane: the motion stays in it, and `modes` are those in axes that rotate along."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import derive
from derive.cli.main import main
from derive.simulation.linear import steady_motion
from derive.simulation.linear.modes import Modes, modes
from derive.simulation.linear.steady_motion import NoSteadyMotion
from derive.spec.model.scene import STEADY
from derive.spec.toml.read import parse
from explicit_motion import moved

BEAD = """
name = "bead"
[scene]
start = "steady"
[ground.markers]
axis = [0, 0]
[bodies.hub]
markers = { centre = [0, 0] }
[bodies.bead]
mass = 2
inertia = 1
markers = { pin = [0, 0] }
start = { position = [1, 0] }
[joints.shaft]
kind = "revolute"
between = ["ground.axis", "hub.centre"]
[joints.guide]
kind = "translational"
between = ["hub.centre", "bead.pin"]
[drives.motor]
joint = "shaft"
speed = 3
[springs.tie]
kind = "linear"
between = ["hub.centre", "bead.pin"]
stiffness = 50
rest = 1
[outputs.radius]
kind = "distance"
between = ["hub.centre", "bead.pin"]
[simulation]
duration = 2
output = 0.25
tolerance = 1e-10
"""
RADIUS = 50 / (50 - 2 * 3**2)
"""m: where the spring balances the centrifugal force."""


def test_a_bead_stays_where_the_spring_holds_it() -> None:
    scene = parse(BEAD)
    run = moved(scene)
    assert run["radius"] == pytest.approx(np.full(9, RADIUS), abs=1e-8)
    assert any(note.startswith("steady rotation with 3 rad/s") for note in run.notes)
    loose = moved(replace(scene, start=None))
    assert np.ptp(loose["radius"]) > 0.5


def test_modes_are_those_of_the_steady_motion(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The bead vibrates along its guide at sqrt(k/m - w^2) = 4 rad/s."""
    result = modes(parse(BEAD))
    assert result.steady is not None and result.equilibrium is None
    assert 2 * np.pi * result.frequencies == pytest.approx([4.0], rel=1e-9)
    (tmp_path / "bead.toml").write_text(BEAD)
    assert main(["modes", str(tmp_path / "bead.toml"), "--out", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert "1 modes about the steady rotation with 3 rad/s, in axes that rotate with it" in text


def test_positions_are_those_in_axes_that_rotate() -> None:
    """A mass at 5 rad/s in space vibrates at 5 - 3 and 5 + 3 rad/s."""
    disc = {"mass": 2, "inertia": 1, "markers": {"pin": [0, 0]}, "start": {"position": [0, 0], "spin": 3}}

    def result(stiffness_y: float) -> Modes:
        tie = {"kind": "bushing", "between": ["ground.axis", "disc.pin"], "stiffness_x": 50, "stiffness_y": stiffness_y}
        scene = derive.scene("whirling", ground={"axis": [0, 0]}, bodies={"disc": disc}, springs={"tie": tie})
        return modes(replace(scene, start=STEADY))

    found = 2 * np.pi * result(50).frequencies
    assert found[found > 0] == pytest.approx([2, 8], rel=1e-9)
    with pytest.raises(NoSteadyMotion, match="is not the same in axes that move with the scene"):
        result(51)


def test_another_angle_of_a_steady_rotation_is_no_other_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    """A disc on springs that are alike in all directions is the same at each angle, which rounding may change."""
    disc = {"mass": 2, "inertia": 1, "markers": {"pin": [0, 0]}, "start": {"position": [0, 0], "spin": 3}}
    tie = {"kind": "bushing", "between": ["ground.axis", "disc.pin"], "stiffness_x": 50, "stiffness_y": 50}
    scene = derive.scene("whirling", ground={"axis": [0, 0]}, bodies={"disc": disc}, springs={"tie": tie}, start=STEADY)
    monkeypatch.setattr(steady_motion, "_balanced", lambda native, k, q, field: np.add(q, [0, 0, 2]))
    found = 2 * np.pi * modes(scene).frequencies
    assert found[found > 0] == pytest.approx([2, 8], rel=1e-9)
