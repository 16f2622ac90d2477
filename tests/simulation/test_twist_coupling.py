"""The error of beams of first order by the coupling of twist and bending, against second order in two pieces."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import derive
from derive.runtime.native_call import Vector
from derive.simulation.trajectory import Trajectory
from derive.simulation.validity.monitors import Cause, Monitor
from derive.simulation.validity.varying_stiffness import responses
from explicit_motion import moved

TANGENT = {"kind": "tangent", "at": -1}
ROD: dict[str, Any] = {
    "length": 1,
    "mass": 1,
    "rotary_inertia": "1/20",
    "bending_stiffness": 40,
    "lateral": {"bending_stiffness": 1},
    "torsion": {"ansatz": ["xi", "xi^2"], "stiffness": "7/10"},
    "ansatz": ["1", "xi", "xi^2", "xi^3"],
    "markers": {"left": -1, "right": 1},
}
LOADS = {"stiff": (2.0, 0.02), "weak": (0.1, 0.3)}
"""The largest forces along e2, which is stiff, and e3, N.

The first is 0.6 of the load of lateral buckling, the last bends the beam by a seventh of its length.
"""


@cache
def held(order: int, frame: str, load: str, pieces: int = 1) -> Trajectory:
    """A flat cantilever whose end is pushed once in each plane."""
    pushed = [f"{force}*sin(t)^2" for force in LOADS[load]]
    scene = derive.spatial_scene(
        "flat",
        ground={"o": (0, 0, 0)},
        bodies={"rod": ROD | {"frame": TANGENT if frame == "tangent" else frame, "order": order, "pieces": pieces}},
        joints={"h": {"kind": "fixed", "between": ["ground.o", "rod.left"]}},
        forces={"f": {"at": "rod.right", "force": [0, *pushed]}},
        outputs={"end": {"kind": "position", "marker": "rod.right", "frame": "rod.left"}},
    )
    return moved(scene, duration=3, output=0.02, tolerance=1e-6)


def coupled(run: Trajectory, axis: int) -> Monitor:
    """The monitor of lateral buckling along an axis."""
    (monitor,) = (m for m in run.validity if m.cause is Cause.LATERAL and m.axis == axis)
    return monitor


def end(run: Trajectory, axis: int) -> Vector:
    """The deflection of the end along an axis of the held section, m."""
    return run[f"end_{axis}"]


@pytest.mark.parametrize(
    ("frame", "load", "axis", "expected", "implied"),
    [
        pytest.param("tangent", "stiff", 3, 0.218, 0.206, id="near lateral buckling"),
        pytest.param("mean", "stiff", 3, 0.115, 0.095, id="near lateral buckling, where the held section turns"),
        pytest.param("tangent", "weak", 2, 0.154, 0.131, id="bent far in the weak plane"),
        pytest.param("mean", "weak", 2, 0.077, 0.053, id="bent far in the weak plane, where the held section turns"),
    ],
)
def test_the_error_by_the_coupling_with_torsion_is_known(
    frame: str, load: str, axis: int, expected: float, implied: float
) -> None:
    """Two pieces have the coupling; two twists and two shapes are few, so that less is implied, by up to a third."""
    run, exact = held(1, frame, load), held(2, "mean", load, 2)
    own, known = end(run, axis), end(exact, axis)
    assert float(np.sqrt(np.mean((own - known) ** 2)) / np.abs(known).max()) == pytest.approx(expected, rel=0.02)
    assert coupled(run, axis).error == pytest.approx(implied, rel=0.02)


def test_responses_with_a_stiffness_that_varies() -> None:
    """It rings, without any it is free, with a negative one it grows; fast against the rows it follows its load."""
    t = np.linspace(0, 1, 11)
    stiffness = np.tile(np.diag([9.0, 0.0, -4.0, 1e8]), (11, 1, 1))
    load = np.ones((11, 4))
    y = responses(t, stiffness, load)
    expected = [(1 - np.cos(3 * t)) / 9, t**2 / 2, (np.cosh(2 * t) - 1) / 4]
    assert y[:, :3] == pytest.approx(np.array(expected).T)
    assert np.abs(y[:, 3]).max() <= 2e-8
