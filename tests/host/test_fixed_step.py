"""Runge-Kutta with fixed steps: its order, what projection is for, its counts, and what it returns when it fails."""

from __future__ import annotations

import ctypes
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from pendulums import DISTANCE, GRAVITY, LEVEL, MASS, REST, driven, energy, exact, fixed, gap

import derive
from derive.generated_models import generated
from derive.runtime.integrators.c_integrator import Integration, IntegratorError
from derive.runtime.integrators.fixed_step import FixedStep

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
        ({"step": np.nan}, "finite numbers are needed: step = nan"),
        ({"t0": np.inf, "tolerance": np.nan}, "finite numbers are needed: t0 = inf, tolerance = nan"),
    ],
)
def test_wrong_arguments(given: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        fixed().run(**{"q0": LEVEL, "v0": REST, "step": 1e-3, "steps": 1, **given})  # type: ignore[arg-type]


# The C functions themselves, which programs call without Python's checks

K = np.array([DISTANCE, MASS, 0.125, GRAVITY, 0.0, 3.0])


def run_c(t0: float = 0.0, step: float = 1e-3, tolerance: float = 1e-12) -> tuple[int, NDArray[np.float64]]:
    """The code of tisserand_rk4_batch, of two steps from LEVEL, and its rows, which are 7.0 where it writes none."""
    host, q, v = fixed(), LEVEL[None].copy(), np.zeros((1, 3))
    rows, work, counts = np.full((3, host.width), 7.0), np.empty(100), (ctypes.c_long * 4)()
    codes = np.zeros(1, dtype=np.intc)
    arrays = [array.ctypes.data for array in (K, q, v, rows, codes, work)]
    k, *others = arrays
    code = host.library.tisserand_rk4_batch(host.model, 1, t0, step, 2, 1, k, tolerance, *others, counts)
    return code, rows


def test_numbers_that_make_no_sense_have_their_own_code() -> None:
    """A NaN as tolerance must not switch the projection off, nor pass for a vanished pivot as a step."""
    assert run_c()[0] == 0 and np.isfinite(run_c()[1]).all() and run_c(tolerance=0.0)[0] == 0
    wrong = [{"tolerance": np.nan}, {"tolerance": -1.0}, {"step": np.nan}, {"step": np.inf}, {"t0": np.nan}]
    for given in wrong:
        code, rows = run_c(**given)
        assert code == 4
        assert np.all(rows == 7.0)


def project(
    k: NDArray[np.float64], v: NDArray[np.float64], tolerance: float = 1e-12
) -> tuple[int, NDArray[np.float64]]:
    """The code of tisserand_project at LEVEL, and v after it; the work array holds numbers already."""
    host, q, changed, counts = fixed(), LEVEL.copy(), v.copy(), (ctypes.c_long * 4)()
    work = np.arange(1.0, 101.0)
    arrays = [array.ctypes.data for array in (q, changed, work)]
    function = host.library.tisserand_project
    function.argtypes = [ctypes.c_void_p, ctypes.c_double, *[ctypes.c_void_p], ctypes.c_double, *[ctypes.c_void_p] * 4]
    return function(host.model, 0.0, k.ctypes.data, tolerance, *arrays, counts), changed


def test_a_correction_that_was_not_computed_is_not_added() -> None:
    """The rates are off and the moment of inertia is a NaN, so that project_velocity fails before it writes."""
    v = np.array([0.3, 0.0, 0.0])
    code, changed = project(K, v)
    assert code == 0 and not np.array_equal(changed, v)
    broken = K.copy()
    broken[2] = np.nan
    code, changed = project(broken, v)
    assert code == 1
    assert np.array_equal(changed, v)
    assert project(K, v, np.nan)[0] == 4


def test_rows_before_a_failure_are_kept_and_none_after_it() -> None:
    """This holds for any number of steps between two rows: a failure between them keeps the row before it."""
    k = [0.0, MASS, 0.125, GRAVITY, 1e308, 1.0]

    def reached(every: int) -> int:
        with pytest.raises(IntegratorError) as caught:
            fixed().run(LEVEL, [1e308, 0, 0], step=1e-2, steps=1000, every=every, k=k, project=False)
        finite = np.isfinite(caught.value.partial.q).all(axis=1)
        assert np.array_equal(finite, np.sort(finite)[::-1])
        return int(np.sum(finite))

    good = reached(1)
    for every in (2, 3, 7, good - 1, good):
        assert reached(every) == (good - 1) // every + 1


# A body in space, whose quaternion has to be of unit length

SPIN = 3.0


@cache
def falling_body() -> FixedStep:
    spec = derive.symbolic_body("falling", 1, frame="given", gravity=[0, 0, -9.81], lowering="flat")
    return FixedStep(generated(spec)[1], ["-O0"])


def fall_from(e: NDArray[np.float64], steps: int = 2000) -> Integration:
    """The body spins about the vertical and falls, for 1 ms each step; e: its quaternion at the start."""
    q, v = np.zeros(8), np.zeros(7)
    q[3:7], v[5] = e, SPIN
    return falling_body().run(q, v, step=1e-3, steps=steps, every=100)


@pytest.mark.parametrize("length", [1.0, 0.5, 3e3])
def test_a_quaternion_is_normalised(length: float) -> None:
    """A quaternion is normalised at the start and after every step; the body rotates about the vertical."""
    found = fall_from(np.array([length, 0.0, 0.0, 0.0]))
    half = SPIN * found.t / 2
    assert found.q[:, 3] == pytest.approx(np.cos(half), abs=1e-12)
    assert found.q[:, 6] == pytest.approx(np.sin(half), abs=1e-12)
    assert found.q[:, 2] == pytest.approx(-9.81 * found.t**2 / 2, abs=1e-11)
    assert np.abs(np.linalg.norm(found.q[:, 3:7], axis=1) - 1).max() < 3e-16


@pytest.mark.parametrize("e", [np.zeros(4), np.array([1.0, np.nan, 0.0, 0.0]), np.array([np.inf, 0.0, 0.0, 0.0])])
def test_a_quaternion_without_direction_is_refused(e: NDArray[np.float64]) -> None:
    with pytest.raises(IntegratorError, match="falling: code 2: a value is not finite or not positive") as caught:
        fall_from(e)
    assert np.isnan(caught.value.partial.q).all()
