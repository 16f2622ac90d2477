"""The condition `until` of a simulation as an event of the integration."""

from __future__ import annotations

from collections.abc import Callable, Collection

import numpy as np

from derive.errors import Problem
from derive.runtime.native_call import Vector
from derive.simulation.compiled_scene import ConstrainedSystem
from derive.simulation.errors import SimulationError
from derive.simulation.integration.solution import Cost, Solution
from derive.simulation.integration.stop_event import StopEvent
from derive.spec.model.simulation import Simulation
from derive.spec.parsing.condition import Condition, Row, condition
from derive.spec.parsing.parser import ExpressionError


def stop_condition(simulation: Simulation, columns: Collection[str]) -> tuple[Condition | None, tuple[Problem, ...]]:
    """The condition `until` of a simulation with these columns, if there is one, and what is wrong with it."""
    if simulation.until is None:
        return None, ()
    try:
        return condition(simulation.until, columns), ()
    except ExpressionError as error:
        return None, (Problem("simulation.until", str(error)),)


def stop_event(
    until: Condition | None, row: Callable[[Solution], Row], native: ConstrainedSystem, k: Vector
) -> StopEvent | None:
    """The event of a condition, if there is one.

    row: the columns of a solution with a single row. native, k: the compiled model and its constants (nk,).
    """
    if until is None:
        return None

    def value(t: float, y: Vector) -> float:
        q, v = y[: native.nq], y[native.nq :]
        multipliers = native.solve(t, q, v, k)[1]
        columns = row(Solution(np.array([t]), q[None], v[None], multipliers[None], NONE, NONE, Cost(0, 0, 0.0)))
        try:
            return until.value(columns)
        except (ArithmeticError, ValueError) as error:
            raise SimulationError(f"until {until.text}: no value at t = {t:.9g} s: {error}") from None

    return StopEvent(until.text, value, until.crossing)


NONE = np.zeros((1, 2))
"""The drift of a row that is computed for a condition alone."""
