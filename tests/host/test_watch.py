"""What the steps of a motion are watched for in C: the same as in closely spaced rows in Python."""

from __future__ import annotations

import numpy as np
import pytest
from pendulums import LEVEL, REST, adaptive

from derive.runtime.integrators.watch import Watch

SLOPE = np.array([[0.0, 0, 2, 0, 0, 0.5]])
PAIR = np.array([[1.0, 0, 0, 0, 0, 0], [0, -1.5, 0, 0, 0, 0]])
"""Forms of z = x, y, phi and their rates."""


def test_largest_values_times_and_mean_squares() -> None:
    watch = Watch((SLOPE, PAIR))
    times = np.linspace(0, 1.3, 4001)
    run = adaptive().run(LEVEL, REST, times, rtol=1e-10, step_max=1e-3, watch=watch)
    rows = watch.of_rows(run.t, np.hstack([run.q, run.v]), 3)
    seen = run.watched
    assert seen is not None
    assert seen.largest == pytest.approx(rows.largest, rel=1e-6)
    assert seen.times == pytest.approx(rows.times, abs=1e-3)
    assert seen.mean_squares == pytest.approx(rows.mean_squares, rel=1e-5)
    for form, state, value in zip((SLOPE, PAIR), seen.states, seen.largest, strict=True):
        position_alone = np.abs(form[:, :3] @ state).max()
        assert form is SLOPE or position_alone == pytest.approx(value, rel=1e-12)


def test_a_motion_without_duration_and_a_watch_of_nothing() -> None:
    one = adaptive().run(LEVEL, REST, [0.5], watch=Watch((PAIR,))).watched
    assert one is not None
    assert one.mean_squares == one.largest**2 == np.abs(PAIR[:, :3] @ LEVEL).max() ** 2 and one.times == 0.5
    nothing = adaptive().run(LEVEL, REST, [0.0, 0.1], watch=Watch()).watched
    assert nothing is not None and nothing.largest.shape == (0,) and nothing.states.shape == (0, 3)
