"""The start: constraints and rates are met from poor guesses, with the least change; what cannot be met is named."""

from __future__ import annotations

import numpy as np
import pytest
from double import Array, Double
from mechanisms import CRANK, ROD, crank_slider, four_bar, pendulum, pushed_crank

from derive.simulation.errors import InconsistentInitialState, SingularConfiguration
from derive.simulation.initial.closest_consistent_state import closest_consistent_state
from derive.simulation.initial.initial_state import InitialState


def start(model: Double, q: Array, v: Array, t: float = 0.0) -> InitialState:
    return closest_consistent_state(model, model.setup(), q, v, np.ones(model.nq, dtype=bool), t)


def test_a_poor_guess_of_a_crank_slider_closes_and_moves_as_rigid_bodies_do() -> None:
    model, q, v = crank_slider(angle=0.7)
    found = start(model, q + np.random.default_rng(3).normal(size=9) * 0.05, v)
    assert found.position_error < 1e-14
    assert found.velocity_error < 1e-12
    pin = CRANK * np.array([np.cos(0.7), np.sin(0.7)])
    tilt = -np.arcsin(pin[1] / ROD)
    assert found.q[6:] == pytest.approx([pin[0] + ROD * np.cos(tilt), 0, 0], abs=1e-13)
    assert found.v[5] == pytest.approx(-150 * CRANK * np.cos(0.7) / (ROD * np.cos(tilt)), rel=1e-12)


def test_a_consistent_guess_stays_as_it_is() -> None:
    model, q, v = pendulum()
    v = np.array([0.0, 1.0, 2.0])
    found = start(model, q, v)
    assert np.array_equal(found.q, q)
    assert found.v == pytest.approx(v, abs=1e-15)


def test_the_change_of_velocities_is_the_smallest_in_the_metric_of_the_mass() -> None:
    """It has no part along motions that the constraints allow: M dv is a combination of the rows of G."""
    model, q, _ = four_bar()
    guess = np.random.default_rng(1).normal(size=9)
    change = start(model, q, guess).v - guess
    G = np.reshape(model.constraint_jacobian(0, q, np.zeros(0)), (9, 8)).T
    momentum = model.diagonal * change
    rest = momentum - G.T @ np.linalg.lstsq(G.T, momentum, rcond=None)[0]
    assert np.abs(rest).max() < 1e-12
    assert np.abs(momentum).max() > 0.1


def test_the_change_of_positions_is_the_smallest_for_a_guess_that_is_nearly_right() -> None:
    """Correct to second order, M dq is a combination of the rows of G, however different the masses are."""
    model, q, v = four_bar()
    model.diagonal *= np.array([1, 1, 1, 100, 100, 100, 0.01, 0.01, 0.01])
    rest = []
    for size in (1e-3, 1e-4):
        guess = q + size * np.random.default_rng(1).normal(size=9)
        found = start(model, guess, v)
        G = np.reshape(model.constraint_jacobian(0, found.q, np.zeros(0)), (9, 8)).T / np.sqrt(model.diagonal)
        change = np.sqrt(model.diagonal) * (found.q - guess)
        rest.append(np.abs(change - G.T @ np.linalg.lstsq(G.T, change, rcond=None)[0]).max() / np.abs(change).max())
    assert rest[0] < 0.05
    assert rest[1] < 0.2 * rest[0]


def test_a_guess_in_line_is_shaken_out_of_the_line() -> None:
    """Along the line no step leads to where the slider is pushed to, so that Newton's method has nowhere to go."""
    model, _, v = pushed_crank(0.3, 1.0)
    _, in_line, _ = crank_slider()
    found = start(model, in_line, v)
    assert found.position_error < 1e-12
    assert found.q[6] == pytest.approx(0.3)
    assert abs(found.q[2]) > 0.5


def test_a_guess_that_closes_at_a_change_point_is_refused() -> None:
    """Bars of a parallelogram that all lie in one line can open to either side."""
    model, _, v = four_bar()
    with pytest.raises(SingularConfiguration):
        start(model, np.zeros(9), v)


def test_a_drive_that_begins_out_of_reach_is_told_with_what_is_missing() -> None:
    with pytest.raises(
        InconsistentInitialState, match=r"(?s)no positions near the initial guess.*push +-0\.\d+.*lengths can reach"
    ) as e:
        start(*pushed_crank(CRANK + ROD + 0.05, 0.0))
    assert sum(amount**2 for _, amount in e.value.unmet) ** 0.5 == pytest.approx(0.05, rel=0.5)


def test_a_drive_that_pushes_from_a_dead_centre_is_told_as_such() -> None:
    with pytest.raises(SingularConfiguration, match="dead centre"):
        start(*pushed_crank(CRANK + ROD, -1.0))


def test_two_drives_that_contradict_each_other_in_speed_alone() -> None:
    from double import Turn, steady

    model, q, v = crank_slider(extra=(Turn("second", None, "crank", steady(100.0)),))
    with pytest.raises(Exception, match="motor is implied by second"):
        start(model, q, v)
