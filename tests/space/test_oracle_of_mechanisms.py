"""The oracle of material points against minimal models of mechanisms: two derivations that share nothing."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from decimal_vectors import DIGITS, floats, precise
from minimal_models import Array
from reference_mechanisms import (
    GOVERNOR_SPEED,
    GOVERNOR_START,
    bricard,
    bricard_scene,
    flyball_governor,
    flyball_governor_scene,
    slider_crank,
    slider_crank_scene,
    turned_double_pendulum,
    turned_double_pendulum_scene,
)
from scipy.linalg import null_space
from scipy.spatial.transform import Rotation
from space_oracle import Mechanics, SpaceOracle
from written_scene import Table, rotation, tables


def all_coordinates(scene: Table) -> tuple[SpaceOracle, Array]:
    """The oracle of a scene whose bodies keep all coordinates, and these at the start."""
    names: list[str] = []
    q: list[float] = []
    for name, body in scene["bodies"].items():
        names += [f"{name}_{x}" for x in ("c1", "c2", "c3", "e0", "e1", "e2", "e3")]
        with precise():
            R = floats(rotation(body["start"].get("rotation")))
        e = Rotation.from_matrix(R).as_quat(scalar_first=True)
        centre = R @ [float(x) for x in body.get("centre", (0, 0, 0))]
        q += [*(float(x) + dx for x, dx in zip(body["start"]["position"], centre, strict=True)), *e]
    return SpaceOracle(scene, names), np.array(q)


def accelerations(seen: Mechanics) -> Array:
    """vdot, also where constraints are redundant."""
    M, h, G, gamma = (floats(x) for x in (seen.M, seen.h, seen.G, seen.gamma))
    free = null_space(G, rcond=1e-9)
    particular = np.linalg.lstsq(G, gamma, rcond=1e-9)[0]
    return particular + free @ np.linalg.solve(free.T @ M @ free, -free.T @ (h + M @ particular))


def moving(oracle: SpaceOracle, q: Array, rates: dict[int, float]) -> Array:
    """The velocities that meet the constraints and have these values, which decide them."""
    free = null_space(floats(oracle.see(0.0, q, np.zeros(oracle.columns.size)).G), rcond=1e-9)
    assert free.shape[1] == len(rates)
    return free @ np.linalg.solve(free[list(rates)], list(rates.values()))


CRANK_SPIN, FIRST_SPIN, UPPER_SPIN, LOWER_SPIN = 5, 5, 5, 11
"""The places of angular velocities about the third axes of bodies."""


def test_slider_crank() -> None:
    oracle, q = all_coordinates(tables(slider_crank_scene(6.0, angle=0.4)))
    seen = oracle.see(0.0, q, moving(oracle, q, {CRANK_SPIN: 6.0}))
    assert np.max(np.abs(floats(seen.g))) < 1e-15
    assert accelerations(seen)[CRANK_SPIN] == pytest.approx(slider_crank().acceleration(0.4, 6.0), rel=1e-11)
    energy = float(sum(seen.energy.values()))
    assert energy == pytest.approx(slider_crank().energy(0.4, 6.0), rel=1e-12)


def test_turned_double_pendulum() -> None:
    a, b, rates = 1.2, -0.8, (2.0, -3.0)
    oracle, q = all_coordinates(tables(turned_double_pendulum_scene(a, b)))
    still = oracle.see(0.0, q, np.zeros(12))
    free = null_space(floats(still.G))
    hinge = np.array([np.sin(np.pi / 4), 0, np.cos(np.pi / 4)])  # of the second bar, in the axes of the first

    def velocities(adot: float, bdot: float) -> Array:
        turn = Rotation.from_euler("y", np.pi / 4) * Rotation.from_euler("z", b)
        lower = turn.inv().apply([0, 0, adot] + bdot * hinge)
        wanted = np.array([0, 0, adot, *lower])
        return free @ np.linalg.lstsq(free[[3, 4, 5, 9, 10, 11]], wanted, rcond=None)[0]

    seen = oracle.see(0.0, q, velocities(*rates))
    second = accelerations(seen)
    expected = turned_double_pendulum().accelerations((a, b), rates)
    assert second[UPPER_SPIN] == pytest.approx(expected[0], rel=1e-12)
    assert second[LOWER_SPIN] == pytest.approx(expected[0] * np.cos(np.pi / 4) + expected[1], rel=1e-12)


def test_bricards_mechanism() -> None:
    """30 rows on 30 velocities of rank 29; the first bar turns as the coordinate says."""
    s = np.pi / 4
    oracle, q = all_coordinates(tables(bricard_scene(s)))
    still = oracle.see(0.0, q, np.zeros(30))
    assert still.G.shape == (30, 30) and np.linalg.matrix_rank(floats(still.G), 1e-9) == 29
    # thetadot is -sdot times pi/2 where theta = phi, as the path crosses the diagonal at a right angle
    expected = bricard().acceleration(s, 0.0)
    assert accelerations(still)[FIRST_SPIN] == pytest.approx(-np.pi / 2 * expected, rel=1e-9)


def test_flyball_governor() -> None:
    """Shaft, slider and two rods with balls; the springs are pushed together at a speed."""
    oracle, q = all_coordinates(tables(flyball_governor_scene()))
    shaft_spin, slider_rise, rod_spin = 5, 6 + 2, 12 + 4
    assert oracle.columns.names[7 * 2] == "right_rod_c1"
    rates = (GOVERNOR_SPEED, 0.5, -0.2)
    wanted = {shaft_spin: rates[0], slider_rise: rates[2], rod_spin: -rates[1], rod_spin + 6: rates[1]}
    seen = oracle.see(0.0, q, moving(oracle, q, wanted))
    expected = flyball_governor().accelerations(GOVERNOR_START, rates)
    found = accelerations(seen)
    assert found[[shaft_spin, slider_rise]] == pytest.approx(expected[[0, 2]], rel=1e-9)
    assert found[[rod_spin, rod_spin + 6]] == pytest.approx([-expected[1], expected[1]], rel=1e-9)


def test_the_scenes_meet_their_constraints() -> None:
    texts: list[Callable[[], str]] = [
        lambda: bricard_scene(1.0),
        lambda: slider_crank_scene(0.0, angle=2.0),
        lambda: turned_double_pendulum_scene(0.3, 2.0),
        flyball_governor_scene,
    ]
    for text in texts:
        oracle, q = all_coordinates(tables(text()))
        seen = oracle.see(0.0, q, np.zeros(oracle.columns.size))
        assert np.max(np.abs(floats(seen.g))) < 2e-15 and DIGITS > 50
