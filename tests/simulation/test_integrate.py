"""Integration: order, energy, drift with and without projection, and why it stops."""

from __future__ import annotations

import numpy as np
import pytest
from double import Array, Double
from marching import march
from mechanisms import CRANK, ROD, crank_slider, four_bar, pendulum, pushed_crank

from derive.simulation.errors import DriftTooLarge, DriveCannotBeFollowed, IntegrationStopped, SimulationError
from derive.simulation.initial.closest_consistent_state import closest_consistent_state
from derive.simulation.integration.c_methods import equal_steps
from derive.simulation.integration.failure_diagnosis import diagnose_failure
from derive.simulation.integration.scipy_methods import integrate
from derive.simulation.integration.solution import Solution
from derive.simulation.integration.step_limit import natural_frequencies, rk4_step_limit

NONE = np.zeros(0)


def run(mechanism: tuple[Double, Array, Array], times: Array, **options: object) -> Solution:
    model, q, v = mechanism
    found = closest_consistent_state(model, NONE, q, v, np.ones(model.nq, dtype=bool))
    return integrate(model, NONE, found.q, found.v, times, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("projected", [True, False])
def test_the_fixed_step_has_order_four_projected_or_not(projected: bool) -> None:
    model, q, v = pendulum()
    ends = []
    for count in (40, 80, 160):
        *_, (_, q_end, v_end) = march(model, NONE, 0.0, q, v, 1.0 / count, count, projected)
        ends.append(np.concatenate([q_end, v_end]))
    order = np.log2(np.linalg.norm(ends[0] - ends[1]) / np.linalg.norm(ends[1] - ends[2]))
    assert 3.9 < order < 4.1, order


def test_a_pendulum_keeps_its_energy_and_is_where_the_formula_says() -> None:
    model, _, _ = pendulum()
    found = run(pendulum(), np.linspace(0, 5, 51), tolerance=1e-10)
    energy = [model.energy(q, v, NONE).sum() for q, v in zip(found.q, found.v, strict=True)]
    assert np.ptp(energy) < 1e-8
    assert np.ptp(found.q[:, 2]) > 3.0
    tension = found.lam[0]  # force of the pin on a horizontal rod at rest: a quarter of its weight, upward
    assert tension == pytest.approx([0.0, 2.0 * 9.81 / 4], abs=1e-12)


def test_tolerance_is_what_rows_follow() -> None:
    times = np.linspace(0, 2, 21)
    exact = run(pendulum(), times, tolerance=1e-12).q
    errors = [np.abs(run(pendulum(), times, tolerance=e).q - exact).max() for e in (1e-4, 1e-7, 1e-10)]
    assert errors[0] < 1e-2
    assert errors[1] < errors[0] / 30
    assert errors[2] < errors[1] / 30


def test_the_crank_slider_follows_its_drive() -> None:
    found = run(crank_slider(), np.linspace(0, 0.1, 101))
    angle = 150 * found.t
    slider = CRANK * np.cos(angle) + np.sqrt(ROD**2 - (CRANK * np.sin(angle)) ** 2)
    assert np.abs(found.q[:, 2] - angle).max() < 1e-13
    assert np.abs(found.q[:, 6] - slider).max() < 1e-13


def test_rows_are_on_the_constraints_and_steps_have_drifted() -> None:
    found = run(four_bar(), np.linspace(0, 3, 31), tolerance=1e-8)
    assert found.drift.max() < 1e-13
    assert found.drift_before.max() > 1e-10
    assert found.cost.steps > 10
    assert found.cost.evaluations > 12 * found.cost.steps


def test_drift_grows_without_projection_and_is_refused_beyond_the_tolerance() -> None:
    times = np.linspace(0, 20, 41)
    free = run(pendulum(), times, tolerance=1e-7, projected=False, drift=np.inf)
    assert free.drift[-1, 0] > 10 * free.drift[2, 0] > 0
    held = run(pendulum(), times, tolerance=1e-7)
    assert held.drift.max() < 1e-13
    assert held.drift_before[-1, 0] < 0.1 * free.drift[-1, 0]  # that of a step, not of all of them
    with pytest.raises(DriftTooLarge, match=r"constraint pin_. is off by .* more than the tolerance of drift 1e-09"):
        run(pendulum(), times, tolerance=1e-7, projected=False)


@pytest.mark.long
@pytest.mark.parametrize("speed", [1.0, -1.0])
def test_a_slider_that_is_pushed_through_a_dead_centre_cannot_follow(speed: float) -> None:
    """Outer dead centre at 0.45 m, inner one at 0.15 m, both 0.15 s away."""
    with pytest.raises(DriveCannotBeFollowed, match="prescribe in push cannot be followed") as error:
        run(pushed_crank(0.3, speed), np.linspace(0, 1, 101))
    assert error.value.t == pytest.approx(0.15, abs=1e-6)
    assert error.value.smallest < 1e-3
    assert error.value.drives == ("push",)
    assert error.value.locked and "cannot turn through: behind this state its joints do not close" in str(error.value)


def test_rows_do_not_depend_on_how_many_there_are() -> None:
    coarse = run(four_bar(), np.linspace(0, 1, 3))
    fine = run(four_bar(), np.linspace(0, 1, 201))
    assert np.abs(coarse.q - fine.q[::100]).max() < 1e-9
    assert fine.cost.steps == coarse.cost.steps


def test_the_natural_frequency_of_a_hanging_rod_and_the_step_that_it_allows() -> None:
    """sqrt(3 g / 2 l), from below and above the limit of the classical Runge-Kutta method."""
    model, _, _ = pendulum()
    q, v = np.array([0.0, -0.5, -np.pi / 2]), np.zeros(3)
    assert natural_frequencies(model, NONE, 0.0, q, v) == pytest.approx([np.sqrt(1.5 * 9.81)], rel=1e-8)
    limit = rk4_step_limit(model, NONE, 0.0, q, v)
    ends = []
    for factor in (0.95, 1.05):
        nudged = np.array([0.5 * np.sin(1e-4), -0.5 * np.cos(1e-4), -np.pi / 2 + 1e-4])
        states = list(march(model, NONE, 0.0, nudged, v, factor * limit, 40))
        ends.append(max(abs(q[2] + np.pi / 2) for _, q, _ in states[-10:]))
    assert ends[0] < 2e-5
    assert ends[1] > 1e-3


def test_a_state_beyond_the_range_of_doubles_has_a_message() -> None:
    """M is not finite there, so that no singular value tells a dead centre."""
    model, q, v = pendulum()
    model.diagonal[:] = np.inf
    error = diagnose_failure(model, NONE, 0.5, np.concatenate([q, v]), None, "no step is accepted")
    assert isinstance(error, IntegrationStopped) and "at t = 0.5 s: no step is accepted" in str(error)


@pytest.mark.parametrize(("step", "count"), [(1e-9, 10**8), (1e-11, None), (1e-300, None)])
def test_fixed_steps_are_not_too_many(step: float, count: int | None) -> None:
    if count is not None:
        assert equal_steps(0.1, step) == count
        return
    with pytest.raises(SimulationError, match=r"steps between two rows, and at most 1e\+09 are taken; give a longer"):
        equal_steps(0.1, step)
