"""Natural frequencies, damping ratios and shapes against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from linear_scenes import GRAVITY, hanging_rod, pendulums
from numpy.polynomial import Legendre
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

import derive
from derive.simulation.equilibrium import Stability
from derive.simulation.linear.modes import modes

UNIT = {"frame": "mean", "mass": 1, "length": 1, "bending_stiffness": 1}
"""Frequencies of beams of 1 kg, 1 m, 1 N m^2 are in sqrt(EI/(m l^3)) = 1 rad/s."""
CLAMPED_FREE = np.array([1.8751040687, 4.6940911330]) ** 2
FREE_FREE = np.array([4.7300407449, 7.8532046241]) ** 2
PINNED = np.array([1.0, 4.0]) * np.pi**2


def monomials(count: int) -> list[str]:
    return [f"xi^{i}" for i in range(count)]


def omega(spec, **arguments) -> np.ndarray:
    return 2 * np.pi * modes(spec, **arguments).frequencies


def test_a_free_beam() -> None:
    found = modes(derive.planar_beam("free", ansatz=monomials(8), **UNIT))
    assert [mode.eigenvalue for mode in found.modes[:3]] == [0, 0, 0] and found.zero_eigenvalues == 6
    assert 2 * np.pi * found.frequencies[3:5] == pytest.approx(FREE_FREE, rel=3e-4)
    assert not found.damping_ratios.any()
    assert abs(found.modes[3].shape[:3]).max() < 1e-12  # the mean frame does not move


def cantilever(**changes):
    rod = {**UNIT, "ansatz": monomials(8), "markers": {"root": -1, "tip": 1}, "start": {"position": [0.5, 0]}}
    wall = {"clamp": {"kind": "weld", "between": ["ground.wall", "rod.root"]}}
    return derive.scene("cantilever", ground={"wall": [0, 0]}, bodies={"rod": rod}, joints=wall, **changes)


def test_a_clamped_beam() -> None:
    assert omega(cantilever())[:2] == pytest.approx(CLAMPED_FREE, rel=1e-4)


def test_a_pinned_beam() -> None:
    rod = {**UNIT, "ansatz": monomials(8), "markers": {"left": -1, "right": 1}}
    scene = derive.scene(
        "pinned_beam",
        ground={"a": [-0.5, 0]},
        bodies={
            "rod": rod,
            "roller": {"mass": 1, "inertia": 1, "markers": {"pin": [0, 0]}, "start": {"position": [0.5, 0]}},
        },
        joints={
            "left": {"kind": "revolute", "between": ["ground.a", "rod.left"]},
            "right": {"kind": "revolute", "between": ["rod.right", "roller.pin"]},
            "guide": {"kind": "translational", "between": ["ground.a", "roller.pin"]},
        },
    )
    assert omega(scene)[:2] == pytest.approx(PINNED, rel=1e-4)


def test_a_chain_of_pendulums() -> None:
    """Its stiffness is that of the multipliers: gravity does not depend on the coordinates."""
    assert omega(pendulums("one_mass", 1)) == pytest.approx([np.sqrt(GRAVITY / 0.5)], rel=1e-9)
    expected = np.sqrt(GRAVITY / 0.5 * np.array([2 - np.sqrt(2), 2 + np.sqrt(2)]))
    found = modes(pendulums("two_masses", 2))
    assert 2 * np.pi * found.frequencies == pytest.approx(expected, rel=1e-9)
    angles = [found.native.coordinates.index(f"bar{i}_phi") for i in range(2)]
    for mode, ratio in zip(found.modes, (np.sqrt(2), -np.sqrt(2)), strict=True):
        assert mode.shape[angles[1]] / mode.shape[angles[0]] == pytest.approx(ratio, rel=1e-9)


def test_an_inverted_pendulum_grows() -> None:
    found = modes(pendulums("upright", 1, np.pi / 2))
    rate = np.sqrt(GRAVITY / 0.5)
    assert [mode.eigenvalue for mode in found.modes] == pytest.approx([-rate, rate], rel=1e-9)
    assert found.frequencies.tolist() == [0, 0] and found.damping_ratios == pytest.approx([1, -1])


def test_a_damped_pendulum() -> None:
    damper = {"kind": "rotational", "between": ["ground.hook", "bar0.top"], "stiffness": 1, "damping": 0.5}
    found = modes(pendulums("damped", 1, springs={"damper": damper | {"rest": -np.pi / 2}}))
    square, rate = (GRAVITY * 0.5 + 1) / 0.25, 0.5 / 0.25
    assert found.frequencies == pytest.approx([np.sqrt(square) / (2 * np.pi)], rel=1e-9)
    assert found.damping_ratios == pytest.approx([rate / (2 * np.sqrt(square))], rel=1e-9)


def test_a_damped_beam_of_numbers_and_parameters() -> None:
    """Each mode of the beam has its damping ratio, also where only some of its constants are numbers."""
    stiffness = {"symbol": "EI", "unit": "N m^2", "default": 2.0}
    rod = {**UNIT, "mass": 0.4, "bending_stiffness": stiffness, "damping": {"ratio": 0.02}}
    found = modes(derive.scene("damped_beam", ground={}, bodies={"rod": rod}, joints={}))
    assert found.damping_ratios[-2:] == pytest.approx([0.02, 0.02], rel=1e-9)


def heavy_rod(gravity: float, count: int = 14) -> np.ndarray:
    """omega of the rod of `hanging_rod` by the Ritz method: EI int w''^2 + int T w'^2 with T = m g (1 - x/l)."""
    nodes, weights = np.polynomial.legendre.leggauss(2 * count)
    x, weights = (nodes + 1) / 2, weights / 2
    shapes = [Legendre.basis(i, domain=[0, 1]) * Legendre([0.5, 0.5], domain=[0, 1]) for i in range(count)]
    w, slope, bend = (np.array([s.deriv(d)(x) if d else s(x) for s in shapes]) for d in (0, 1, 2))
    K = 0.5 * (bend * weights) @ bend.T + 0.1 * gravity * (slope * weights * (1 - x)) @ slope.T
    return np.sqrt(eigh(K, 0.1 * (w * weights) @ w.T, eigvals_only=True))


