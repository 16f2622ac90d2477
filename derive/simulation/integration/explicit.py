"""Explicit integration of a compiled scene by SciPy: steps of its own choice, projected onto the constraints."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np
from scipy.integrate import DOP853, RK45

from derive.runtime.native import ModelError, Vector
from derive.simulation.compiled_scene import Mechanism
from derive.simulation.errors import DriftTooLarge, IntegrationStopped
from derive.simulation.integration.evaluator import Evaluator
from derive.simulation.integration.failure_diagnosis import explained, reason_to_stop
from derive.simulation.integration.trajectory import Cost, Trajectory
from derive.simulation.integration.trajectory_writer import Rows

MOST_STEPS = 20_000
"""Steps for each row on average; more than that lead nowhere."""

METHODS: dict[str, Any] = {"DOP853": DOP853, "RK45": RK45}


def integrate(
    native: Mechanism,
    k: Vector,
    q: Vector,
    v: Vector,
    times: Sequence[float] | Vector,
    *,
    method: Literal["DOP853", "RK45"] = "DOP853",
    tolerance: float = 1e-9,
    drift: float = 1e-9,
    projected: bool = True,
    max_step: float = np.inf,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """The motion from the consistent state (q, v) at times[0], at all `times` (s, increasing).

    `tolerance` is the error of a step, relative and absolute (SI). `drift` is how far constraints may be off (m, rad)
    and their rates (m/s, rad/s) in any row, and after any step that is projected. The state is projected after each
    step, and so are rows that lie within one; with `projected` False nothing is. `progress` is called with the time
    reached after each step.

    Raises SingularConfiguration or DriveCannotBeFollowed at a dead centre, DriftTooLarge, IntegrationStopped.
    """
    began = time.process_time()
    instants = increasing(times)
    evaluator = Evaluator(native, k)
    rows = Rows(native, k, len(instants), drift, projected)
    t, y, steps = float(instants[0]), np.concatenate([q, v]), 0
    try:
        rows.write(t, y)
        solver = METHODS[method](
            evaluator, t, y, instants[-1], rtol=max(tolerance, 1e-13), atol=tolerance, max_step=max_step
        )
        while rows.count < len(instants):
            evaluator.refused = None
            message = solver.step()
            if message is not None:
                raise reason_to_stop(native, k, t, y, evaluator.refused, message)
            steps += 1
            if steps > MOST_STEPS * len(instants):
                raise IntegrationStopped(t, f"{steps} steps have not got further")
            if instants[rows.count] < solver.t:
                dense = solver.dense_output()
                while rows.count < len(instants) and instants[rows.count] < solver.t:
                    rows.write(float(instants[rows.count]), dense(instants[rows.count]))
            if rows.count < len(instants) and instants[rows.count] == solver.t:
                rows.write(float(solver.t), solver.y)
            if projected:
                solver.y = rows.projected_state(solver.t, solver.y)
                solver.f = evaluator(solver.t, solver.y)
            t, y = float(solver.t), solver.y
            if progress is not None:
                progress(t)
    except (ModelError, DriftTooLarge) as error:
        raise explained(native, k, t, y, error) from error
    return rows.trajectory(instants, Cost(evaluator.evaluations, steps, time.process_time() - began))


def increasing(times: Sequence[float] | Vector) -> Vector:
    """The instants of rows, s. ValueError if there are none, or they do not increase."""
    instants = np.array(times, dtype=float)
    if instants.ndim != 1 or not len(instants) or not np.all(np.diff(instants) > 0.0):
        raise ValueError("the times of rows have to be a list that increases")
    return instants
