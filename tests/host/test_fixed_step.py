"""Runge-Kutta with fixed steps: its order, what projection is for, its counts, and what it returns when it fails."""

from __future__ import annotations

import numpy as np
import pytest
from pendulums import DISTANCE, GRAVITY, LEVEL, MASS, REST, driven, energy, exact, fixed, gap

from derive.runtime.integrators.c_integrator import Integration, IntegratorError

DURATION = 4.0
OFF = np.array([0.05, 0.02, 0.0])


def fall(steps: int, project: bool = True) -> Integration:
    return fixed().run(LEVEL, REST, step=DURATION / steps, steps=steps, every=steps // 20, project=project)


@pytest.mark.parametrize("project", [True, False])
def test_order_is_four(project: bool) -> None:
    q, v = exact(np.linspace(0.0, DURATION, 21))
    runs = [fall(steps, project) for steps in (200, 400, 800)]
    errors = np.array([max(np.abs(r.q - q).max(), np.abs(r.v - v).max()) for r in runs])
    assert errors[-1] < 1e-7
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx(4.0, abs=0.25)


def test_multipliers_are_the_force_of_the_pivot() -> None:
    found = fall(800)
    q, v = exact(found.t)
    spin = -MASS * GRAVITY * q[:, 0] / (0.125 + MASS * DISTANCE**2)  # rate of the angular velocity
    x = -q[:, 1] * spin - q[:, 0] * v[:, 2] ** 2
    y = q[:, 0] * spin - q[:, 1] * v[:, 2] ** 2
    assert found.lam == pytest.approx(MASS * np.column_stack([x, y + GRAVITY]), abs=1e-5)


def test_moving_pivot_is_followed() -> None:
    """g depends on the time: stages have their own."""
    k, reference = driven(stroke=0.2)
    found = fixed().run(LEVEL, [0.6, 0, 0], step=1e-3, steps=2000, every=2000, k=k)
    assert found.q[-1] == pytest.approx(reference(2.0), abs=1e-9)


def test_drift_grows_without_projection_and_stays_away_with_it() -> None:
    kept, left = (
        fixed().run(LEVEL, REST, step=5e-3, steps=20_000, every=1000, project=project) for project in (True, False)
    )
    assert gap(kept).max() < 2e-12
    assert gap(left)[-1] > 1e-5
    assert np.abs(np.diff(energy(kept))).max() < 1e-4 * MASS * GRAVITY * DISTANCE


def test_a_start_off_the_constraints_is_projected() -> None:
    found = fixed().run(LEVEL + OFF, [1.0, 2.0, 3.0], step=1e-3, steps=0)
    assert gap(found).max() < 1e-12
    assert np.dot(found.q[0, :2], found.v[0, :2]) == pytest.approx(0.0, abs=1e-12)
    moved = found.q[0] - LEVEL - OFF
    assert np.linalg.norm(moved) < 0.06  # to the next state, not to any


def test_counts() -> None:
    """4 accelerations a step and one for each row; g and gdot once a step, and twice g where q is corrected."""
    found = fall(200)
    counts = found.counts
    assert counts["steps"] == 200
    assert counts["accelerations"] == 4 * 200 + 21
    assert counts["corrections"] == 2 * 200
    assert counts["constraints"] == 2 + 3 * 200
    assert fall(200, project=False).counts == {
        "steps": 200, "accelerations": 821, "constraints": 0, "corrections": 0
    }  # fmt: skip
    assert 0 < found.seconds < 1


def test_batch_is_each_state_alone() -> None:
    starts = np.array([[DISTANCE * np.cos(a), DISTANCE * np.sin(a), a] for a in (0.0, -0.7, 2.0)])
    together = fixed().run(starts, np.zeros((3, 3)), step=1e-2, steps=50, every=7)
    for b, start in enumerate(starts):
        alone = fixed().run(start, REST, step=1e-2, steps=50, every=7)
        assert np.array_equal(together.q[b], alone.q)
        assert np.array_equal(together.v[b], alone.v)
        assert np.array_equal(together.lam[b], alone.lam)
    assert together.q.shape == (3, 8, 3)
    assert together.t == pytest.approx(0.07 * np.arange(8))


def test_failure_tells_what_and_leaves_nan() -> None:
    with pytest.raises(IntegratorError, match=r"pendulum: code 3: the constraints could not be met") as caught:
        fixed().run([1e6, 1e6, 0.3], REST, step=1e-3, steps=10)
    assert caught.value.code == 3
    assert np.isnan(caught.value.partial.q).all()
    starts = np.array([LEVEL, [np.nan, 0.0, 0.0]])
    with pytest.raises(IntegratorError) as caught:
        fixed().run(starts, np.zeros((2, 3)), step=1e-3, steps=10)
    good, bad = caught.value.partial.q
    assert np.isfinite(good).all()
    assert np.isnan(bad).all()


def test_failure_on_the_way_keeps_what_was_reached() -> None:
    """The pivot becomes too fast for a double, some time after the start."""
    k = [0.0, MASS, 0.125, GRAVITY, 1e308, 1.0]
    with pytest.raises(IntegratorError, match=r"code 2 after t = 1") as caught:
        fixed().run(LEVEL, [1e308, 0, 0], step=1e-2, steps=1000, k=k, project=False)
    finite = np.isfinite(caught.value.partial.q).all(axis=1)
    assert 100 < np.sum(finite) < 900
    assert np.array_equal(finite, np.sort(finite)[::-1])


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"q0": [0.0, 0.0]}, r"q0: an array of shape \(3,\) is needed, not \(2,\)"),
        ({"v0": [[0.0, 0.0, 0.0]]}, r"v0: an array of shape \(3,\) is needed, not \(1, 3\)"),
        ({"k": [1.0]}, r"k: an array of shape \(6,\) is needed, not \(1,\)"),
        ({"steps": -1}, "make no sense"),
        ({"every": 0}, "make no sense"),
    ],
)
def test_wrong_arguments(given: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        fixed().run(**{"q0": LEVEL, "v0": REST, "step": 1e-3, "steps": 1, **given})  # type: ignore[arg-type]
