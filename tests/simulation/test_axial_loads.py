"""Finite-element bodies without geometric stiffness under axial forces: between two joints, and held at one end."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.spec.model.spatial_scene import SpatialScene

NODES = {"left": list(range(9)), "right": list(range(108, 117))}


def notes(
    mass: float, right: tuple[int, ...] = tuple(NODES["right"]), *, kind: str = "spherical", **own: Any
) -> list[str]:
    """The notes of a short run of the hanging rod, on a joint of a kind, with a mass (kg) on a ball joint."""
    down = {"axis": [0, 1, 0], "angle": np.pi / 2}
    rod = {
        "nodes": str(ROOT / "examples/spatial_rod.npz"),
        "units": "SI",
        "modes": 4,
        "markers": {"left": {"nodes": NODES["left"]}, "right": {"nodes": list(right)}},
        "start": {"guess": True, "position": [0, 0, -0.15], "rotation": down},
        **own,
    }
    ball = {"mass": mass, "inertia": [1, 1, 1, 0, 0, 0], "markers": {"pin": [0, 0, 0]}}
    scene = derive.spatial_scene(
        "hanging",
        gravity=(0, 0, -9.81),
        start="equilibrium",
        ground={"hook": {"at": [0, 0, 0], "rotation": down}},
        bodies={"rod": rod, "ball": ball | {"start": {"guess": True, "position": [0, 0, -0.3]}}},
        joints={
            "upper": {"kind": kind, "between": ["ground.hook", "rod.left"]},
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


def test_a_mass_that_makes_the_rod_slow_does_not_make_it_soft() -> None:
    """Clamped with 0.4 kg at its end the rod vibrates six times as slowly as alone, and its weight changes nothing.

    Of P w'^2 the frame knows the part of its own rotation: 6/5 - 21/20^2 of P l^2 over 3 EI are left.
    """
    assert not notes(0.4, kind="fixed")
    (note,) = notes(200.0, kind="fixed", modes=6, interface=["left", "right"])
    left = (1.2 - 2 * 1.05 + 1.05**2) * 200 * 9.81 * 0.3**2 / (3 * 8.96)
    assert float(re.findall(r"about (\d+) %", note)[0]) / 100 == pytest.approx(left, rel=0.1)


EULER = np.pi**2 / 4 * 8.96 / 0.3**2
"""The load (N) under which the rod buckles in the soft plane if it is held at one end."""


def column(force: tuple[float, float, float], gravity: float = 0.0, *, kind: str = "fixed", **rod: Any) -> SpatialScene:
    """The rod that is held at its left end under a force at its right one, with its weight along it."""
    own = {"nodes": str(ROOT / "examples/spatial_rod.npz"), "units": "SI", "modes": 6, **rod}
    own["markers"] = {name: {"nodes": nodes} for name, nodes in NODES.items()}
    return derive.spatial_scene(
        "column",
        gravity=(-gravity, 0, 0),
        ground={"wall": (0, 0, 0)},
        bodies={"rod": own | {"start": {"guess": True, "position": [0.15, 0, 0]}}},
        joints={"clamp": {"kind": kind, "between": ["ground.wall", "rod.left"]}},
        forces={"end": {"at": "rod.right", "force": list(force)}},
        simulation={"duration": 1e-4, "output": 1e-4},
    )


def changes(scene: SpatialScene) -> list[float]:
    """The changes of the stiffness that the notes of a run and of its modes tell of, which agree."""
    run, modes = (
        [float(re.findall(r"about (-?\d+) %", note)[0]) / 100 for note in own if "held at left alone" in note]
        for own in (derive.simulate(scene).notes, derive.modes(scene).notes)
    )
    assert run == pytest.approx(modes, abs=0.02)
    return modes


def test_a_column_loses_the_part_of_its_stiffness_that_its_load_is_of_the_one_that_buckles_it() -> None:
    """Under a load at its end and under its weight; six free modes are stiffer than the rod, by a known part."""
    of_rod = 3.516 * np.sqrt(8.96 / (0.07536 * 0.3**3)) / (2 * np.pi)
    stiffer = derive.modes(column((0, 0, 0))).frequencies[0] / of_rod
    part = 0.4 / stiffer**2
    weight = 0.4 * 7.837 * 8.96 / 0.3**2
    assert changes(column((-0.4 * EULER, 0, 0))) == pytest.approx([-part], abs=0.01)
    assert changes(column((0, 0, 0), weight / 0.07536)) == pytest.approx([-part], abs=0.01)
    assert changes(column((0.4 * EULER, 0, 0))) == pytest.approx([part], abs=0.01)


@pytest.mark.long
def test_what_changes_little_or_does_not_hold_the_rod_as_a_cantilever_has_no_note() -> None:
    assert not changes(column((0, 0, 0.1 * EULER)))
    assert not changes(column((-0.02 * EULER, 0, 0)))
    run = derive.simulate(column((0.4 * EULER, 0, 0), kind="spherical")).notes
    assert not [note for note in run if "alone" in note]


def test_joints_at_one_marker_hold_the_rod_together() -> None:
    """Three joints that remove a displacement and a rotation each hold it as one that removes all."""
    scene = column((-0.4 * EULER, 0, 0))
    (clamp,) = scene.joints
    assert isinstance(clamp, derive.SpatialJoint)
    parts = tuple(
        replace(clamp, name=f"clamp{axis}", kind="general", removes=(axis, f"r{axis}")) for axis in ("x", "y", "z")
    )
    assert changes(replace(scene, joints=parts)) == pytest.approx(changes(scene), abs=0.01)
