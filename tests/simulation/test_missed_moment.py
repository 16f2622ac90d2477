"""The deflection that the shapes of a beam miss follows from the moment that they miss at a few sections."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

import derive
from derive.runtime.native_call import Vector
from derive.simulation.observables.beams import beam_bodies
from derive.simulation.validity.beam_line import places
from derive.simulation.validity.missed_moment import ENDS, missed_fields
from derive.simulation.validity.monitors import Cause
from derive.simulation.validity.piece_shapes import PieceShapes, gauss_points
from derive.spec.model.scene import Scene
from explicit_motion import moved

FORCE = 0.3
"""The place xi at which a force acts."""


def pinned(ansatz: object, left: str = "revolute", **acting: dict[str, object]) -> Scene:
    """A beam between two pins, or other joints, in equilibrium with `loads` or `forces`; m = l = EI = 1."""
    beam = {"ansatz": ansatz, "frame": "chord", "mass": 1, "length": 1, "bending_stiffness": 1}
    markers = {"left": -1, "right": 1, "loaded": FORCE}
    head = {"mass": 0.01, "inertia": 1e-4, "markers": {"pin": [0, 0]}, "start": {"position": [1, 0]}}
    return derive.scene(
        "pinned",
        start="equilibrium",
        ground={"foot": [0, 0]},
        bodies={
            "rod": {**beam, "markers": markers, "loads": acting.get("loads", {}), "start": {"position": [0.5, 0]}},
            "head": head,
        },
        joints={
            "foot": {"kind": left, "between": ["ground.foot", "rod.left"]},
            "top": {"kind": "revolute", "between": ["rod.right", "head.pin"]},
            "guide": {"kind": "translational", "between": ["ground.foot", "head.pin"], "axis": [1, 0]},
        },
        forces=acting.get("forces", {}),
        simulation={"duration": 0.1, "output": 0.05},
    )


def uniform(xi: Vector) -> Vector:
    return xi**2 - 1


def growing(xi: Vector) -> Vector:
    return xi**3 - xi


def angled(xi: Vector) -> Vector:
    return np.minimum((1 + xi) / (1 + FORCE), (1 - xi) / (1 - FORCE))


def deflection(moment: Callable[[Vector], Vector]) -> Vector:
    """The deflection from the chord, at `places`, of a beam with this bending moment."""
    xi = np.linspace(-1, 1, 4001)
    bent = cumulative_trapezoid(cumulative_trapezoid(moment(xi), xi / 2, initial=0), xi / 2, initial=0)
    return from_chord(np.interp(places(), xi, bent))


def from_chord(v: Vector) -> Vector:
    return v - np.interp(places(), [-1, 1], v[[0, -1]])


@pytest.mark.parametrize("highest", [2, 3, 4])
@pytest.mark.parametrize("moment", [uniform, growing, angled])
def test_the_missed_deflection_of_a_pinned_beam_is_that_of_statics(
    highest: int, moment: Callable[[Vector], Vector]
) -> None:
    (beam,) = beam_bodies(pinned([f"xi^{n}" for n in range(highest + 1)]))
    shapes, step = PieceShapes(beam), 1e-6
    xi, weights = gauss_points()
    kept = shapes.moments(xi) * weights
    a = np.linalg.solve(kept @ shapes.moments(xi).T, kept @ moment(xi))  # of the projection onto the shapes

    def missed(at: Vector) -> Vector:
        gap: Vector = moment(at) - a @ shapes.moments(at)
        return gap

    slope = (missed(ENDS + step) - missed(ENDS - step)) / (2 * step) * 2 / shapes.length
    inside = [0.0] * (moment is not angled) or [FORCE]
    known = [(-1.0, 0), (1.0, 0), (-1.0, 1), (1.0, 1), (inside[0], 0)]
    fields = missed_fields(shapes, known)
    found = np.concatenate([missed(ENDS), slope, missed(np.array(inside))]) @ fields.values
    exact = deflection(missed)
    assert np.abs(from_chord(found) - exact).max() < 1e-3 * np.abs(exact).max() + 1e-9


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize(
    ("moment", "acting"),
    [
        (lambda xi: (1 - xi**2) / 8 + (xi - xi**3) / 8, {"loads": {"load": {"force": [0, "1 + 3*xi"]}}}),
        (
            lambda xi: (1 - FORCE**2) / 4 * angled(xi),
            {"forces": {"push": {"at": "rod.loaded", "components": [0, 1]}}},
        ),
    ],
    ids=["load", "force"],
)
def test_a_run_knows_what_sine_waves_miss_between_pins(
    moment: Callable[[Vector], Vector], acting: dict[str, dict[str, object]], count: int
) -> None:
    run = moved(pinned({"kind": "pinned", "count": count}, **acting))
    implied = next(m.error for m in run.validity if m.cause is Cause.BENDING_MOMENT)
    xi, weights = gauss_points()
    waves = [lambda at, n=n: np.sin(n * np.pi * (at + 1) / 2) for n in range(1, count + 1)]
    parts = [(moment(xi) * weights) @ wave(xi) for wave in waves]
    kept = deflection(lambda at: sum(part * wave(at) for part, wave in zip(parts, waves, strict=True)))
    exact = deflection(moment)
    error = np.abs(kept - exact).max() / np.abs(exact).max()
    assert implied == pytest.approx(error, rel=0.15)


def test_a_beam_whose_shapes_no_joint_admits_warns_that_it_cannot_bend() -> None:
    force = {"at": "rod.loaded", "components": [0, 1]}
    run = moved(pinned({"kind": "pinned", "count": 1}, "weld", forces={"push": force}))
    missed = next(m for m in run.validity if m.cause is Cause.BENDING_MOMENT)
    assert missed.value == 1 and missed.error > 0.99 and len(run.warnings) == 1
