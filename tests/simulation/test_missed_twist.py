"""The error of a twist that too few shapes of torsion imply, against the exact motion of a shaft."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import derive
from derive.runtime.native_call import Vector
from derive.simulation.validity.monitors import Cause
from explicit_motion import moved

TORQUE, SPEED, STIFFNESS, INERTIA = 0.001, 3.0, 0.01, 0.001
FAST = "sin(3*t)/1000"
"""A torque with three fifths of the lowest frequency of the shaft."""


def shaft(twists: int, **changes: Any) -> derive.SpatialScene:
    """A rod of the length 1 that is clamped at its left end and twisted at the other one."""
    rod = {
        "length": 1,
        "mass": 1,
        "bending_stiffness": 2,
        "rotary_inertia": INERTIA,
        "ansatz": ["1", "xi", "xi^2"],
        "torsion": {"ansatz": [f"xi^{power}" for power in range(1, twists + 1)], "stiffness": STIFFNESS},
        "frame": {"kind": "tangent", "at": -1},
        "markers": {"left": -1, "right": 1},
        **changes,
    }
    return derive.spatial_scene(
        "shaft",
        ground={"o": (0, 0, 0)},
        bodies={"rod": rod},
        joints={"h": {"kind": "fixed", "between": ["ground.o", "rod.left"]}},
        torques={"f": {"on": "rod.right", "torque": [FAST, 0, 0]}},
        outputs={"end": {"kind": "twist", "section": "rod.right"}},
    )


def exact(t: Vector) -> Vector:
    """The twist of the end: the sum of the vibrations sin((k - 1/2) pi x) that the torque starts from rest."""
    half_waves = (np.arange(1, 200) - 0.5) * np.pi
    frequency = half_waves * np.sqrt(STIFFNESS / INERTIA)
    forced = np.sin(SPEED * t[:, None]) - SPEED / frequency * np.sin(frequency * t[:, None])
    result: Vector = (2 * TORQUE / INERTIA * forced / (frequency**2 - SPEED**2)).sum(axis=1)
    return result


@pytest.mark.parametrize(("twists", "warned"), [(1, True), (2, False)])
def test_a_fast_torque_on_a_clamped_rod(twists: int, warned: bool) -> None:
    """One twist is wrong by a fifth, which the run says, and two by a sixtieth, of which it is silent."""
    run = moved(shaft(twists), duration=3, output=0.02)
    (twisted,) = (m for m in run.validity if m.cause is Cause.TWISTING_MOMENT)
    known = exact(run.motion.t)
    error = np.sqrt(np.mean((run["end"] - known) ** 2)) / np.abs(known).max()
    assert error / 2 < twisted.error < 2 * error
    assert (twisted.axis, twisted.passed) == (1, warned)
    assert any("rod about its e1" in of and "in its twist" in of for of in run.warnings) == warned


def test_a_wrong_twist_makes_the_deflection_that_it_is_coupled_with_wrong() -> None:
    """Sections with their mass beside the axis: one twist is late, and the deflection along e3 with it."""
    scene = shaft(1, centre=[0.01, 0], ansatz=["1", "xi", "xi^2", "xi^3", "xi^4"])
    run = moved(scene, duration=3, output=0.05)
    assert {(m.cause, m.axis) for m in run.validity if m.passed} == {
        (Cause.BENDING_MOMENT, 3),
        (Cause.TWISTING_MOMENT, 1),
    }
