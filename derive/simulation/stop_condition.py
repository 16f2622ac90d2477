"""The condition `until` of a simulation as an event of the integration."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from derive.errors import Problem, SpecError
from derive.runtime.native_call import Vector
from derive.simulation.compiled_scene import ConstrainedSystem
from derive.simulation.errors import SimulationError
from derive.simulation.integration.solution import Cost, Solution
from derive.simulation.integration.stop_event import StopEvent
from derive.spec.model.simulation import Simulation
from derive.spec.parsing.condition import Row, condition
from derive.spec.parsing.parser import ExpressionError


def stop_event(
    simulation: Simulation, row: Callable[[Solution], Row], native: ConstrainedSystem, k: Vector, q: Vector, v: Vector
) -> StopEvent | None:
    """The event of the condition `until`, if there is one.

    row: the columns of a solution with a single row. native, k: the compiled model and its constants (nk,). q, v: the
    initial state (nq,), (nv,). Raises SpecError if the condition names columns that the motion does not have.
    """
    if simulation.until is None:
        return None

    def columns(t: float, y: Vector) -> Row:
        q, v = y[: native.nq], y[native.nq :]
        multipliers = native.solve(t, q, v, k)[1]
        return row(Solution(np.array([t]), q[None], v[None], multipliers[None], NONE, NONE, Cost(0, 0, 0.0)))

    try:
        until = condition(simulation.until, tuple(columns(0.0, np.concatenate([q, v]))))
    except ExpressionError as error:
        raise SpecError((Problem("simulation.until", str(error)),)) from None

    def value(t: float, y: Vector) -> float:
        try:
            return until.value(columns(t, y))
        except (ArithmeticError, ValueError) as error:
            raise SimulationError(f"until {until.text}: no value at t = {t:.9g} s: {error}") from None

    return StopEvent(until.text, value, until.crossing)


NONE = np.zeros((1, 2))
"""The drift of a row that is computed for a condition alone."""
