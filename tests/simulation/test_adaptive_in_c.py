"""The adaptive integrator in C against DOP853 of SciPy: motion, outputs, breaks and conditions of compiled scenes."""

from __future__ import annotations

import _thread
import signal
import threading
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from compiled import Compiled, crank_slider

import derive
from derive.simulation.integration.adaptive import adaptive
from derive.simulation.integration.integrator import Settings
from derive.simulation.integration.scipy_methods import integrate
from derive.simulation.integration.solution import Solution
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse


def run(made: Compiled, times: np.ndarray, tolerance: float) -> Solution:
    start = made.start()
    method = adaptive(made.native, NotImplemented)
    return method.integrate(made.k, start.q, start.v, times, Settings(tolerance=tolerance))


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9])
def test_the_crank_slider_moves_as_with_scipy(tolerance: float) -> None:
    """A revolution with a rod of one beam, in 200 rows."""
    made, times = crank_slider(1), np.linspace(0, 2 * np.pi / 150, 200)
    start, own = made.start(), run(crank_slider(1), times, tolerance)
    other = integrate(made.native, made.k, start.q, start.v, times, tolerance=tolerance)
    exact = integrate(made.native, made.k, start.q, start.v, times, tolerance=1e-12)
    assert own.cost.steps == other.cost.steps
    assert np.abs(own.q - other.q).max() < tolerance
    error = np.abs(own.q - exact.q).max()
    assert 0.01 * tolerance < error < 100 * tolerance
    assert np.abs(own.lam - other.lam).max() < 1e3 * tolerance * np.abs(other.lam).max()
    assert own.drift.max() < 1e-11 and own.drift_before.max() > 1e-13


BROKEN = """
name = "broken"
ground.markers = { o = [0, 0] }
[inputs.push]
unit = "N"
value = "piecewise(t < 0.3, 4, t < 0.5, -20, 2)"
[bodies.arm]
mass = 1
length = 1
bending_stiffness = 20
markers = { hub = -1, tip = 1 }
start = { position = [0.5, 0] }
[joints.hub]
kind = "revolute"
between = ["ground.o", "arm.hub"]
[forces.push]
at = "arm.tip"
components = [0, { input = "push" }]
[outputs.swing]
kind = "position"
marker = "arm.tip"
[simulation]
duration = 1.5
output = 0.05
tolerance = 1e-8
until = "arm_phi < -0.5"
"""
"""A flexible arm that is pushed by a run-time input with two breaks; it ends where it has turned back far enough."""


@cache
def broken(integrator: str) -> derive.Trajectory:
    scene = parse(BROKEN)
    assert isinstance(scene, Scene)
    return derive.simulate(scene, integrator=integrator)


def test_breaks_outputs_and_conditions_are_those_of_scipy() -> None:
    own, other = broken("adaptive"), broken("dop853")
    assert 0.6 < own.t[-1] < 1.5 and own.t[-1] == pytest.approx(other.t[-1], abs=1e-7)
    assert own.solution.outputs is not None and other.solution.outputs is None
    for name in own.columns:
        assert own[name] == pytest.approx(other[name], rel=1e-6, abs=1e-5), name
    assert own.notes[-1][:-6] == other.notes[-1][:-6] and "met at t = " in own.notes[-1]


def test_progress_is_reported_for_each_row() -> None:
    reached: list[float] = []
    scene = replace(broken("adaptive").scene, simulation=derive.Simulation(0.2, 0.05))
    derive.simulate(scene, integrator="adaptive", progress=reached.append)
    assert reached == pytest.approx([0, 0.05, 0.1, 0.15, 0.2])


def test_a_run_can_be_interrupted() -> None:
    """It would take seconds. A shell that runs the tests in the background has SIGINT ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.1, _thread.interrupt_main)
    made, times = crank_slider(1), np.linspace(0, 200, 200_001)
    made.start()
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            run(made, times, 1e-9)
    finally:
        signal.signal(signal.SIGINT, before)


def test_a_step_is_refused() -> None:
    with pytest.raises(derive.SimulationError, match="adaptive chooses its own steps"):
        derive.simulate(broken("adaptive").scene, integrator="adaptive", step=1e-3)
