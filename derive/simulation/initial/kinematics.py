"""Poses of all bodies in a configuration, with their derivatives by the coordinates and by time.

Bodies whose coordinates a joint eliminates have poses as well, so that functions of poses do not depend on which
coordinates a scene keeps.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import coordinates_with, max_norm

NODES = 8
WEIGHTS = np.array([(-1) ** (n + 1) * math.comb(NODES, n) / n for n in range(1, NODES + 1)])
"""Weights of f(t + n h) - f(t), n = 1 to NODES, in the forward difference of order NODES, times h."""
FIRST_STEP, DOUBLINGS = 1e-8, 36
"""The smallest step (s) of differences by time, and how often it is doubled."""
TOO_LARGE = 1e3
"""A step is too large if its error is this multiple of that of a smaller one."""
ROUNDING = float(np.finfo(float).eps * np.abs(WEIGHTS).sum())
"""The rounding error of a difference times h, relative to the poses."""


Bodies = NDArray[np.bool_]
"""A mask of bodies (bodies,)."""
Columns = Mapping[int, Bodies]
"""Numbers of coordinates, with the bodies that each moves."""


def single_columns(native: NativeScene) -> tuple[Columns, ...]:
    """The coordinates that are no amplitudes, one by one, each as if it moved all bodies."""
    every = np.ones(len(native.bodies), dtype=bool)
    return tuple({int(j): every} for j in np.flatnonzero(~coordinates_with(native, Role.AMPLITUDE)))


@dataclass(frozen=True, eq=False)
class Linear:
    """A scalar of the configuration: its value, and its derivatives by the coordinates (nq,) and by time at constant
    coordinates, so that its rate is gradient . v + drift."""

    value: float
    gradient: Vector
    drift: float

    def __add__(self, other: Linear) -> Linear:
        return Linear(self.value + other.value, self.gradient + other.gradient, self.drift + other.drift)

    def scaled(self, factor: float) -> Linear:
        """The product with a constant."""
        return Linear(factor * self.value, factor * self.gradient, factor * self.drift)


@dataclass(frozen=True, eq=False)
class Kinematics:
    """The poses of a compiled scene at the time t (s) in the configuration q (nq,); size: that of the scene, m.

    moving: whether drifts are computed, which configurations alone do not need. groups: the coordinates whose gradients
    are computed at once; by default one after the other.
    """

    native: NativeScene
    k: Vector
    t: float
    q: Vector
    size: float
    moving: bool
    groups: tuple[Columns, ...] = field(default=(), kw_only=True)

    @cached_property
    def poses(self) -> Matrix:
        """The poses (bodies, 3): c1, c2 (m), phi (rad) of the frame of each body in `native.bodies`."""
        return self.native.poses(self.t, self.q, self.k)

    @cached_property
    def gradients(self) -> Matrix:
        """The derivatives (bodies, 3, nq) of the poses by the coordinates.

        They are differences without truncation errors: poses are linear in lengths, and a rotation angle rotates a body
        about a point, so that the derivative of a position by it is half of its change from -pi/2 to pi/2.
        """
        angles = coordinates_with(self.native, Role.ROTATION)
        result = np.zeros((*self.poses.shape, len(self.q)))
        for columns in self.groups or single_columns(self.native):
            unit = np.zeros_like(self.q)
            for j in columns:
                unit[j] = math.pi / 2 if angles[j] else self.size
            change = self._poses(self.t, self.q + unit) - self._poses(self.t, self.q - unit)
            for j, bodies in columns.items():
                result[bodies, :2, j] = change[bodies, :2] / (2 if angles[j] else 2 * unit[j])
                result[bodies, 2, j] = change[bodies, 2] / (2 * unit[j])
        return result

    def grouped(self) -> tuple[Columns, ...]:
        """Groups of coordinates of which each body depends on one at most.

        A coordinate that moves a body does so in all configurations, so that the gradients in one show which.
        """
        moved = np.any(self.gradients != 0.0, axis=1)
        groups: list[dict[int, Bodies]] = []
        taken: list[Bodies] = []
        for columns in single_columns(self.native):
            for j in columns:
                bodies = moved[:, j]
                free = (k for k, of in enumerate(taken) if not np.any(of & bodies))
                k = next(free, len(taken))
                if k == len(taken):
                    groups.append({})
                    taken.append(np.zeros_like(bodies))
                groups[k][j] = bodies
                taken[k] = taken[k] | bodies
        return tuple(groups)

    @cached_property
    def drifts(self) -> Matrix:
        """The derivatives (bodies, 3) of the poses by time, due to drives: those behind t, where functions may begin.

        They are forward differences of the step whose rounding error and truncation error, by which it differs from the
        next smaller step, are least together. Drifts below this error are zero.
        """
        best, units = np.zeros_like(self.poses), self._units
        if not self.moving:
            return best
        rounding = ROUNDING * float(np.abs(self.poses / units).max(initial=1.0))
        changes: dict[float, Matrix] = {}
        least, last = math.inf, best
        for h in FIRST_STEP * 2.0 ** np.arange(DOUBLINGS):
            for time in h * np.arange(1, NODES + 1):
                if time not in changes:
                    changes[time] = self._poses(self.t + time, self.q) - self.poses
            drift = np.tensordot(WEIGHTS, [changes[time] for time in h * np.arange(1, NODES + 1)], axes=1) / h
            truncation = float(np.abs((drift - last) / units).max(initial=0.0))
            error = truncation + 2 * rounding / h
            if not math.isfinite(truncation) or truncation > TOO_LARGE * least:
                break
            if h > FIRST_STEP and error < least:
                least, best = error, np.where(np.abs(last) > error * units, last, 0.0)
            last = drift
        return best

    def largest_rate(self, v: Vector) -> float:
        """The largest angular velocity (rad/s) of a body, or its velocity in sizes of the scene, at v (nv,)."""
        return max_norm(((self.gradients @ v + self.drifts) / self._units).ravel())

    @property
    def _units(self) -> Vector:
        """The scales of c1, c2 (the size of the scene, m) and phi (1 rad)."""
        return np.array([self.size, self.size, 1.0])

    def component(self, body: str, i: int) -> Linear:
        """The component c1, c2 or phi (i = 0, 1, 2) of the pose of the frame of a body."""
        b = self.native.bodies.index(body)
        return Linear(float(self.poses[b, i]), self.gradients[b, i], float(self.drifts[b, i]))

    def coordinate(self, j: int) -> Linear:
        """The coordinate number j."""
        return Linear(float(self.q[j]), np.eye(len(self.q))[j], 0.0)

    def chained(self, gradient: Vector) -> Vector:
        """The derivatives of a scalar as those of a `Linear`, from those by the coordinates (nq,)."""
        return gradient

    def constant(self, value: float) -> Linear:
        """A constant."""
        return Linear(value, np.zeros_like(self.q), 0.0)

    def _poses(self, t: float, q: Vector) -> Matrix:
        return self.native.poses(t, q, self.k)


NOTHING = np.zeros(0)


@dataclass(frozen=True, eq=False)
class PoseValues(Kinematics):
    """The poses of a scene alone: functions of the configuration have values, but neither gradients nor drifts."""

    def component(self, body: str, i: int) -> Linear:
        """The component c1, c2 or phi (i = 0, 1, 2) of the pose of the frame of a body."""
        return self.constant(float(self.poses[self.native.bodies.index(body), i]))

    def coordinate(self, j: int) -> Linear:
        """The coordinate number j."""
        return self.constant(float(self.q[j]))

    def chained(self, gradient: Vector) -> Vector:
        """No derivatives."""
        return NOTHING

    def constant(self, value: float) -> Linear:
        """A constant."""
        return Linear(value, NOTHING, 0.0)
