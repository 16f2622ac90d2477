"""The example of the paper, on its compiled kernels: figures of an independent prototype, drift, step limits."""

from __future__ import annotations

import numpy as np
import pytest
from compiled import Compiled, crank_slider
from marching import march

from constraint_analysis import analyse_constraints
from derive.simulation.constraints.redundancy import check_constraints
from derive.simulation.integration.scipy_methods import integrate
from derive.simulation.integration.solution import Solution
from derive.simulation.integration.step_limit import natural_frequencies, rk4_step_limit

TABLE = {
    (1, "mean"): (0.0142043, -0.0141303, 0.206, 0.53, 2.9e3),
    (1, "point"): (0.0142163, -0.0141417, 0.206, 0.53, 1.8e4),
    (2, "mean"): (0.0159072, -0.0159888, 0.030, 0.081, 1.6e6),
    (3, "mean"): (0.0156043, -0.0157242, 0.009, 0.028, 1.0e7),
}
"""Pieces, frame: largest and least deflection of an independent prototype, rms and largest error against the
reference over its peak, condition of the matrix of M and G."""


def run(made: Compiled, times: np.ndarray, **options: float) -> Solution:
    start = made.start()
    return integrate(made.native, made.k, start.q, start.v, times, **options)


def deflections(made: Compiled, found: Solution) -> np.ndarray:
    """Of the middle of the rod from its chord, to the left, over the length."""
    result = []
    for q, v in zip(found.q, found.v, strict=True):
        left, middle, right = (
            made.native.marker(f"rod_{name}", q, v, made.k)[0] for name in ("left", "middle", "right")
        )
        (x, y), (a, b) = middle - left, (right - left) / np.linalg.norm(right - left)
        result.append((a * y - b * x) / 0.3)
    return np.array(result)


@pytest.mark.long
@pytest.mark.parametrize(
    ("pieces", "frame"), [pytest.param(*case, marks=pytest.mark.long if case == (2, "mean") else ()) for case in TABLE]
)
def test_the_deflection_of_the_rod_is_that_of_an_independent_prototype(pieces: int, frame: str) -> None:
    made = crank_slider(pieces, frame)
    largest, least, rms, worst, condition = TABLE[pieces, frame]
    found = run(made, np.linspace(0, 0.1, 1001))
    bent = deflections(made, found)
    assert (bent.max(), bent.min()) == (pytest.approx(largest, abs=1.5e-7), pytest.approx(least, abs=1.5e-7))
    (plot,) = made.scene.plots
    assert plot.reference is not None
    angle, reference = np.array(plot.reference.rows).T
    error = np.abs(bent - np.interp(150 * found.t, angle, reference)) / np.abs(reference).max()
    assert np.sqrt(np.mean(error**2)) == pytest.approx(rms, abs=6e-4)
    assert error.max() == pytest.approx(worst, abs=6e-3)
    assert found.drift.max() < 1e-12
    analysis = analyse_constraints(made.native, made.k, 0.0, found.q[0])
    assert (analysis.rank, analysis.condition) == (made.native.nlambda, pytest.approx(condition, rel=0.05))


def test_the_rod_starts_undeformed_and_moves_as_a_rigid_body() -> None:
    made = crank_slider(3)
    start = made.start()
    deformations = np.array(["alpha" in name for name in made.native.coordinates])
    assert np.all(start.q[deformations] == 0.0) and np.all(start.v[deformations] == 0.0)
    turns = [made.native.coordinates.index(f"rod_{i}_phi") for i in (1, 2, 3)]
    assert start.v[turns] == pytest.approx([-75.0] * 3, rel=1e-12)
    assert not (start.deformed or start.deforming)
    check_constraints(made.native, made.k, 0.0, start.q)


def test_multipliers_give_the_work_of_the_crank() -> None:
    """Power of the drive, from the force on the rod at the crank pin, is the rate of the energy."""
    made = crank_slider(1)
    found = run(made, np.linspace(0, 0.01, 2001), tolerance=1e-11)
    energy = np.array([made.native.energy(q, v, made.k).sum() for q, v in zip(found.q, found.v, strict=True)])
    pin = [made.native.multipliers.index(f"crank_pin_{i}") for i in (1, 2)]
    angle = 150 * found.t
    power = 150 * 0.15 * (np.cos(angle) * found.lam[:, pin[1]] - np.sin(angle) * found.lam[:, pin[0]])
    work = np.concatenate([[0.0], np.cumsum((power[1:] + power[:-1]) / 2 * np.diff(found.t))])
    assert np.ptp(energy) > 1.0
    assert energy - energy[0] == pytest.approx(work, abs=1e-5 * np.ptp(energy))


@pytest.mark.parametrize(("pieces", "highest"), [(1, 4218), pytest.param(2, 16871, marks=pytest.mark.long), (3, 37959)])
def test_the_highest_natural_frequency(pieces: int, highest: float) -> None:
    """Without loads that of an independent prototype; forces and spin change it by up to 0.4 % on the way."""
    made = crank_slider(pieces)
    start = made.start()
    free = natural_frequencies(made.native, made.k, 0.0, start.q, start.v, loaded=False)[-1]
    assert free == pytest.approx(highest, abs=0.6)
    loaded = natural_frequencies(made.native, made.k, 0.0, start.q, start.v)[-1]
    assert 0 < abs(loaded / free - 1) < 0.005


def test_runge_kutta_is_stable_below_its_limit_alone() -> None:
    """Beyond it deformations grow until large ones change the frequency: to 16 mm, which are 3 mm at most in truth."""
    made = crank_slider(1)
    start = made.start()
    limit = rk4_step_limit(made.native, made.k, 0.0, start.q, start.v)
    largest = []
    for factor in (0.95, 1.05):
        states = march(made.native, made.k, 0.0, start.q, start.v, factor * limit, 100)
        largest.append(max(float(np.abs(q[3:5]).max()) for _, q, _ in states))
    assert largest[0] < 0.003
    assert largest[1] > 0.015


def test_drift_of_a_fixed_step_grows_and_projection_keeps_it_away() -> None:
    """Drift grows with the square of the time and the fourth power of the step.

    With steps of 0.2 ms it is 1.2e-8 m after one revolution, and 3.0e-7 m after five.
    """
    made = crank_slider(1)
    start = made.start()
    drift = {}
    for step, count, projected in ((2e-4, 1047, False), (1e-4, 2094, False), (2e-4, 1047, True)):
        states = march(made.native, made.k, 0.0, start.q, start.v, step, count, projected)
        drift[step, projected] = [float(np.abs(made.native.constraints(t, q, made.k)).max()) for t, q, _ in states]
    free = drift[2e-4, False]
    revolutions = [max(free[209 * i : 209 * (i + 1)]) for i in range(5)]
    assert revolutions == pytest.approx([1.2e-8 * n**2 for n in (1, 2, 3, 4, 5)], rel=0.05)
    assert max(free) / max(drift[1e-4, False]) == pytest.approx(16, rel=0.02)
    assert max(drift[2e-4, True]) < 1e-15
