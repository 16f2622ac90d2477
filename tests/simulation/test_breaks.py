"""Breaks of functions of time and conditions that end a run: every integrator stops there, and starts anew."""

from __future__ import annotations

import os
from importlib.util import find_spec

import numpy as np
import pytest

import derive
from derive.simulation.integration.time_segments import BEFORE, TimeSegment, time_segments
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse

PUSHED = """
name = "pushed"
ground.markers = { origin = [0, 0] }
[bodies.block]
mass = 2
inertia = 1
markers = { middle = [0, 0] }
[joints.guide]
kind = "translational"
between = ["ground.origin", "block.middle"]
[forces.push]
at = "block.middle"
components = ["piecewise(t < 1, 4, t < 1.7, -2, 2)", 0]
[simulation]
duration = 3
output = 0.5
"""
"""A block of 2 kg on a guide: its accelerations are 2, -1 and 1 m/s^2, so that all methods are exact between breaks."""
FIXED = {"rk4": 0.1, "generalised-alpha": 0.1}
END = 1.7 - 1.3 + np.sqrt(1.3**2 + 2 * (2.5 - 2.155))
"""s: when the block has come as far as 2.5 m, from 2.155 m at 1.3 m/s at the second break."""


def simulated(integrator: str, **more: object) -> derive.Trajectory:
    if integrator == "ida" and not find_spec("sksundae") and not os.environ.get("CI"):
        pytest.skip("no scikit-sundae")
    scene = parse(PUSHED)
    assert isinstance(scene, Scene)
    try:
        return derive.simulate(scene, integrator=integrator, step=FIXED.get(integrator), **more)  # type: ignore[call-overload, no-any-return]
    except derive.TisserandError as error:
        if "was not found. Install it" in str(error) and not os.environ.get("CI"):
            pytest.skip(str(error).splitlines()[0])
        raise


@pytest.mark.parametrize("integrator", ["adaptive", "dop853", "rk45", "ida", "rk4", "generalised-alpha", "c_ida"])
def test_a_run_is_exact_between_breaks_and_ends_where_its_condition_is_met(integrator: str) -> None:
    """Errors are of rounding; a method that steps across the break at 1.7 s errs by its tolerance, or by 1e-4 m."""
    reached: list[float] = []
    found = simulated(integrator, until="block_s > 2.5", progress=reached.append)
    np.testing.assert_allclose(found.t, [0, 0.5, 1, 1.5, END], rtol=0, atol=1e-12)
    np.testing.assert_allclose(found["block_s"], [0, 0.25, 1, 1.875, 2.5], rtol=0, atol=1e-12)
    np.testing.assert_allclose(found["block_sdot"], [0, 1, 2, 1.5, 1.3 + END - 1.7], rtol=0, atol=1e-12)
    assert found.solution.notes[-1].startswith("until block_s > 2.5: met at t = 1.9427")
    assert reached == sorted(reached) and reached[0] < 0.5 and len(reached) > 4, "progress during the run"
    if integrator in FIXED:
        assert "breaks are ends of steps" in found.solution.notes[0]


@pytest.mark.parametrize("integrator", ["adaptive", "dop853", "rk4"])
def test_a_condition_that_holds_at_the_start_is_reported(integrator: str) -> None:
    """The speed is below 1.4 m/s until 0.7 s, and again between 1.6 s and 1.8 s."""
    found = simulated(integrator, until="block_sdot < 1.4")
    assert found.solution.notes[-2:] == (
        "until block_sdot < 1.4: holds at t = 0 s already; the run goes on until the condition is met anew",
        "until block_sdot < 1.4: met anew at t = 1.6 s",
    )
    found = simulated(integrator, until="block_s > -1", duration=0.5)
    assert found.solution.notes[-1] == "until block_s > -1: not met anew up to t = 0.5 s"


def test_segments_without_breaks_have_equal_intervals() -> None:
    """Rows every 0.1 s and a last interval of 0.05 s, as `output_times` makes them."""
    assert time_segments(np.array([0, 0.1, 0.2, 0.3, 0.35])) == [
        TimeSegment(0.0, 0.3 / 3, 3),
        TimeSegment(0.3, pytest.approx(0.05, rel=1e-14), 1),
    ]
    assert time_segments(np.array([1.0])) == []


def test_segments_end_just_before_breaks_and_begin_at_them() -> None:
    """A break between rows, one at a row, which rounding has moved, and one at the end, which does not count."""
    row = 0.1 + 0.2  # the next number above 0.3
    found = time_segments(np.array([0.0, 0.1, 0.2, row, 0.4, 0.5]), [0.5, 0.3, 0.15, -1.0])
    assert [(segment.start, segment.count, segment.to_break) for segment in found] == [
        (0.0, 1, False),
        (0.1, 1, True),
        (0.15, 1, False),
        (0.2, 1, False),
        (0.3, 2, False),
    ]
    ends = [segment.start + segment.count * segment.interval for segment in found]
    for end, limit in ((ends[1], 0.15), (ends[3], 0.3)):
        assert 0 < limit - end < 2 * BEFORE * np.spacing(limit)
    assert ends[0] == 0.1 and ends[4] == pytest.approx(0.5, rel=1e-15)
