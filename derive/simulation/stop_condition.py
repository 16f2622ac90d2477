"""The condition `until` of a simulation as an event of the integration."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from types import MappingProxyType

import numpy as np

from derive.errors import Problem
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import ConstrainedSystem
from derive.simulation.errors import SimulationError
from derive.simulation.integration.solution import Cost, Solution
from derive.simulation.integration.stop_event import StopEvent
from derive.simulation.observables.motion import drive_values
from derive.spec.model.joints import Drive
from derive.spec.model.simulation import Simulation
from derive.spec.model.specification import AnyScene
from derive.spec.parsing.condition import Condition, Row, condition
from derive.spec.parsing.parser import ExpressionError


def stop_condition(simulation: Simulation, columns: Collection[str]) -> tuple[Condition | None, tuple[Problem, ...]]:
    """The condition `until` of a simulation with these columns, if there is one, and the problems with it."""
    if simulation.until is None:
        return None, ()
    try:
        return condition(simulation.until, columns), ()
    except ExpressionError as error:
        return None, (Problem("simulation.until", str(error)),)


StateColumn = Callable[[float, Vector], float]
"""A column as a function of the time (s) and the state y = [q; v] alone."""


def state_columns(scene: AnyScene, native: NativeScene, names: Sequence[str]) -> dict[str, StateColumn]:
    """The columns of a scene that need neither multipliers nor outputs, with the numbers of `column_values`.

    names: those of all columns, in their order.
    """
    result: dict[str, StateColumn] = {"t": lambda t, y: t}
    for drive in scene.drives:
        if drive.motion is None or drive.motion.kind != "input":
            result[drive.name] = _drive_column(drive)
    first = 1 + len(scene.drives)
    for number, name in enumerate(names[first : first + native.nq + native.nv]):
        result[name] = _state_column(number)
    return result


def _drive_column(drive: Drive) -> StateColumn:
    return lambda t, y: float(drive_values(drive, np.array([t]))[0])


def _state_column(number: int) -> StateColumn:
    return lambda t, y: float(y[number])


def stop_event(
    until: Condition | None,
    row: Callable[[Solution], Row],
    native: ConstrainedSystem,
    k: Vector,
    of_state: Mapping[str, StateColumn] = MappingProxyType({}),
) -> StopEvent | None:
    """The event of a condition, if there is one.

    row: the columns of a solution with a single row. native, k: the compiled model and its constants (nk,). of_state:
    columns that are computed from a state alone, which is faster; they are used if the condition has no others.
    """
    if until is None:
        return None
    quick = {name: of_state[name] for name in until.names if name in of_state}

    def columns_at(t: float, y: Vector) -> Row:
        if len(quick) == len(until.names):
            return {name: column(t, y) for name, column in quick.items()}
        q, v = y[: native.nq], y[native.nq :]
        multipliers = native.solve(t, q, v, k)[1]
        return row(Solution(np.array([t]), q[None], v[None], multipliers[None], NONE, NONE, Cost(0, 0, 0.0)))

    def value(t: float, y: Vector) -> float:
        columns = columns_at(t, y)
        try:
            return until.value(columns)
        except (ArithmeticError, ValueError) as error:
            raise SimulationError(f"until {until.text}: no value at t = {t:.9g} s: {error}") from None

    return StopEvent(until.text, value, until.crossing)


NONE = np.zeros((1, 2))
"""The drift of a row that is computed for a condition alone."""
