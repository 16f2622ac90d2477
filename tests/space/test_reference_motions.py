"""The reference motions themselves: against integration of equations from elsewhere, and what they conserve."""

from __future__ import annotations

import numpy as np
import pytest
from minimal_models import grid
from reference_mechanisms import (
    GOVERNOR_SPEED,
    GOVERNOR_START,
    bricard,
    bricard_chain,
    flyball_governor,
    rod_rotation,
    slider,
    slider_crank,
    turned_double_pendulum,
)
from scipy.integrate import solve_ivp
from tops import EulerBody, SymmetricTop, euler_rotation, steady_precession

BODY = EulerBody((1.0, 2.0, 3.5), (0.9, -0.4, 1.7))
TOP = SymmetricTop(A=0.5, C=0.2, mgl=3.0, theta=0.7, phidot=0.3, thetadot=0.4, psidot=25.0)


def test_eulers_body() -> None:
    """Euler's equations and the kinematics of the rotation matrix, integrated."""
    J = np.array(BODY.inertia)

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        w, R = y[:3], y[3:].reshape(3, 3)
        return np.concatenate([-np.cross(w, J * w) / J, (R @ np.cross(w, np.eye(3)).T).ravel()])

    times = [0.5, 4.0, 11.0]
    y = solve_ivp(rates, (0, 11), [*BODY.omega, *np.eye(3).ravel()], "DOP853", times, rtol=1e-13, atol=1e-14).y
    for i, (t, R) in enumerate(zip(times, BODY.rotations(times), strict=True)):
        assert np.allclose(y[:3, i], [float(x) for x in BODY.angular_velocity(t)], atol=1e-11)
        assert np.allclose(y[3:, i].reshape(3, 3), R, atol=1e-11)


@pytest.mark.parametrize("thetadot", [0.4, -0.4, 0.0])
def test_a_top_that_nutates(thetadot: float) -> None:
    """Lagrange's equations of Euler's angles, integrated; the inclination stays between the roots."""
    top = SymmetricTop(TOP.A, TOP.C, TOP.mgl, TOP.theta, TOP.phidot, thetadot, TOP.psidot)
    A, C, mgl = top.A, top.C, top.mgl
    spin = top.psidot + top.phidot * np.cos(top.theta)
    momentum = A * top.phidot * np.sin(top.theta) ** 2 + C * spin * np.cos(top.theta)

    def rates(t: float, y: np.ndarray) -> list[float]:
        theta, thetadot, _, _ = y
        s, u = np.sin(theta), np.cos(theta)
        phidot = (momentum - C * spin * u) / (A * s * s)
        second = (A * phidot**2 * s * u - C * spin * phidot * s + mgl * s) / A
        return [thetadot, second, phidot, spin - phidot * u]

    times = np.array([0.1, 0.7, 2.0])
    y = solve_ivp(rates, (0, 2), [top.theta, thetadot, 0, 0], "DOP853", times, rtol=1e-13, atol=1e-14).y
    found = np.array([[float(x) for x in angles] for angles in top.angles(times)])
    assert np.allclose(found, y[[2, 0, 3]].T, atol=1e-11)
    low, high, _ = (float(x) for x in top.nutation)
    fine = np.cos(solve_ivp(rates, (0, 2), [top.theta, thetadot, 0, 0], "DOP853", max_step=2e-3, rtol=1e-12).y[0])
    assert [fine.min(), fine.max()] == pytest.approx([low, high], abs=1e-5)


def test_a_top_that_precesses_steadily() -> None:
    for rate in map(float, steady_precession(0.5, 0.2, 3.0, 0.7, 30.0)):
        top = SymmetricTop(0.5, 0.2, 3.0, 0.7, phidot=rate, psidot=30.0 - rate * np.cos(0.7))
        phi, theta, _ = top.angles([1.5])[0]
        assert [float(phi), float(theta)] == pytest.approx([1.5 * rate, 0.7], abs=1e-8)


def test_euler_angles_turn_about_axes_of_the_turning_frame() -> None:
    assert euler_rotation(0, 0.4, 0)[:, 2] == pytest.approx([0, -np.sin(0.4), np.cos(0.4)])


# ---- mechanisms in minimal coordinates


def test_the_double_pendulum_with_a_turned_hinge_keeps_its_energy() -> None:
    model = turned_double_pendulum()
    times = np.linspace(0, 2, 5)
    y = model.motion([1.2, -0.8], [0, 0], times)
    energies = [model.energy(row[:2], row[2:]) for row in y]
    assert np.ptp(energies) < 1e-10 and y[-1, 1] != pytest.approx(-0.8, abs=0.1)


def test_the_slider_crank_in_space_starts_as_it_is_known_to() -> None:
    """At 0.2 m and 0.24 m/s for 6 rad/s; the rod keeps its length, and the series converge."""
    step = 1e-6
    speed = 6 * (slider(np.array(step)) - slider(np.array(-step))) / (2 * step)
    assert [float(slider(np.array(0.0))), float(speed)] == pytest.approx([0.2, 0.24], abs=1e-9)
    R = rod_rotation(grid())
    assert np.allclose(R.swapaxes(1, 2) @ R, np.eye(3), atol=1e-14) and slider_crank().tail < 1e-12
    motion = slider_crank().motion(0.0, 6.0, np.linspace(0, 2, 9))
    assert np.ptp([slider_crank().energy(*row) for row in motion]) < 1e-11


def test_bricards_mechanism_closes_in_one_degree_of_freedom() -> None:
    """After six bars the chain is where it began, in all states; at pi/4 the bars are edges of a cube."""
    starts, rotations = bricard_chain(grid())
    assert np.allclose(starts[6], 0, atol=1e-13) and np.allclose(rotations[6], np.eye(3), atol=1e-13)
    starts, rotations = bricard_chain(np.array(np.pi / 4))
    directions = np.array([R[:, 0] for R in rotations[:6]])
    assert np.allclose(np.sort(np.abs(directions), axis=1), [[0, 0, 1]] * 6, atol=1e-14)
    assert bricard().tail < 1e-12
    motion = bricard().motion(np.pi / 4, 0.0, np.linspace(0, 2, 9))
    assert np.ptp([bricard().energy(*row) for row in motion]) < 1e-9 and np.ptp(motion[:, 0]) > 0.2


def test_the_flyball_governor_without_damping_keeps_its_energy() -> None:
    """The springs are at rest at the start; turning, the balls rise a little and the slider with them."""
    free = flyball_governor(damping=0.0)
    times = np.linspace(0, 0.2, 3)
    y = free.motion(GOVERNOR_START, [GOVERNOR_SPEED, 0, 0], times)
    energies = [free.energy(row[:3], row[3:]) for row in y]
    assert np.ptp(energies) < 1e-8 and np.ptp(y[:, 1]) > 1e-3
    damped = flyball_governor().accelerations(GOVERNOR_START, (GOVERNOR_SPEED, 0.5, -0.2))
    assert np.all(np.abs(damped[1:]) > 1e3)
