"""A scene without joints: the free beam itself. Spin softens it, and it is lost at sqrt(720) sqrt(EI/(m l^3))."""

from __future__ import annotations

import numpy as np
import pytest
from made import of

import derive
from beams import build
from conftest import QUICK
from derive.simulation.compiled_scene import mass_matrix
from derive.simulation.integration.scipy_methods import integrate

LATE = 10.0
"""s: the knock is 3e-12 N then."""
STATE = np.random.default_rng(4)


def free_beam() -> derive.Native:
    """The beam of the scene, built as a body."""
    spec = derive.planar_beam("free", markers={"left": -1, "middle": 0, "right": 1})
    return derive.load(build(spec).files, QUICK)


def test_the_scene_is_the_free_beam() -> None:
    """In random states the mass matrix and forces are those of the model of `[beam]`, and its load for the knock."""
    made, body = of("spinning_beam"), free_beam()
    scene = made.native
    assert scene.nlambda == 0 and scene.multipliers == ()
    p = np.array([1.3, 0.7, 2.1])
    assert scene.parameters == body.parameters == ("m", "l", "EI")
    ks, kb = scene.setup(p), body.setup(p)
    for t in (0.0, 0.01, 2.0):
        q, v = STATE.uniform(-2, 2, 5), STATE.uniform(-3, 3, 5)
        mass = body.mass_pattern.dense(body.mass(q, kb))
        assert mass_matrix(scene, q, ks) == pytest.approx(mass, rel=1e-14)
        knock = np.array([0, 0.2 / (1 + (50 * t) ** 2) ** 2])
        right = body.load("middle", q, knock, kb) - body.force(t, q, v, kb)
        assert scene.force(t, q, v, ks) == pytest.approx(-right, rel=1e-13, abs=1e-13)
        expected = np.linalg.solve(mass, right)
        assert scene.accel(t, q, v, ks) == pytest.approx(expected, rel=1e-12, abs=1e-12)
        vdot, lam = scene.solve(t, q, v, ks)
        assert vdot == pytest.approx(expected, rel=1e-12, abs=1e-12) and lam.shape == (0,)
        assert scene.energy(q, v, ks) == pytest.approx(body.energy(q, v, kb), rel=1e-14)
        assert scene.momentum(q, v, ks) == pytest.approx(body.momentum(q, v, kb), rel=1e-14)


def spun(spin: float, bend: float, rate: float, duration: float) -> np.ndarray:
    """alpha1 over the time, from a small bend while the beam spins."""
    native = of("spinning_beam").native
    q, v = np.array([0, 0, 0, bend, 0]), np.array([0, 0, spin, rate, 0])
    times = LATE + np.linspace(0, duration, 101)
    return integrate(native, native.setup(), q, v, times, tolerance=1e-12).q[:, 3]


def test_below_the_critical_spin_it_oscillates() -> None:
    """The frequency at 25 rad/s is sqrt(720 - 625) rad/s."""
    frequency = np.sqrt(720 - 25**2)
    found = spun(25, 1e-5, 0.0, 2 * np.pi / frequency)
    assert found == pytest.approx(1e-5 * np.cos(np.linspace(0, 2 * np.pi, 101)), abs=1e-8)


def test_above_the_critical_spin_it_grows() -> None:
    """The motion at 29 rad/s grows like exp(sqrt(841 - 720) t), tenfold in a fifth of a second."""
    rate = np.sqrt(29**2 - 720)
    found = spun(29, 1e-7, 1e-7 * rate, 0.6)
    assert np.log(found[-1] / found[0]) == pytest.approx(0.6 * 11, rel=1e-3)


def test_the_scene_as_it_stands_oscillates_after_the_knock() -> None:
    made = of("spinning_beam")
    found = made.run(np.linspace(0, 2, 2001))
    bent = made.bent(found, "bending")
    zeros = found.t[1:][np.diff(np.sign(bent)) != 0]
    assert np.diff(zeros[1:]) == pytest.approx(np.pi / np.sqrt(720 - 25**2), abs=0.003)
    assert 5e-4 < np.abs(bent).max() < 5e-3
