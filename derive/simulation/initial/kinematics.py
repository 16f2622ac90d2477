"""Poses of all bodies in a configuration, with their derivatives by the coordinates and by time.

Bodies whose coordinates a joint eliminates have poses as well, so that what is stated in poses does not depend on which
coordinates a scene keeps.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import coordinates_with, max_norm

STENCIL = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280])
"""Weights of f(t + n h) - f(t - n h), n = 1 to 4, in the central difference of eighth order, times h."""
TIME_MOTION = 1e-3
"""rad, and part of the size: how far drives move in a step of differences by time."""
FIRST_TIME_STEP, DOUBLINGS = 1e-9, 40


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

    moving: whether drifts are computed, which configurations alone do not need.
    """

    native: NativeScene
    k: Vector
    t: float
    q: Vector
    size: float
    moving: bool

    @cached_property
    def poses(self) -> Matrix:
        """(bodies, 3): c1, c2 (m), phi (rad) of the frame of each body in `native.bodies`."""
        return self.native.poses(self.t, self.q, self.k)

    @cached_property
    def gradients(self) -> Matrix:
        """(bodies, 3, nq): the derivatives of the poses by the coordinates.

        They are differences without truncation errors: poses are linear in lengths, and a rotation angle rotates a body
        about a point, so that the derivative of a position by it is half of its change from -pi/2 to pi/2.
        """
        angles = coordinates_with(self.native, Role.ROTATION)
        result = np.zeros((*self.poses.shape, len(self.q)))
        for j in np.flatnonzero(~coordinates_with(self.native, Role.AMPLITUDE)):
            unit = np.zeros_like(self.q)
            unit[j] = step = math.pi / 2 if angles[j] else self.size
            change = self._poses(self.t, self.q + unit) - self._poses(self.t, self.q - unit)
            result[..., :2, j] = change[..., :2] / (2 if angles[j] else 2 * step)
            result[..., 2, j] = change[..., 2] / (2 * step)
        return result

    @cached_property
    def drifts(self) -> Matrix:
        """(bodies, 3): the derivatives of the poses by time, due to drives."""
        step = self._time_step() if self.moving else None
        if step is None:
            return np.zeros_like(self.poses)
        pairs = ((self._poses(self.t + n * step, self.q), self._poses(self.t - n * step, self.q)) for n in range(1, 5))
        return np.asarray(sum(w * (later - earlier) for w, (later, earlier) in zip(STENCIL, pairs, strict=True))) / step

    def component(self, body: str, i: int) -> Linear:
        """c1, c2 or phi (i = 0, 1, 2) of the frame of a body."""
        b = self.native.bodies.index(body)
        return Linear(float(self.poses[b, i]), self.gradients[b, i], float(self.drifts[b, i]))

    def coordinate(self, j: int) -> Linear:
        """The coordinate number j."""
        return Linear(float(self.q[j]), np.eye(len(self.q))[j], 0.0)

    def constant(self, value: float) -> Linear:
        """A constant."""
        return Linear(value, np.zeros_like(self.q), 0.0)

    def _poses(self, t: float, q: Vector) -> Matrix:
        return self.native.poses(t, q, self.k)

    def _time_step(self) -> float | None:
        """The time in which drives move a body by TIME_MOTION; None if they do not."""
        for doubling in range(DOUBLINGS):
            step = FIRST_TIME_STEP * 2.0**doubling
            moved = np.abs(self._poses(self.t + step, self.q) - self.poses)
            if max(max_norm(moved[:, 2]), max_norm(moved[:, :2].ravel()) / self.size) > TIME_MOTION:
                return step
        return None