def test_a_hanging_flexible_pendulum() -> None:
    """Weight stiffens it by the tension that the joints between its beams carry."""
    heavy, light = heavy_rod(GRAVITY)[:2], heavy_rod(0.0)[:2]
    assert omega(hanging_rod("hanging", 2, 4))[:2] == pytest.approx(heavy, rel=5e-3)
    assert heavy[1] > 1.03 * light[1]


def test_the_default_is_the_equilibrium() -> None:
    """A pendulum that starts aside and with a speed has the frequency of the hanging position; upright it has none."""
    aside = modes(pendulums("aside", 1, -1.0, inertia=0.1))
    assert 2 * np.pi * aside.frequencies == pytest.approx([np.sqrt(GRAVITY * 0.5 / 0.35)], rel=1e-9)
    assert aside.equilibrium is not None and aside.equilibrium.stability is Stability.STABLE and aside.speed == 0
    assert modes(pendulums("aside", 1, -1.0, inertia=0.1), at=0).acceleration > 1


def test_inputs_have_their_values() -> None:
    """A torque holds a pendulum aside: 1.5 N m of the weight of 1 kg on an arm of 0.5 m."""
    changes = {
        "inputs": {"twist": {"unit": "N m", "value": 1.5}, "idle": {"unit": "N m"}},
        "torques": {
            "motor": {"at": "bar0.top", "value": {"input": "twist"}},
            "other": {"at": "bar0.top", "value": {"input": "idle"}},
        },
        "outputs": {"angle": {"kind": "rotation", "marker": "bar0.bob"}},
    }
    scene = pendulums("held", 1, -1.2, inertia=0.1, **changes)
    found, inertia = modes(scene), 0.25 + 0.1
    sine = 1.5 / (GRAVITY * 0.5)
    assert found.frequencies == pytest.approx([np.sqrt(GRAVITY * 0.5 * np.sqrt(1 - sine**2) / inertia) / (2 * np.pi)])
    np.testing.assert_allclose(found.linear.B, [[0, 0], [1 / inertia, 1 / inertia]], atol=1e-9)
    np.testing.assert_allclose(found.linear.C, [[1, 0]], atol=1e-12)
    moved = modes(scene, at=0.05)
    assert moved.linear.inputs == ("twist", "idle") and moved.speed > 0
    angle = moved.linear.q[2] + np.pi / 2
    acceleration = (1.5 - GRAVITY * 0.5 * np.sin(angle)) / inertia
    assert moved.linear.vdot[2] == pytest.approx(acceleration, rel=1e-9)


def test_a_state_of_the_motion() -> None:
    """A pendulum that swings: the coefficients are those of the angle that it has reached."""
    rate = GRAVITY * 0.5 / (0.25 + 0.1)
    swing = solve_ivp(lambda _, y: [y[1], -rate * np.sin(y[0])], (0, 0.2), [0.8, 0], rtol=1e-11, atol=1e-11)
    found = modes(pendulums("swinging", 1, 0.8 - np.pi / 2, inertia=0.1), at=0.2)
    assert 2 * np.pi * found.frequencies == pytest.approx([np.sqrt(rate * np.cos(swing.y[0, -1]))], rel=1e-7)
    assert found.speed == pytest.approx(-swing.y[1, -1], rel=1e-7) and found.linear.t == 0.2
