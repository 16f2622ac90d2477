"""Distributed loads on beams in space, and masses on them: planar motions, deflections and twists, frequencies."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rods_in_space import PLANAR_ROD, accelerations
from scipy.optimize import brentq
from space_oracle import SpaceOracle
from written_scene import tables

import derive

OTHERS = {"rotary_inertia": "1/50", "torsion": {"ansatz": ["xi"], "stiffness": 7}}
CLAMPED: dict[str, Any] = {"frame": {"kind": "tangent", "at": -1}, "markers": {"left": -1, "right": 1}}


@pytest.mark.parametrize("order", [pytest.param(1, marks=pytest.mark.long), 2])
def test_loads_and_masses_in_a_plane_are_those_of_the_planar_beam(order: int) -> None:
    """A free beam with two loads and two masses has the accelerations of the planar beam with them.

    At first order the masses are points: displacements that are linear in the amplitudes stretch a body that turns.
    """
    rod = PLANAR_ROD | {"frame": "chord", "order": order}
    J = 0.02 * (order == 2)
    masses: dict[str, Any] = {"tip": {"at": 1, "mass": 0.3, "inertia": J}, "other": {"at": "-1/3", "mass": 0.2}}
    loads: dict[str, Any] = {
        "wind": {"force": [3, "5*(1 - xi^2)"], "time": "cos(2*t)"},
        "pull": {"force": ["xi", "xi"], "frame": "body"},
    }
    truncated = {"terms": "truncated"} if order == 2 else {}
    plane = derive.scene("plane", bodies={"rod": rod | {"masses": masses, "loads": loads} | truncated})
    in_space = {
        "masses": {"tip": masses["tip"] | {"inertia": [J, 1.5 * J, J, 0, 0, 0]}, "other": masses["other"]},
        "loads": {name: load | {"force": [*load["force"], 0]} for name, load in loads.items()},
    }
    space = derive.spatial_scene("space", bodies={"rod": rod | OTHERS | in_space})
    rng = np.random.default_rng(3)
    c, alpha, cdot, alphadot = (size * rng.normal(size=n) for size, n in ((1, 2), (0.01, 3), (1, 2), (0.3, 3)))
    half, none = 0.35, np.zeros(3)
    ours = accelerations(plane, np.r_[c, 2 * half, alpha], np.r_[cdot, 2.0, alphadot], 0.7)
    q = np.r_[c, 0, [np.cos(half), 0, 0, np.sin(half)], alpha[:2], none, alpha[2]]
    both = accelerations(space, q, np.r_[cdot, 0, 0, 0, 2.0, alphadot[:2], none, alphadot[2]], 0.7)
    scale = np.abs(ours).max()
    assert np.abs(both[[0, 1, 5, 6, 7, 11]] - ours).max() < 2e-13 * scale
    assert np.abs(both[[2, 3, 4, 8, 9, 10]]).max() < 1e-13 * scale


@pytest.mark.parametrize("frame", ["inertial", "body"])
def test_torques_per_length_do_the_work_of_those_on_sections(frame: str, tmp_path: Path) -> None:
    """A bent beam that they turn, alone or with forces, moves as in the oracle, which has more points."""
    force = 'force = [0, "3*xi", 1]\n' if frame == "body" else ""
    (tmp_path / "rod.toml").write_text(f"""
