"""The adaptive method in C: errors, the steps of SciPy's DOP853, rows within steps, events, breaks, failures."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from pendulums import DISTANCE, GRAVITY, INERTIA, LEVEL, MASS, REST, adaptive, driven, exact

from derive.runtime.integrators.adaptive import AdaptiveError, AdaptiveRun
from derive.simulation.integration.scipy_methods import integrate

TIMES = np.linspace(0.0, 4.0, 81)


def fall(rtol: float = 1e-9, times: NDArray[np.float64] = TIMES, **more: object) -> AdaptiveRun:
    return adaptive().run(LEVEL, REST, times, rtol=rtol, **more)  # type: ignore[arg-type]


def error(run: AdaptiveRun) -> float:
    q, v = exact(run.t)
    return float(max(np.abs(run.q - q).max(), np.abs(run.v - v).max()))


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8, 1e-10])
def test_the_error_follows_the_tolerance_also_within_steps(rtol: float) -> None:
    """200 rows in 23 to 90 steps: most of them are interpolated."""
    run = fall(rtol, np.linspace(0.0, 4.0, 201))
    assert 0.02 * rtol < error(run) < 100 * rtol
    assert run.counts["steps"] < 100


@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9, 1e-12])
def test_steps_are_those_of_scipy(rtol: float) -> None:
    """The first step, the error estimates and the factors are the same; both are projected after each step."""
    host, run = adaptive(), fall(rtol)
    other = integrate(host.native, host.native.setup(), LEVEL, REST, TIMES, tolerance=rtol)
    assert run.counts["steps"] == other.cost.steps
    assert np.abs(run.q - other.q).max() < 2e-11
    assert run.counts["accelerations"] <= other.cost.evaluations + len(TIMES)


def test_steps_that_are_repeated_are_counted() -> None:
    """The motion becomes faster by and by, and the first step is as long as it may be."""
    run = fall(1e-6)
    counts, last = run.counts, fall(1e-6, TIMES[::80]).counts  # all but the first and the last row are within steps
    assert 0 < counts["rejected"] == last["rejected"]
    assert last["accelerations"] == 12 * last["steps"] + 11 * last["rejected"] + 2 + 2
    most = 4 * last["steps"] + (1 + 11) * (len(TIMES) - 2)
    assert len(TIMES) - 2 < counts["accelerations"] - last["accelerations"] <= most


def test_the_longest_step_is_kept() -> None:
    assert 400 <= fall(1e-3, step_max=0.01).counts["steps"] <= 401


def test_rows_do_not_depend_on_how_many_there_are() -> None:
    few, many = fall(times=TIMES[::20]), fall(times=np.linspace(0.0, 4.0, 801))
    assert few.counts["steps"] == many.counts["steps"]
    assert np.abs(few.q - many.q[::200]).max() < 1e-14


def test_drift_is_that_of_a_row_before_and_after_its_projection() -> None:
    run = fall(1e-6)
    assert run.drift.max() < 2e-12
    assert 1e-10 < run.drift_before.max() < 1e-4
    off = fall(1e-6, consistent=0.0)
    assert np.array_equal(off.drift, off.drift_before) and off.drift[-1, 0] > 1e-8
    assert off.counts["corrections"] == 0
    with pytest.raises(AdaptiveError, match=r"code 3 after t = .*: the constraints could not be met") as caught:
        fall(1e-6, TIMES[::80], consistent=0.0, drift=1e-15)
    raised = caught.value
    assert raised.refused is not None and raised.t < raised.refused[1]
    native, t, (q, v) = adaptive().native, raised.refused[1], np.split(raised.trial, 2)
    violated = [native.constraints(t, q, native.setup()), native.constraint_rates(t, q, v, native.setup())]
    assert np.abs(violated).max() > 1e-15


def test_multipliers_are_the_force_of_the_pivot() -> None:
    found = fall()
    q, v = exact(found.t)
    spin = -MASS * GRAVITY * q[:, 0] / (INERTIA + MASS * DISTANCE**2)
    x = -q[:, 1] * spin - q[:, 0] * v[:, 2] ** 2
    y = q[:, 0] * spin - q[:, 1] * v[:, 2] ** 2
    assert found.lam == pytest.approx(MASS * np.column_stack([x, y + GRAVITY]), abs=1e-6)


def test_moving_pivot_is_followed() -> None:
    k, reference = driven(stroke=0.2)
    run = adaptive().run(LEVEL, [0.6, 0, 0], [0.0, 2.0], rtol=1e-11, k=k)
    assert run.q[-1] == pytest.approx(reference(2.0), abs=1e-9)


def passing(level: float) -> Callable[[float, NDArray[np.float64]], float]:
    return lambda t, y: y[1] - level


def test_an_event_ends_the_run_at_its_time() -> None:
    """The rod passes the height -0.3 m after 0.29 s, and again on its way up."""
    run = fall(event=passing(-0.3), crossing=True)
    first = run.t[-1]
    assert run.met and np.array_equal(run.t[:-1], TIMES[first > TIMES])
    assert abs(run.q[-1, 1] + 0.3) < 2e-15 and error(run) < 1e-7
    again = adaptive().run(run.q[-1], run.v[-1], [first, 4.0], event=passing(-0.3), crossing=True)
    assert again.met and again.t[-1] > first + 0.3, "a run that goes on does not meet the same event"
    rising = fall(event=passing(-0.3))
    assert rising.t[-1] == pytest.approx(again.t[-1], abs=1e-7), "without `crossing` it has to become positive"


def test_an_event_within_a_step_is_found() -> None:
    """With a coarse tolerance a step is longer than the rod is below -0.49 m."""
    run = fall(1e-3, event=lambda t, y: -0.49 - y[1])
    assert run.met and run.q[-1, 1] == pytest.approx(-0.49, abs=1e-14)
    coarse = fall(1e-3, times=np.array([0.0, run.t[-1] + 0.3]))
    assert coarse.counts["steps"] < 10


def test_an_event_that_holds_at_the_start_is_none() -> None:
    assert not fall(times=TIMES[:5], event=lambda t, y: 1.0).met
    assert not fall(times=TIMES[:5], event=passing(0.0), crossing=True).met


def test_what_an_event_raises_reaches_the_caller() -> None:
    def failing(t: float, y: NDArray[np.float64]) -> float:
        if t > 1.0:
            raise ZeroDivisionError("my own mistake")
        return -1.0

    with pytest.raises(ZeroDivisionError, match="my own mistake"):
        fall(event=failing)


def test_breaks_are_ends_of_steps() -> None:
    """Nothing is discontinuous here: the motion is the same, with more steps."""
    run = fall(breaks=[-1.0, 0.5, 0.5 + 1e-15, 2.0, 4.0, 5.0])
    assert error(run) < 1e-7 and run.counts["steps"] > fall().counts["steps"]


def test_failures() -> None:
    with pytest.raises(AdaptiveError, match=r"code 11 after t = .*: the steps are too many") as caught:
        fall(steps_max=3)
    assert 0 < caught.value.t < 4.0 and caught.value.y[:3] == pytest.approx(exact(np.array([caught.value.t]))[0][0])
    with pytest.raises(AdaptiveError, match="code 3 after t = 0: the constraints could not be met"):
        adaptive().run([1e6, 1e6, 0.3], REST, TIMES)
    with pytest.raises(AdaptiveError, match="code 2 after t = 0: a value is not finite") as caught:
        adaptive().run(LEVEL, REST, TIMES, k=[DISTANCE, MASS, INERTIA, np.nan, 0.0, 0.0])
    assert caught.value.refused == (2, 0.0)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"times": [0.0, 1.0, 1.0]}, "times that increase"),
        ({"times": []}, "times that increase"),
        ({"atol": np.zeros(6)}, "and positive tolerances"),
        ({"rtol": np.nan}, "finite numbers are needed: rtol = nan"),
        ({"atol": np.ones(5)}, r"atol: an array of shape \(6,\) is needed"),
        ({"v0": [0.0]}, r"v0: an array of shape \(3,\) is needed"),
    ],
)
def test_arguments_that_make_no_sense(given: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        adaptive().run(**{"q0": LEVEL, "v0": REST, "times": TIMES} | given)  # type: ignore[arg-type]
