"""Finite-element bodies without geometric stiffness that joints pull: a rod with a mass that hangs on it."""

from __future__ import annotations

import re

import numpy as np
import pytest

import derive
from conftest import ROOT

NODES = {"left": list(range(9)), "right": list(range(108, 117))}


def notes(mass: float, right: tuple[int, ...] = tuple(NODES["right"])) -> list[str]:
    """The notes of a short run of the hanging rod with a mass (kg) on a ball joint."""
    down = {"axis": [0, 1, 0], "angle": np.pi / 2}
    rod = {
        "nodes": str(ROOT / "examples/spatial_rod.npz"),
        "units": "SI",
        "modes": 4,
        "markers": {"left": {"nodes": NODES["left"]}, "right": {"nodes": list(right)}},
        "start": {"guess": True, "position": [0, 0, -0.15], "rotation": down},
    }
    ball = {"mass": mass, "inertia": [1, 1, 1, 0, 0, 0], "markers": {"pin": [0, 0, 0]}}
    scene = derive.spatial_scene(
        "hanging",
        gravity=(0, 0, -9.81),
        ground={"hook": (0, 0, 0)},
        bodies={"rod": rod, "ball": ball | {"start": {"guess": True, "position": [0, 0, -0.3]}}},
        joints={
            "upper": {"kind": "spherical", "between": ["ground.hook", "rod.left"]},
            "lower": {"kind": "spherical", "between": ["rod.right", "ball.pin"]},
        },
        simulation={"duration": 1e-4, "output": 1e-4},
    )
    return [note for note in derive.simulate(scene).notes if "along the line between" in note]


def test_a_rod_that_a_weight_pulls_is_stiffer() -> None:
    """By P l^2/(pi^2 EI), EI = 8.96 N m^2 in the soft plane, to 5 % by which two free modes of bending are stiffer."""
    (note,) = notes(200.0)
    pull = (200 + 0.07536 / 2) * 9.81
    of_euler = pull * 0.3**2 / (np.pi**2 * 8.96)
    assert "pull it" in note and f"with {pull:.3g} N" in note
    assert float(re.findall(r"about (\d+) %", note)[0]) / 100 == pytest.approx(of_euler, rel=0.06)


def test_a_small_weight_changes_little() -> None:
    """2 % are within the limit."""
    assert not notes(2.0)
