"""The quantities that C watches in the steps of a motion have the values of closely spaced rows in Python."""

from __future__ import annotations

import numpy as np
import pytest
from pendulums import LEVEL, REST, adaptive

from derive.runtime.integrators.watch import Watch, WatchedQuantity

SLOPE = WatchedQuantity(np.array([[0.0, 0, 2, 0, 0, 0.5, 0]]))
PAIR = WatchedQuantity(np.array([[1.0, 0, 0, 0, 0, 0, 0], [0, -1.5, 0, 0, 0, 0, 0]]))
LATE = WatchedQuantity(np.array([[0.0, 0, 0, 0, 0, 0, 3]]), factor=0)
"""Forms of z = x, y, phi, their rates, and the time since the begin; the last one is multiplied by SLOPE."""


def test_largest_values_times_and_mean_squares() -> None:
    watch = Watch((SLOPE, PAIR, LATE))
    times = np.linspace(0.2, 1.5, 4001)
    run = adaptive().run(LEVEL, REST, times, rtol=1e-10, step_max=1e-3, watch=watch)
    rows = watch.of_rows(run.t, np.hstack([run.q, run.v]), 3)
    seen = run.watched
    assert seen is not None
    assert seen.largest == pytest.approx(rows.largest, rel=1e-6)
    assert seen.times == pytest.approx(rows.times, abs=1e-3)
    assert seen.means[[0, 2]] == pytest.approx(rows.means[[0, 2]], rel=1e-5)
    assert seen.mean_squares == pytest.approx(rows.mean_squares, rel=1e-5)
    assert np.abs(PAIR.forms[:, :3] @ seen.states[1]).max() == pytest.approx(seen.largest[1], rel=1e-12)
    slope = 2 * run.q[:, 2] + 0.5 * run.v[:, 2]
    for number, values in ((0, slope), (2, 3 * (run.t - 0.2) * slope)):
        assert rows.largest[number] == np.abs(values).max()
        assert rows.means[number] == pytest.approx(np.trapezoid(values, run.t) / 1.3)
        assert rows.mean_squares[number] == pytest.approx(np.trapezoid(values**2, run.t) / 1.3)


def test_a_motion_without_duration_and_a_watch_of_nothing() -> None:
    one = adaptive().run(LEVEL, REST, [0.5], watch=Watch((PAIR,))).watched
    assert one is not None
    assert one.mean_squares == one.largest**2 == np.abs(PAIR.forms[:, :3] @ LEVEL).max() ** 2 and one.times == 0.5
    nothing = adaptive().run(LEVEL, REST, [0.0, 0.1], watch=Watch()).watched
    assert nothing is not None and nothing.largest.shape == (0,) and nothing.states.shape == (0, 3)
