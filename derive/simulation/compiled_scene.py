"""What the numerical methods need of a compiled scene: its functions as a protocol, and its matrices as arrays."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from derive.ir.patterns import Pattern
from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector

Mask = NDArray[np.bool_]


class ConstrainedSystem(Protocol):
    """M(q) vdot + h(t, q, v) = G^T lambda with constraints g(t, q) = 0 and qdot = v, as `NativeScene` computes them.

    q, v are (nq,) = (nv,), k (nk,) the constants of `setup`, lambda and g (nlambda,), all in SI units.
    """

    name: str
    nq: int
    nv: int
    nlambda: int
    coordinates: tuple[str, ...]
    roles: tuple[Role, ...]
    multipliers: tuple[str, ...]
    mass_pattern: Pattern
    constraint_pattern: Pattern

    def mass(self, q: Vector, k: Vector) -> Vector:
        """Values of the lower triangle of M."""

    def force(self, t: float, q: Vector, v: Vector, k: Vector) -> Vector:
        """h."""

    def accel(self, t: float, q: Vector, v: Vector, k: Vector) -> Vector:
        """vdot; raises ModelError, 1 if a pivot vanishes."""

    def solve(self, t: float, q: Vector, v: Vector, k: Vector) -> tuple[Vector, Vector]:
        """vdot and lambda."""

    def constraints(self, t: float, q: Vector, k: Vector) -> Vector:
        """g (m, rad)."""

    def constraint_rates(self, t: float, q: Vector, v: Vector, k: Vector) -> Vector:
        """G v + dg/dt (m/s, rad/s)."""

    def constraint_jacobian(self, t: float, q: Vector, k: Vector) -> Vector:
        """Values of G."""

    def project_velocity(self, t: float, q: Vector, k: Vector, r: Vector) -> Vector:
        """The smallest change of v, in the metric of M, with G dv = r."""


def mass_matrix(native: ConstrainedSystem, q: Vector, k: Vector) -> Matrix:
    """M (nv, nv)."""
    return native.mass_pattern.dense(native.mass(q, k))


def constraint_matrix(native: ConstrainedSystem, t: float, q: Vector, k: Vector) -> Matrix:
    """G (nlambda, nv)."""
    return native.constraint_pattern.dense(native.constraint_jacobian(t, q, k))


def kkt_matrix(native: ConstrainedSystem, t: float, q: Vector, k: Vector) -> Matrix:
    """[M, -G^T; -G, 0] (nv + nlambda, nv + nlambda), in SI units, not scaled."""
    M, G = mass_matrix(native, q, k), constraint_matrix(native, t, q, k)
    return np.block([[M, -G.T], [-G, np.zeros((len(G), len(G)))]])


def coordinates_with(native: ConstrainedSystem, *roles: Role) -> Mask:
    """The mask (nq,) of the coordinates with one of these roles."""
    return np.array([role in roles for role in native.roles], dtype=bool)


def max_norm(values: Vector) -> float:
    """The largest absolute value: infinite if one is not finite, 0 of an empty vector."""
    if not np.all(np.isfinite(values)):
        return float("inf")
    return float(np.max(np.abs(values), initial=0.0))
