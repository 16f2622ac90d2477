"""The poses of the bodies of a scene in space in a configuration, with their twists by the velocities and by time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.configurations import displaced, velocities_with

DRIFT_STEP = 1e-4
"""s: the step of the differences by time; their errors are of its sixth power."""
CENTRAL = ((1, 45.0 / 60.0), (2, -9.0 / 60.0), (3, 1.0 / 60.0))
"""The weights of f(t + n h) - f(t - n h) in the difference of sixth order."""


@dataclass(frozen=True, eq=False)
class SpatialPoses:
    """The poses of a compiled scene in space at the time t (s) in the configuration q (nq,); size: of the scene, m.

    A twist is the velocity of the origin of a body frame, m/s in the inertial frame, and its angular velocity, rad/s in
    the frame of the body: (6,).
    """

    native: NativeScene
    k: Vector
    t: float
    q: Vector
    size: float

    @cached_property
    def values(self) -> Matrix:
        """The poses (bodies, 12)."""
        return self.native.poses(self.t, self.q, self.k)

    @cached_property
    def twists(self) -> Matrix:
        """The twists (bodies, 6, nv) by unit velocities.

        They are differences without truncation errors: positions are linear in lengths, and a rotation about an axis of
        a body makes functions of its sine and cosine, so that the derivative is half the change from -pi/2 to pi/2. On
        a screw there is also a part that grows with the angle, which whole turns show.
        """
        native, angles = self.native, velocities_with(self.native, Role.ROTATION)
        result = np.zeros((len(native.bodies), 6, native.nv))
        for j in np.flatnonzero(~velocities_with(native, Role.AMPLITUDE)):
            unit = np.zeros(native.nv)
            unit[j] = math.pi / 2 if angles[j] else self.size
            change = self._at(self.t, displaced(native, self.q, unit)) - self._at(
                self.t, displaced(native, self.q, -unit)
            )
            result[:, :, j] = self._twist(change / (2.0 if angles[j] else 2.0 * self.size))
            if angles[j]:
                turn = self._at(self.t, displaced(native, self.q, 2 * unit)) - self._at(
                    self.t, displaced(native, self.q, -2 * unit)
                )
                result[:, :3, j] += turn[:, :3] * (1 / (2 * math.pi) - 1 / 4)
        return result

    @cached_property
    def drifts(self) -> Matrix:
        """The twists (bodies, 6) at rest, due to drives."""
        total = np.zeros_like(self.values)
        for n, weight in CENTRAL:
            h = n * DRIFT_STEP
            total += weight * (self._at(self.t + h, self.q) - self._at(self.t - h, self.q)) / DRIFT_STEP
        return self._twist(total)

    def position(self, body: str) -> Vector:
        """The position (3,) of the origin of a body frame."""
        return np.asarray(self.values[self._number(body), :3])

    def rotation(self, body: str) -> Matrix:
        """The rotation tensor (3, 3) of a body frame."""
        return np.asarray(self.values[self._number(body), 3:].reshape(3, 3))

    def twist(self, body: str) -> tuple[Matrix, Vector]:
        """The twist of a body by unit velocities (6, nv), and at rest (6,)."""
        number = self._number(body)
        return self.twists[number], self.drifts[number]

    def _number(self, body: str) -> int:
        return self.native.bodies.index(body)

    def _at(self, t: float, q: Vector) -> Matrix:
        return self.native.poses(t, q, self.k)

    def _twist(self, change: Matrix) -> Matrix:
        """The twists (bodies, 6) of rates of poses (bodies, 12)."""
        Q = self.values[:, 3:].reshape(-1, 3, 3)
        spin = np.einsum("bki,bkj->bij", Q, change[:, 3:].reshape(-1, 3, 3))
        axial = np.stack(
            [spin[:, 2, 1] - spin[:, 1, 2], spin[:, 0, 2] - spin[:, 2, 0], spin[:, 1, 0] - spin[:, 0, 1]], 1
        )
        return np.hstack([change[:, :3], axial / 2])
