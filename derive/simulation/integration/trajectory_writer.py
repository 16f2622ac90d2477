"""Rows of a trajectory on their way into it: projected, checked, with their multipliers."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from derive.runtime.native import Matrix, Vector
from derive.simulation.compiled_scene import Mechanism
from derive.simulation.constraints.projection import drift_of, keep, project
from derive.simulation.integration.trajectory import Cost, Trajectory


@dataclass
class Rows:
    """The rows of a trajectory, written one after the other, projected, their drift held against `limit`."""

    native: Mechanism
    k: Vector
    size: int
    limit: float
    projected: bool
    count: int = 0
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

    def projected_state(self, t: float, y: Vector) -> Vector:
        """The state y = [q; v] on its constraints; raises DriftTooLarge where they cannot be met."""
        q, v = project(self.native, self.k, t, y[: self.native.nq], y[self.native.nq :])
        keep(self.native, self.k, t, q, v, self.limit)
        return np.concatenate([q, v])

    def trajectory(self, t: Vector, cost: Cost) -> Trajectory:
        """All rows, at the instants t."""
        n = self.native.nq
        return Trajectory(t, self.states[:, :n], self.states[:, n:], self.lam, self.drift, self.drift_before, cost)