name = "turned"
[bodies.rod]
length = 1.5
mass = 2
bending_stiffness = 30
rotary_inertia = 0.02
ansatz = ["1", "xi", "xi^2"]
torsion = {{ ansatz = ["xi"], stiffness = 7 }}
markers = {{ left = -1 }}
[bodies.rod.loads.wind]
{force}torque = ["2*xi", 0.7, "1 - xi^2"]
time = "cos(2*t)"
frame = "{frame}"
""")
    scene = derive.read(tmp_path / "rod.toml")
    model = derive.lower(derive.derive(scene), explicit=True)
    names = [c.name for c in model.coordinates]
    turn, rng = np.array([0.8, 0.2, -0.4, 0.4]), np.random.default_rng(3)
    amplitudes = 1e-4 * rng.normal(size=len(names) - 7)  # their squares are in normalised quaternions
    q, v = np.r_[0.1, -0.2, 0.3, turn, amplitudes], 0.3 * rng.normal(size=len(names) - 1)
    expected = SpaceOracle(tables(tmp_path / "rod.toml"), names).see(0.7, q, v).accelerations()[0].astype(float)
    assert np.abs(accelerations(scene, q, v, 0.7) - expected).max() < 1e-9 * np.abs(expected).max()


@pytest.mark.long
def test_uniform_loads_deflect_and_twist_a_cantilever() -> None:
    """Uniform loads deflect the tip of a cantilever by w l^4/(8 EI), stretch it by w l^2/(2 EA) and twist it."""
    quartic = {"ansatz": [f"xi^{k}" for k in range(5)], "axial": {"ansatz": ["xi", "xi^2"], "stiffness": 1000}}
    shapes = quartic | {"torsion": {"ansatz": ["xi", "xi^2"], "stiffness": 7}, "lateral": {"bending_stiffness": 12}}
    loads = {"all": {"force": [2, 1e-5, 3e-5], "torque": [5e-5, 0, 0]}}
    rod = PLANAR_ROD | OTHERS | CLAMPED | shapes | {"loads": loads}
    scene = derive.spatial_scene(
        "loaded",
        ground={"o": (0, 0, 0)},
        bodies={"rod": rod},
        joints={"clamp": {"kind": "fixed", "between": ["ground.o", "rod.left"]}},
    )
    modes = derive.modes(scene)
    assert modes.equilibrium is not None
    names = [coordinate.name for coordinate in derive.lower(derive.derive(scene), explicit=True).coordinates]
    alpha = dict(zip(names, modes.linear.q, strict=True))
    along = [[alpha[f"rod_alpha{i}"] for i in numbers] for numbers in ((1, 2, 3), (4, 5, 6), (7, 8), (9, 10))]
    # The shapes are one at the tip, but for the second ones of torsion and stretching, which vanish there.
    v, w, twist, stretch = sum(along[0]), sum(along[1]), along[2][0] * 2 / 1.5, along[3][0]
    assert v == pytest.approx(1e-5 * 1.5**4 / 8 / 30, rel=1e-3)
    assert w == pytest.approx(3e-5 * 1.5**4 / 8 / 12, rel=1e-3)
    assert twist == pytest.approx(5e-5 * 1.5**2 / 2 / 7, rel=1e-3)
    assert stretch == pytest.approx(2 * 1.5**2 / 2 / 1000, rel=1e-3)


def test_frequencies_with_a_mass_at_the_tip() -> None:
    """A cantilever with a mass at its tip has the frequencies of the characteristic equation of beams."""
    rod = PLANAR_ROD | OTHERS | CLAMPED | {"ansatz": [f"xi^{k}" for k in range(6)]}
    rod |= {"masses": {"tip": {"at": 1, "mass": 1}}}
    del rod["axial"], rod["torsion"]

    def characteristic(x: float) -> float:
        c, s, ch, sh = np.cos(x), np.sin(x), np.cosh(x), np.sinh(x)
        return float(1 + c * ch + 0.5 * x * (c * sh - s * ch))

    exact = [brentq(characteristic, *bracket) ** 2 * np.sqrt(30 / (2 * 1.5**3)) for bracket in ((1, 2), (3.5, 4.5))]
    scene = derive.spatial_scene(
        "tip",
        ground={"o": (0, 0, 0)},
        bodies={"rod": rod},
        joints={"clamp": {"kind": "fixed", "between": ["ground.o", "rod.left"]}},
    )
    found = derive.modes(scene).frequencies * 2 * np.pi
    assert found[:2] == pytest.approx(exact[0], rel=1e-5)
    assert found[2:4] == pytest.approx(exact[1], rel=2e-3)


@pytest.mark.long
def test_masses_are_bodies_that_are_fixed_to_sections() -> None:
    """A body at the tip with an offset and a full tensor gives the frequencies that it has as a body of the scene."""
    tensor, centre = [0.02, 0.03, 0.025, 0.002, -0.003, 0.004], (0.1, 0.05, -0.08)
    mass = {"at": 1, "mass": 0.7, "inertia": tensor, "centre": centre}
    rod = PLANAR_ROD | OTHERS | CLAMPED | {"lateral": {"bending_stiffness": 12}}
    clamp = {"clamp": {"kind": "fixed", "between": ["ground.o", "rod.left"]}}
    own: dict[str, Any] = {"ground": {"o": (0, 0, 0)}, "joints": clamp}
    attached = derive.spatial_scene("attached", bodies={"rod": rod | {"masses": {"tip": mass}}}, **own)
    bob = {"mass": 0.7, "inertia": tensor, "centre": centre, "markers": {"o": (0, 0, 0)}}
    weld = {"weld": {"kind": "fixed", "between": ["rod.right", "bob.o"]}}
    joined = derive.spatial_scene("joined", bodies={"rod": rod, "bob": bob}, **own | {"joints": clamp | weld})
    first, second = (derive.modes(scene).frequencies for scene in (attached, joined))
    assert first == pytest.approx(second, rel=1e-9)
