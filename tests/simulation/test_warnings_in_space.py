"""Each monitor of a beam in space warns of a load that its model does not bear, and of no small load of that kind."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

import derive
from derive.simulation.validity.measure import validity
from derive.simulation.validity.monitors import Cause
from explicit_motion import moved

ROD: dict[str, Any] = {
    "length": 1,
    "mass": 1,
    "rotary_inertia": "1/1000",
    "bending_stiffness": 60,
    "lateral": {"bending_stiffness": 1},
    "ansatz": ["1", "xi", "xi^2", "xi^3", "xi^4"],
    "frame": "mean",
    "markers": {"left": -1, "right": 1},
}


def cantilever(**changes: Any) -> derive.SpatialScene:
    """A flat beam that is clamped at its left end, with a force at the other one that has inputs as components."""
    return derive.spatial_scene(
        "flat",
        ground={"o": (0, 0, 0)},
        bodies={"rod": ROD | changes},
        joints={"h": {"kind": "fixed", "between": ["ground.o", "rod.left"]}},
        inputs={axis: {"value": 0, "unit": "N"} for axis in "xyz"},
        forces={"f": {"at": "rod.right", "force": [{"input": axis} for axis in "xyz"]}},
    )


def causes(scene: derive.SpatialScene, load: tuple[float, float, float]) -> set[Cause]:
    """The causes that a run warns of under a load that grows for three seconds."""
    inputs = {axis: (lambda t, of=of: of * t / 3) for axis, of in zip("xyz", load, strict=True)}
    run = moved(scene, duration=3, output=0.05, tolerance=1e-5, inputs=inputs)
    return {monitor.cause for monitor in run.validity if monitor.passed}


TWIST = {"torsion": {"ansatz": ["xi"], "stiffness": 1}, "ansatz": ["1", "xi", "xi^2", "xi^3"]}


@pytest.mark.parametrize(
    ("load", "expected"),
    [
        ((0.0, 0.6, 0.03), set()),
        ((-0.1, 0.0, 0.03), set()),
        ((6.0, 0.0, 0.03), {Cause.AXIAL_FORCE}),
        ((0.0, 0.0, 3.0), {Cause.DEFLECTION}),
        ((0.0, 6.0, 0.03), {Cause.LATERAL}),
    ],
)
def test_first_order_warns_of_the_load_that_it_does_not_bear(
    load: tuple[float, float, float], expected: set[Cause]
) -> None:
    """Tension by 2.4 of the buckling load, a far deflection, and 1.5 of the load of lateral buckling."""
    found = causes(cantilever(**TWIST), load)
    assert expected <= found
    assert bool(found) == bool(expected)


def test_shapes_that_know_no_clamp_warn_in_both_planes() -> None:
    """A half sine wave has no moment at a clamped end, which polynomials have."""
    sines = cantilever(ansatz={"kind": "pinned", "count": 1}, frame="chord", order=2)
    run = moved(sines, duration=0.5, output=0.05, inputs={a: lambda t: 0.01 * t for a in "xyz"})
    assert {m.axis for m in run.validity if m.cause is Cause.BENDING_MOMENT and m.passed} == {2, 3}


def test_inertia_that_is_lost_warns_where_nothing_is_left() -> None:
    """Truncated terms leave a beam that bends by its length no inertia, and nearly all where it bends little."""
    slender = {k: v for k, v in ROD.items() if k != "lateral"} | {"order": 2, "start": {"amplitudes": [0.05]}}
    scene = derive.spatial_scene("free", bodies={"rod": slender})
    motion = moved(scene, duration=0.002, output=0.001).motion
    for factor, passed in ((1, False), (20, True)):
        bent = motion.q.copy()
        bent[:, 7:] *= factor
        found = [m for m in validity(replace(motion, q=bent)) if m.cause is Cause.MASS_MATRIX and m.axis == 2]
        assert [m.passed for m in found] == [passed]


def test_vibrations_that_a_joint_couples_are_late_in_both_planes() -> None:
    """A hinge that is oblique to the planes of a beam couples them: it is late along e3, where it has enough shapes."""
    turn = {"axis": [1, 0, 0], "angle": "0.4"}
    one_shape = {"ansatz": ["1", "xi", "xi^2"], "lateral": {"bending_stiffness": 60, "ansatz": ROD["ansatz"]}}
    oblique = derive.spatial_scene(
        "oblique",
        ground={"o": {"at": [0, 0, 0], "rotation": turn}},
        bodies={"rod": ROD | one_shape | {"markers": {"left": {"at": -1, "rotation": turn}, "right": 1}}},
        joints={"h": {"kind": "revolute", "between": ["ground.o", "rod.left"]}},
        forces={"f": {"at": "rod.right", "force": [0, "sin(20*t)", 0]}},
    )
    run = moved(oblique, duration=0.5, output=0.02)
    (along,) = (m.error for m in run.validity if m.cause is Cause.BENDING_MOMENT and m.axis == 3)
    assert 0.05 < along < 1
