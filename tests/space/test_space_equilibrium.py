"""Static equilibria in space against closed forms: a bar on a hinge and a spring, and a finite-element cantilever."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from conftest import ROOT
from derive.simulation.linear.modes import modes
from derive.spec.toml.read import parse
from explicit_motion import moved

BAR = """
name = "space_bar_on_a_spring"
[scene]
gravity = [0, 0, -9.81]
start = "equilibrium"
[ground.markers]
o = { at = [0, 0, 0], rotation = { z = [0, 1, 0], x = [1, 0, 0] } }
hook = [0.3, 0.2, 0.4]
[bodies.bar]
mass = 2
centre = [0.25, 0, 0]
inertia = [1e-3, 0.04, 0.04, 0, 0, 0]
markers = { left = { at = [0, 0, 0], rotation = { z = [0, 1, 0], x = [1, 0, 0] } }, right = [0.5, 0, 0] }
[joints.hinge]
kind = "revolute"
between = ["ground.o", "bar.left"]
start = { angle = 0.1, guess = true }
[springs.wire]
between = ["ground.hook", "bar.right"]
stiffness = 300
rest = 0.1
[simulation]
duration = 1
output = 0.1
"""


def bar_energy(angle: float) -> float:
    """The potential energy of the bar, J, which an angle about y turns downwards."""
    right = 0.5 * np.array([np.cos(angle), 0.0, -np.sin(angle)])
    stretch = np.linalg.norm(right - [0.3, 0.2, 0.4]) - 0.1
    return float(2 * 9.81 * right[2] / 2 + 150 * stretch**2)


def test_a_bar_on_a_hinge_and_a_spring() -> None:
    """Rest is where its energy is least, and its frequency is that of the curvature there."""

    def slope(angle: float, h: float = 1e-3) -> float:
        near = (bar_energy(angle + h) - bar_energy(angle - h)) / (2 * h)
        return (4 * near - (bar_energy(angle + 2 * h) - bar_energy(angle - 2 * h)) / (4 * h)) / 3

    angle = brentq(slope, -1.5, 0.1, xtol=1e-14)
    curvature = (slope(angle + 1e-3) - slope(angle - 1e-3)) / 2e-3
    run, found = moved(parse(BAR)), modes(parse(BAR))
    assert run["bar_phi"] == pytest.approx(np.full(11, angle), abs=1e-9)
    expected = np.sqrt(curvature / (0.04 + 2 * 0.25**2)) / (2 * np.pi)
    assert found.frequencies == pytest.approx([expected], rel=1e-5)


LEFT, RIGHT = list(range(9)), list(range(108, 117))
CANTILEVER = f"""
name = "space_cantilever"
[scene]
gravity = [0, 0, 0]
start = "equilibrium"
[ground.markers]
wall = {{ at = [0, 0, 0], rotation = [1, 0, 0, 0] }}
[bodies.rod]
nodes = "{ROOT / "examples" / "spatial_rod.npz"}"
units = "SI"
modes = 6
start = {{ guess = true, position = [0.15, 0, 0] }}
[bodies.rod.markers]
left = {{ nodes = {LEFT} }}
right = {{ nodes = {RIGHT} }}
[joints.clamp]
kind = "fixed"
between = ["ground.wall", "rod.left"]
[forces.tip]
at = "rod.right"
force = [0, 0.02, -0.03]
[outputs.tip]
kind = "position"
marker = "rod.right"
[simulation]
duration = 0.01
output = 0.01
"""


def cantilever_tip() -> np.ndarray:
    """The displacement of the tip by linear statics of the modes in the file, with mean sections: (3,), m."""
    data = np.load(ROOT / "examples" / "spatial_rod.npz")
    x, phi, stiffness = data["positions"], data["modes"], data["modal_stiffness"]
    fields = np.concatenate([np.eye(3)[:, None] + 0 * x, np.cross(np.eye(3)[:, None], x), phi])  # (12, nodes, 3)

    def mean(nodes: list[int]) -> np.ndarray:
        """The mean displacements and rotations (6, 12) of a section by each field."""
        arms, own = x[nodes] - x[nodes].mean(axis=0), fields[:, nodes]
        tensor = np.sum(arms**2) * np.eye(3) - arms.T @ arms
        turns = np.linalg.solve(tensor, np.cross(arms, own).sum(axis=1).T)
        return np.vstack([own.mean(axis=1).T, turns])

    K, G, tip = np.diag([*np.zeros(6), *stiffness]), mean(LEFT), mean(RIGHT)[:3]
    kkt = np.block([[K, G.T], [G, np.zeros((6, 6))]])
    loads = np.concatenate([tip.T @ [0, 0.02, -0.03], np.zeros(6)])
    return np.asarray(tip @ np.linalg.solve(kkt, loads)[:12])


@pytest.mark.long
def test_the_tip_of_a_finite_element_cantilever() -> None:
    """Linear statics of its modes; few modes of a free rod are stiffer than the clamped beam, by a third across."""
    run, expected = moved(parse(CANTILEVER)), cantilever_tip()
    # the mean of the left section is at the wall, and so the tip at rest at 0.3 m along it
    found = np.array([run["tip_1"][0] - 0.3, run["tip_2"][0], run["tip_3"][0]])
    assert found[1:] == pytest.approx(expected[1:], rel=1e-5)
    EI = 210e9 * np.array([0.004 * 0.008**3, 0.008 * 0.004**3]) / 12
    beam = np.array([0.02, -0.03]) * 0.3**3 / (3 * EI)
    assert np.all(found[1:] / beam < 1) and np.all(found[1:] / beam > 0.5)
