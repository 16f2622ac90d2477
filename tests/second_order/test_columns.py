"""Columns: the second-order beam buckles at Euler's load and flutters at Beck's; the first-order beam does neither."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from rod_models import compiled_scene

import derive
from derive.simulation.initial.initial_state import initial_state
from derive.simulation.linear.linearisation import linearise
from derive.spec.model.scene import Scene

EULER = np.pi**2
BECK = 20.0509
TANGENT = {"kind": "tangent", "at": -1}


def rod(shapes: int, frame: Any, pieces: int, order: int) -> dict[str, Any]:
    """A straight beam of 1 kg, 1 m, 1 N m^2 from the origin along e1: loads are in EI/l^2."""
    return {
        "ansatz": [f"xi^{n}" for n in range(shapes + 2)],
        "frame": frame,
        "mass": 1,
        "length": 1,
        "bending_stiffness": 1,
        "pieces": pieces,
        "order": order,
        **({"terms": "truncated"} if order == 2 else {}),
        "markers": {"left": -1, "right": 1},
        "start": {"position": [0.5, 0]},
    }


def pinned(shapes: int, frame: Any, pieces: int = 1, order: int = 2) -> Scene:
    """A column on a hinge and a roller, with a dead load along it."""
    roller = {"mass": 0.1, "inertia": 1, "markers": {"pin": [0, 0]}, "start": {"position": [1, 0]}}
    return derive.scene(
        "pinned_column",
        ground={"base": [0, 0]},
        bodies={"rod": rod(shapes, frame, pieces, order), "roller": roller},
        joints={
            "hinge": {"kind": "revolute", "between": ["ground.base", "rod.left"]},
            "head": {"kind": "revolute", "between": ["rod.right", "roller.pin"]},
            "guide": {"kind": "translational", "between": ["ground.base", "roller.pin"]},
        },
        forces={"load": {"at": "rod.right", "components": ["-P", 0]}},
        parameters={"P": {"default": 0}},
    )


def clamped(shapes: int, frame: Any, order: int = 2) -> Scene:
    """A clamped column with a force along its axis at the tip, which it follows."""
    return derive.scene(
        "column_of_beck",
        ground={"base": [0, 0]},
        bodies={"rod": rod(shapes, frame, 1, order)},
        joints={"clamp": {"kind": "weld", "between": ["ground.base", "rod.left"]}},
        forces={"load": {"at": "rod.right", "components": ["-P", 0], "frame": "body"}},
        parameters={"P": {"default": 0}},
    )


def critical_load(scene: Scene, highest: float) -> float | None:
    """The least load at which a small motion about the straight column grows; None up to `highest` there is none."""
    native = compiled_scene(scene, complete=True)
    q = initial_state(scene, native, native.setup()).q

    def grows(load: float) -> bool:
        linear = linearise(native, native.setup([load]), 0.0, q, np.zeros(native.nv))
        squares = np.linalg.eigvals(linear.A[linear.count :, : linear.count])
        return bool(np.sqrt(squares.astype(complex)).real.max() > 1e-3)

    unstable = [load for load in np.linspace(0, highest, 41) if grows(load)]
    if not unstable:
        return None
    low, high = unstable[0] - highest / 40, unstable[0]
    while high - low > 1e-6 * high:
        middle = (low + high) / 2
        low, high = (low, middle) if grows(middle) else (middle, high)
    return float(high)


@pytest.mark.parametrize(
    ("shapes", "frame", "pieces", "expected"),
    [
        (1, "chord", 1, 12 / EULER),
        pytest.param(3, "chord", 1, 1.00056, marks=pytest.mark.long),
        pytest.param(4, "mean", 1, 1.00056, marks=pytest.mark.long),
        (2, "mean", 2, 1.00752),
        pytest.param(2, "mean", 3, 1.00158, marks=pytest.mark.long),
    ],
)
def test_a_pinned_column_buckles_at_the_load_of_euler(shapes: int, frame: str, pieces: int, expected: float) -> None:
    """Over pi^2 EI/l^2: from above, as Rayleigh's quotient of the shapes; a parabola alone yields 12 EI/l^2."""
    assert critical_load(pinned(shapes, frame, pieces), 20.0) == pytest.approx(expected * EULER, rel=1e-5)


@pytest.mark.long
def test_a_pinned_column_of_first_order_knows_the_load_by_its_number_of_beams_alone() -> None:
    """One beam never buckles, here up to four loads of Euler, two and three do 22 and 9 % late."""
    assert critical_load(pinned(4, "mean", order=1), 4 * EULER) is None
    for pieces, expected in ((2, 1.21888), (3, 1.09471)):
        assert critical_load(pinned(2, "mean", pieces, 1), 20.0) == pytest.approx(expected * EULER, rel=1e-5)


@pytest.mark.parametrize(
    ("shapes", "frame", "expected"),
    [
        (2, TANGENT, 80.245),
        pytest.param(3, TANGENT, 20.2567, marks=pytest.mark.long),
        pytest.param(4, "mean", 20.3961, marks=pytest.mark.long),
        pytest.param(5, TANGENT, 20.0511, marks=pytest.mark.long),
    ],
)
def test_the_column_of_beck_flutters(shapes: int, frame: Any, expected: float) -> None:
    """The load is 20.0509 EI/l^2 by an exact theory: two polynomials are too coarse, five are exact to 1e-5."""
    found = critical_load(clamped(shapes, frame), 120.0 if shapes == 2 else 40.0)
    assert found == pytest.approx(expected, rel=1e-5)
    assert shapes < 5 or found == pytest.approx(BECK, rel=2e-5)


def test_the_column_of_beck_does_not_flutter_without_foreshortening() -> None:
    assert critical_load(clamped(4, TANGENT, order=1), 120.0) is None
