"""Steady rotation in space against closed forms: the precession of a top, and of a free body."""

from __future__ import annotations

import numpy as np
import pytest
from steady_mechanisms import FAST, INCLINED, MOMENTS, angular, top
from test_space_motions import MGL
from tops import steady_precession

from derive.simulation.linear.modes import modes
from derive.spec.toml.read import parse
from explicit_motion import moved


def nutation(precession: float) -> float:
    """The frequency (rad/s) at which the inclination oscillates with the momenta of the precession.

    It follows from the curvature of (p - C n cos)^2/(2 A sin^2) + mgl cos, with the momentum p about the vertical and
    n about the axis, where p - C n cos is A sin^2 times the precession.
    """
    A, C = MOMENTS
    c, s = np.cos(INCLINED), np.sin(INCLINED)
    slope = C * FAST * s - 2 * A * precession * s * c  # that of the rate of precession, times A sin^2
    curvature = slope**2 / (A * s * s) + A * precession**2 * s * s
    return float(np.sqrt(curvature / A))


@pytest.mark.parametrize("number", [0, pytest.param(1, marks=pytest.mark.long)], ids=["slow", "fast"])
def test_regular_precession_of_a_symmetric_top(number: int) -> None:
    """The inclination is that at which the given rates are steady, and the top nutates about it as the energy says."""
    precession = float(steady_precession(*MOMENTS, MGL, INCLINED, FAST)[number])
    result = modes(parse(top(precession, INCLINED + 0.06)))
    assert result.steady is not None and result.steady.spin == pytest.approx(precession)
    assert result.steady.text.endswith("about [0, 0, 1] through [0.3, -0.2, 0] m")
    e = result.linear.q[3:7]
    assert 1 - 2 * (e[1] ** 2 + e[2] ** 2) == pytest.approx(np.cos(INCLINED), abs=1e-10)
    assert angular(result) == pytest.approx([nutation(precession)], rel=1e-7)
    assert result.zero_eigenvalues == 4 and result.modes[-1].damping_ratio == pytest.approx(0, abs=1e-9)


def test_a_simulation_stays_in_steady_precession() -> None:
    precession = float(steady_precession(*MOMENTS, MGL, INCLINED, FAST)[0])
    found = moved(parse(top(precession, INCLINED + 0.06)))
    vertical = 1 - 2 * (found["top_e1"] ** 2 + found["top_e2"] ** 2)
    assert vertical == pytest.approx(np.full(6, np.cos(INCLINED)), abs=1e-8)
    assert np.ptp(found["top_e3"]) > 0.1


def test_a_free_body_precesses_about_its_angular_momentum() -> None:
    """With |L|/A in space and (A - C)/A of its rotation along the axis in the body; in the rotating axes it nutates."""
    A, C, omega = 1.0, 1.5, np.array([0.5, -0.4, 1.7])
    result = modes(
        parse(f"""
name = "free_body"
[scene]
start = "steady"
[bodies.body]
mass = 3
inertia = [{A}, {A}, {C}, 0, 0, 0]
start = {{ position = [1, 2, 3], angular_velocity = {omega.tolist()} }}
""")
    )
    momentum = omega * [A, A, C]
    assert result.steady is not None and result.steady.rotation == pytest.approx(momentum / A)
    assert result.linear.q == pytest.approx([1, 2, 3, 1, 0, 0, 0])
    assert angular(result)[-1] == pytest.approx(np.linalg.norm(momentum) / A)
