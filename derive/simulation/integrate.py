"""Explicit integration of a compiled scene by SciPy: steps of its own choice, projected onto the constraints."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from scipy.integrate import DOP853, RK45

from derive.native import Matrix, ModelError, Vector
from derive.simulation.evaluator import Evaluator
from derive.simulation.mechanism import Mechanism
from derive.simulation.projection import drift_of, keep, project
from derive.simulation.stopped import reason_to_stop
from derive.simulation.trajectory import Cost, Trajectory

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
    and their rates (m/s, rad/s) in any row. The state is projected after each step, and so are rows that lie within a
    step; with `projected` False nothing is. `progress` is called with the time reached after each step.

    Raises SingularConfiguration or DriveCannotBeFollowed at a dead centre, DriftTooLarge, IntegrationStopped.
    """
    began = time.process_time()
    instants = np.array(times, dtype=float)
    evaluator = Evaluator(native, k)
    rows = _Rows(native, k, len(instants), drift, projected)
    y = np.concatenate([q, v])
    steps = 0
    try:
        rows.write(float(instants[0]), y)
        solver = METHODS[method](
            evaluator, instants[0], y, instants[-1], rtol=max(tolerance, 1e-13), atol=tolerance, max_step=max_step
        )
        while rows.count < len(instants):
            y = solver.y
            message = solver.step()
            if message is not None:
                raise reason_to_stop(native, k, solver.t, solver.y, evaluator.refused, message)
            steps += 1
            dense = solver.dense_output() if instants[rows.count] < solver.t else None
            while dense is not None and rows.count < len(instants) and instants[rows.count] < solver.t:
                rows.write(float(instants[rows.count]), dense(instants[rows.count]))
            if rows.count < len(instants) and instants[rows.count] == solver.t:
                rows.write(float(solver.t), solver.y)
            if projected:
                solver.y = np.concatenate(project(native, k, solver.t, solver.y[: native.nq], solver.y[native.nq :]))
                solver.f = evaluator(solver.t, solver.y)
            if progress is not None:
                progress(float(solver.t))
    except ModelError as error:
        raise reason_to_stop(native, k, rows.latest, y, (rows.latest, error), str(error)) from error
    cost = Cost(evaluator.evaluations, steps, time.process_time() - began)
    states = rows.states
    return Trajectory(
        instants, states[:, : native.nq], states[:, native.nq :], rows.lam, rows.drift, rows.drift_before, cost
    )


@dataclass
class _Rows:
    """The rows of a trajectory, written one after the other, projected, their drift held against `limit`."""

    native: Mechanism
    k: Vector
    size: int
    limit: float
    projected: bool
    count: int = 0
    latest: float = 0.0
    states: Matrix = field(init=False)
    lam: Matrix = field(init=False)
    drift: Matrix = field(init=False)
    drift_before: Matrix = field(init=False)

    def __post_init__(self) -> None:
        self.states = np.zeros((self.size, self.native.nq + self.native.nv))
        self.lam = np.zeros((self.size, self.native.nlambda))
        self.drift, self.drift_before = np.zeros((self.size, 2)), np.zeros((self.size, 2))

    def write(self, t: float, y: Vector) -> None:
        """Write the row of the state y = [q; v] at t."""
        n, i = self.native.nq, self.count
        self.latest = t
        q, v = y[:n], y[n:]
        before = drift_of(self.native, self.k, t, q, v)
        if self.projected:
            q, v = project(self.native, self.k, t, q, v)
        after = keep(self.native, self.k, t, q, v, self.limit)
        self.states[i, :n], self.states[i, n:] = q, v
        self.lam[i] = self.native.solve(t, q, v, self.k)[1]
        self.drift_before[i] = before.position, before.velocity
        self.drift[i] = after.position, after.velocity
        self.count += 1
