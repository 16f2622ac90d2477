"""The velocities of a scene in space that rotates at a constant rate, and the axes that rotate with it.

In axes that rotate with the angular velocity W the bodies are at rest, or spin about axes of their own:

    cdot = u + W x c for the position of a body, omega = Q^T W + s for its angular velocity in its own frame,

and a constant for the coordinate of a joint, 0 for an amplitude. Their time derivatives are W x cdot and -s x omega.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import expm

from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.configurations import (
    COMPONENTS,
    QUATERNION,
    ROTATION,
    Configured,
    attitudes,
    blocks,
    origins,
    quaternion_product,
    rotation_matrix,
    skew,
    turned,
)

IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True, eq=False)
class RotatingField:
    """The velocities of a scene that rotates steadily.

    rotation (3,), rad/s, and shift (3,), m/s: the angular velocity W of the axes, and the velocity u of their points at
    the inertial origin. own (nv,): the constant rates of joint coordinates, and the spins s of bodies with quaternions.
    """

    native: Configured
    rotation: Vector
    shift: Vector
    own: Vector

    @property
    def spin(self) -> float:
        """The rate of the rotating axes, rad/s."""
        return float(np.linalg.norm(self.rotation))

    @property
    def rates(self) -> tuple[float, ...]:
        """The rates (rad/s) of the axes and of the bodies that spin on them, those that are not zero."""
        spins = [float(np.linalg.norm(self.own[j : j + ROTATION])) for _, j in attitudes(self.native)]
        return tuple(rate for rate in (self.spin, *spins) if rate > 0.0)

    def velocities(self, q: Vector) -> Vector:
        """The velocities (nv,) in a configuration q (nq,)."""
        v = np.array(self.own)
        for i, j in origins(self.native):
            v[j : j + COMPONENTS] = self.shift + np.cross(self.rotation, q[i : i + COMPONENTS])
        for i, j in attitudes(self.native):
            v[j : j + ROTATION] += rotation_matrix(q[i : i + QUATERNION]).T @ self.rotation
        return v

    def gradient(self, q: Vector) -> Matrix:
        """The derivatives (nv, nv) of the velocities by small changes of q."""
        D = np.zeros((self.native.nv, self.native.nv))
        for _, j in origins(self.native):
            D[j : j + COMPONENTS, j : j + COMPONENTS] = skew(self.rotation)
        for i, j in attitudes(self.native):
            D[j : j + ROTATION, j : j + ROTATION] = skew(rotation_matrix(q[i : i + QUATERNION]).T @ self.rotation)
        return D

    @cached_property
    def axes(self) -> Matrix:
        """The matrix (nv, nv) that takes velocities to their time derivatives: those of the axes that rotate along."""
        W = np.zeros((self.native.nv, self.native.nv))
        for _, j in origins(self.native):
            W[j : j + COMPONENTS, j : j + COMPONENTS] = skew(self.rotation)
        for _, j in attitudes(self.native):
            W[j : j + ROTATION, j : j + ROTATION] = -skew(self.own[j : j + ROTATION])
        return W

    def later(self, q: Vector, t: float) -> Vector:
        """The configuration (nq,) at the time t (s) after q."""
        result = np.array(q)
        affine = np.zeros((COMPONENTS + 1, COMPONENTS + 1))
        affine[:COMPONENTS, :COMPONENTS], affine[:COMPONENTS, COMPONENTS] = skew(self.rotation), self.shift
        along, of_axes = expm(t * affine), turned(IDENTITY, t * self.rotation)
        for i, _ in origins(self.native):
            result[i : i + COMPONENTS] = (along @ np.append(q[i : i + COMPONENTS], 1.0))[:COMPONENTS]
        for i, j, role in blocks(self.native):
            if role is Role.QUATERNION:
                e = quaternion_product(of_axes, q[i : i + QUATERNION])
                result[i : i + QUATERNION] = turned(e, t * self.own[j : j + ROTATION])
            elif role is not Role.TRANSLATION:
                result[i] += t * self.own[j]
        return result

    def carried(self, values: Vector, t: float) -> Vector:
        """Velocities or accelerations (nv,) that rotate along, at the time t (s) after."""
        return np.asarray(expm(t * self.axes) @ values)

    def text(self, size: float) -> str:
        """The rotation in words: its rate, its axis, and a point of the axis; size: of the scene, m."""
        if self.spin == 0.0:
            return f"translation with {_vector(self.shift, 1.0)} m/s" if self.shift.any() else "rest"
        axis = self.rotation / self.spin
        point = np.cross(self.rotation, self.shift) / self.spin**2
        along = float(axis @ self.shift)
        text = f"rotation with {self.spin:.6g} rad/s about {_vector(axis, 1.0)} through {_vector(point, size)} m"
        return text if abs(along) < 1e-9 * size * self.spin else f"{text}, moving along it with {along:.6g} m/s"


def _vector(values: Vector, size: float) -> str:
    """Components as text; those below 1e-9 of a size are rounding errors of zero."""
    return "[" + ", ".join(f"{x:.6g}" if abs(x) > 1e-9 * size else "0" for x in values) + "]"
