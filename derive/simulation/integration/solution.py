"""The result of an integration: states at the requested times, their drift, the cost; and the writer that fills it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from derive.runtime.integrators.watch import Watched
from derive.runtime.native_call import Matrix, Vector
from derive.short_text import counted, summary
from derive.simulation.compiled_scene import ConstrainedSystem
from derive.simulation.constraints.projection import check_drift, drift, project
from derive.simulation.integration.stop_event import StopEvent

Progress = Callable[[float], None]
"""A function that is called with the time (s) that an integration has reached."""


@dataclass(frozen=True, eq=False)
class Cost:
    """The cost of an integration. evaluations: of vdot, or of the residual. seconds: CPU time of the whole integration.

    jacobians: their number, if any. calls: all counts of a C integrator by their names.
    """

    evaluations: int
    steps: int
    seconds: float
    jacobians: int = 0
    calls: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Solution:
    """The result of an integration in SI units.

    Attributes:
        t: the times (n,), s.
        q: coordinates (n, nq).
        v: generalised velocities (n, nv).
        lam: multipliers (n, nlambda).
        drift: the largest violation of a constraint (m, rad) and of its rate (m/s, rad/s) in each row (n, 2).
        drift_before: the same before the projection of the row (n, 2), which is the drift of one step and the error of
            interpolation within it.
        cost: the evaluations and the time of the integration.
        notes: for the user, the deviations of the integrator from its settings, and where a stop condition is met.
        outputs: the outputs of the model (n, nout); None if the integrator does not compute them.
        watched: the values of watched quantities; None if the integrator does not compute them.

    Examples:
        >>> import derive
        >>> ball = derive.scene("fall", gravity=(0, -10), bodies={"ball": {"mass": 1, "inertia": 1}})
        >>> solution = derive.simulate(ball, duration=1, output=0.5).solution
        >>> solution.q[:, 1].round(6) + 0.0
        array([ 0.  , -1.25, -5.  ])
        >>> solution.lam.shape  # there are no joints
        (3, 0)
    """

    t: Vector
    q: Matrix
    v: Matrix
    lam: Matrix
    drift: Matrix
    drift_before: Matrix
    cost: Cost
    notes: tuple[str, ...] = ()
    outputs: Matrix | None = None
    watched: Watched | None = None

    def __repr__(self) -> str:
        span = f"{counted(len(self.t), 'row')} from {self.t[0]:g} to {self.t[-1]:g} s"
        effort = counted(self.cost.steps, "step"), counted(self.cost.evaluations, "evaluation")
        position, velocity = np.abs(self.drift).max(axis=0) if self.drift.size else (0.0, 0.0)
        return summary(
            f"Solution: {span}, nq = {self.q.shape[1]}, nv = {self.v.shape[1]}, nlambda = {self.lam.shape[1]}",
            {
                "cost": f"{', '.join(effort)}, {self.cost.seconds:.3g} s of CPU time",
                "drift": f"{position:.1e} m or rad, {velocity:.1e} m/s or rad/s",
                "notes": "; ".join(self.notes),
            },
        )


@dataclass
class SolutionWriter:
    """Writes a solution row by row: it projects each state, checks its drift, and solves for its multipliers.

    k: the constants (nk,) of `setup`. times: those of the rows (n,), s. limit: that of |g| (m, rad) and |gdot| (m/s,
    rad/s). projected: whether states are projected onto the constraints. until: the condition that ends the
    integration, if there is one. count: the number of rows written so far. met_from: the time (s) of the first row if
    the condition holds there.
    """

    native: ConstrainedSystem
    k: Vector
    times: Vector
    limit: float
    projected: bool
    until: StopEvent | None = None
    count: int = 0
    met_from: float | None = None
    states: Matrix = field(init=False)
    lam: Matrix = field(init=False)
    drift: Matrix = field(init=False)
    drift_before: Matrix = field(init=False)

    def __post_init__(self) -> None:
        size = len(self.times) + 1  # and one row where a condition ends the integration between two rows
        self.states = np.zeros((size, self.native.nq + self.native.nv))
        self.lam = np.zeros((size, self.native.nlambda))
        self.drift, self.drift_before = np.zeros((size, 2)), np.zeros((size, 2))

    def append(self, t: float, y: Vector) -> None:
        """Write the row of the state y = [q; v] at t (s). Raises DriftTooLarge, ModelError."""
        n, i = self.native.nq, self.count
        q, v = y[:n], y[n:]
        before = drift(self.native, self.k, t, q, v)
        if self.projected:
            q, v = project(self.native, self.k, t, q, v)
        after = check_drift(self.native, self.k, t, q, v, self.limit)
        self.states[i, :n], self.states[i, n:] = q, v
        self.lam[i] = self.native.solve(t, q, v, self.k)[1]
        self.drift_before[i] = before.position, before.velocity
        self.drift[i] = after.position, after.velocity
        if self.until is not None and i == 0 and self.until.holds(self.until.value(t, self.states[0])):
            self.met_from = t
        self.count += 1

    @property
    def following(self) -> float:
        """The time (s) of the next row."""
        return float(self.times[self.count])

    def projected_state(self, t: float, y: Vector) -> Vector:
        """The state y = [q; v] projected onto its constraints. Raises DriftTooLarge where they cannot be met."""
        q, v = project(self.native, self.k, t, y[: self.native.nq], y[self.native.nq :])
        check_drift(self.native, self.k, t, q, v, self.limit)
        return np.concatenate([q, v])

    def stop_time(self, first: float, last: float, dense: Callable[[float], Vector]) -> float | None:
        """The first time (s) between two at which the condition is met, see `StopEvent.time`; None if it is not.

        dense: the state y within the step, which is projected as rows are.
        """
        if self.until is None:
            return None
        return self.until.time(first, last, (lambda t: self.projected_state(t, dense(t))) if self.projected else dense)

    def solution(self, cost: Cost, notes: tuple[str, ...] = ()) -> Solution:
        """The solution with all rows, with these notes and the note on a condition that is never met."""
        if self.until is not None:
            notes = (*notes, *self.until.notes(float(self.times[-1]), self.met_from, met=False))
        return self._solution(self.times, cost, notes)

    def stopped_solution(
        self, stop: float, dense: Callable[[float], Vector], cost: Cost, notes: tuple[str, ...] = ()
    ) -> Solution:
        """The solution with the rows up to the time `stop` (s) at which the condition is met, and a row there.

        dense: the state y at a time after the last row that is written.
        """
        assert self.until is not None
        while self.count < len(self.times) and self.following < stop:
            self.append(self.following, dense(self.following))
        times = self.times[: self.count]
        if stop > times[-1]:
            self.append(stop, dense(stop))
            times = np.append(times, stop)
        return self._solution(times, cost, (*notes, *self.until.notes(stop, self.met_from, met=True)))

    def _solution(self, t: Vector, cost: Cost, notes: tuple[str, ...]) -> Solution:
        n, rows = self.native.nq, slice(len(t))
        states, lam, drift, before = self.states[rows], self.lam[rows], self.drift[rows], self.drift_before[rows]
        return Solution(t, states[:, :n], states[:, n:], lam, drift, before, cost, notes)


def row_times(times: Sequence[float] | Vector) -> Vector:
    """The times (n,) of rows, s. Raises ValueError if there are none, or if they do not increase."""
    instants = np.array(times, dtype=float)
    if instants.ndim != 1 or not len(instants) or not np.all(np.diff(instants) > 0.0):
        raise ValueError("the times of rows have to be a list that increases")
    return instants
