"""The generalised-alpha method: its order in q, v and lambda, its damping, constraints that hold, failures."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest
from pendulums import DISTANCE, INERTIA, LEVEL, MASS, REST, alpha, driven, exact, fixed, gap

from derive.runtime.integrators.c_integrator import IntegratorError

DURATION = 4.0


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.9])
def test_order_is_two_in_multipliers_as_well(rho: float) -> None:
    q, v = exact(np.linspace(0.0, DURATION, 21))
    lam = fixed().run(LEVEL, REST, step=DURATION / 8000, steps=8000, every=400).lam
    errors = []
    for steps in (1600, 3200):
        found = alpha().run(LEVEL, REST, step=DURATION / steps, steps=steps, every=steps // 20, rho=rho)
        pairs = ((found.q, q), (found.v, v), (found.lam, lam))
        errors.append([np.abs(one - other).max() for one, other in pairs])
        assert gap(found).max() < 1e-10
    assert np.log2(np.divide(*errors)) == pytest.approx(2.0, abs=0.1)


def test_damping_of_what_the_step_cannot_follow() -> None:
    """A swing of 10 microradians in a gravity so strong that a step takes 60 periods."""
    k = np.array([DISTANCE, MASS, INERTIA, 1e5, 0.0, 0.0])
    phi = -np.pi / 2 + 1e-5
    left = {}
    for rho in (0.0, 0.5, 1.0):
        start = [DISTANCE * np.cos(phi), DISTANCE * np.sin(phi), phi]
        found = alpha().run(start, REST, step=1.0, steps=20, rho=rho, k=k)
        left[rho] = np.abs(found.q[:, 2] + np.pi / 2) / 1e-5
    assert left[1.0][10] > 0.99
    assert 0.5**10 < left[0.5][10] < 100 * 0.5**10
    assert left[0.5][20] < 1000 * 0.5**20
    assert left[0.0][5] < 1e-3


def test_moving_pivot_is_followed() -> None:
    k, reference = driven(stroke=0.2)
    found = alpha().run(LEVEL, [0.6, 0, 0], step=1e-3, steps=2000, every=1000, k=k)
    assert found.q[-1] == pytest.approx(reference(2.0), abs=1e-4)
    later = alpha().run(found.q[1], found.v[1], step=1e-3, steps=1000, every=1000, k=k, t0=1.0)
    assert later.q[-1] == pytest.approx(reference(2.0), abs=1e-4)


def test_counts() -> None:
    counts = alpha().run(LEVEL, REST, step=1e-3, steps=1000).counts
    assert counts["steps"] == 1000
    assert 2000 <= counts["residuals"] <= 4000
    assert 0 < counts["jacobians"] < 500  # one serves several steps


def test_failures_tell_what() -> None:
    with pytest.raises(IntegratorError, match="code 8 after t = 0: Newton's method does not converge") as caught:
        alpha().run(LEVEL, [0.0, 1e6, 2e6], step=10.0, steps=3, rho=0.5)
    assert np.isnan(caught.value.partial.q[1:]).all()
    with pytest.raises(IntegratorError, match="code 1: a pivot vanished"):
        alpha().run(LEVEL, REST, step=1e-3, steps=3, k=[0.5, np.inf, 0.1, 9.81, 0, 0])
    with pytest.raises(ValueError, match="makes no sense"):
        alpha().run(LEVEL, REST, step=1e-3, steps=3, rho=1.5)
    with pytest.raises(ValueError, match="make no sense"):
        alpha().run(LEVEL, REST, step=1e-3, steps=-3)
    with pytest.raises(ValueError, match="have to be vectors"):
        alpha().run([LEVEL], [REST], step=1e-3, steps=3)


@pytest.mark.parametrize("wrong", [{"tolerance": np.nan}, {"start": np.nan}, {"start": -1.0}, {"rho": np.nan}])
def test_options_that_make_no_sense_have_their_own_code(wrong: dict[str, float]) -> None:
    """Programs that call the C function need the code; a NaN as `start` must not switch the first projection off."""
    host, q, v = alpha(), LEVEL.copy(), REST.copy()
    k, rows, counts = host.native.setup(), np.full((2, host.width), 7.0), (ctypes.c_long * 3)()

    def code(**options: float) -> int:
        given = (ctypes.c_double * 3)(*({"rho": 0.8, "tolerance": 1e-11, "start": 1e-12} | options).values())
        pointers = [array.ctypes.data for array in (k, q, v, rows)]
        return int(host.library.tisserand_alpha(host.model, given, 0.0, 1e-3, 1, 1, *pointers, None, counts))

    assert code(**wrong) == 4
    assert np.all(rows == 7.0)
    assert code() == 0
