"""The study of methods on scenes in space: limits of steps, drift and formulations of bodies with quaternions."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.cli.main import main
from derive.study.methods.drift import conserves
from derive.study.methods.methods_table import step_limit_table
from derive.study.methods.scene_methods import Method, method_scene
from derive.study.methods.step_limits import HighestFrequency, highest_frequency, step_limits

RIGID = ROOT / "examples/spatial_crank_slider_rigid.toml"


@pytest.mark.long
def test_the_methods_of_a_rigid_mechanism_in_space(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Its constraints drift by accelerations alone, and its quaternions in all forms, by the order 2 of their rules."""
    path = tmp_path / "rigid.toml"
    path.write_text(RIGID.read_text().replace("[scene]", '[scene]\ncoordinates = "absolute"'))
    asked = ["study", "methods", str(path), "--steps", "300", "--states", "5", "--integrators", "rk4,adaptive"]
    assert main([*asked, "--out", str(tmp_path), "--json"]) == 0
    said = capsys.readouterr()
    assert said.err == ""
    data = json.loads(said.out)
    assert [(line["failure"], line["agrees"]) for line in data["failures"]] == [("index 3 drift", True)]
    assert data["order"]["step"] == pytest.approx(4, abs=0.3) and data["order"]["time"] == pytest.approx(2, abs=0.3)
    assert data["conserved"] and all(run["energy"][-1] < 1e-4 for run in data["drifts"])
    forms = [form for form in data["forms"] if not form["failure"]]
    assert len(forms) >= 5 and all(1e-7 < form["quaternion"] < 1e-3 for form in forms)
    assert "Constraints drift" in (tmp_path / "methods.svg").read_text()


@pytest.mark.long
def test_explicit_steps_of_a_beam_in_space_are_stable_up_to_their_limit_alone() -> None:
    """A shaft that spins freely between a ball joint and a line, without damping: its energy is conserved."""
    along = {"x": [0, 0, -1], "y": [0, 1, 0]}
    ground: dict[str, Any] = {"left": (0, 0, 0), "right": {"at": (1, 0, 0), "rotation": along}}
    scene = derive.spatial_scene(
        "spun",
        ground=ground,
        bodies={
            "rod": {
                "length": 1,
                "mass": 1,
                "bending_stiffness": 100,
                "rotary_inertia": "1/1000",
                "frame": "chord",
                "ansatz": {"kind": "pinned", "count": 1},
                "order": 2,
                "markers": {"left": -1, "right": 1},
                "start": {"angular_velocity": [3, 0, 0], "amplitudes": [0.01]},
            }
        },
        joints={
            "left": {"kind": "spherical", "between": ["ground.left", "rod.left"]},
            "right": {"kind": "point_on_line", "between": ["ground.right", "rod.right"]},
        },
        simulation={"duration": 1, "output": 0.01},
    )
    of = method_scene(scene)
    states = of.motion(5).states
    frequency = highest_frequency(of, states)
    assert conserves(of, states)
    for limit in step_limits(of, frequency, [Method.RK4, Method.ADAPTIVE], lambda _: None):
        assert limit.below and not limit.above and limit.ratio == pytest.approx(1, abs=0.05)


def test_implicit_methods_whose_steps_do_not_resolve_the_motion_are_not_tried() -> None:
    """Where a revolution has less than seven periods of the fastest mode; nothing is said to grow."""
    scene: Any = SimpleNamespace(scene=SimpleNamespace(name="slow"), period=1.0)
    frequency = HighestFrequency(1.0, 1.0, (0.0, *np.zeros((2, 1))), 1.0)
    limits = step_limits(scene, frequency, [Method.TRAPEZOIDAL], lambda _: None)
    study: Any = SimpleNamespace(frequency=frequency, limits=limits, along="one revolution of spin")
    text = " ".join(line.strip() for line in step_limit_table(study).text)
    assert "grows at" not in text and "not tried: steps of omega h = 3 are more than a 20th of one revolution" in text
