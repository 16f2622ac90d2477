"""The interface of compiled scenes to numerical methods: functions as a protocol, and matrices as dense arrays."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from derive.ir.patterns import Pattern
from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector

Mask = NDArray[np.bool_]
ROUNDING = 1e-12
"""Rows whose entries are at most this (m or rad), times the size of the coordinates, are zero but for rounding errors,
as those of a second hinge of a door that has an angle."""


class Constraints(Protocol):
    """Constraints g(t, q) = 0 on coordinates with the metric M(q), as a compiled scene computes them."""

    nq: int
    nv: int
    roles: tuple[Role, ...]
    mass_pattern: Pattern
    constraint_pattern: Pattern

    def mass(self, q: Vector, k: Vector) -> Vector:
        """The values of the lower triangle of the mass matrix M by columns."""

    def constraints(self, t: float, q: Vector, k: Vector) -> Vector:
        """The constraints g, m or rad."""

    def constraint_jacobian(self, t: float, q: Vector, k: Vector) -> Vector:
        """The values of the Jacobian G by columns."""


class ConstrainedSystem(Constraints, Protocol):
    """M(q) vdot + h(t, q, v) = G^T lambda with constraints g(t, q) = 0, as `NativeScene` computes them.

    q is (nq,), v (nv,); qdot = rates(q, v), which is v except in space, where nq > nv. k (nk,) are the constants of
    `setup`, lambda and g are (nlambda,), all in SI units. proximal: whether constraints may be redundant; the
    multipliers are those of least norm then. in_space: whether the bodies are in space. bodies: the names of those of
    a scene.
    """

    name: str
    nlambda: int
    proximal: bool
    in_space: bool
    bodies: tuple[str, ...]
    coordinates: tuple[str, ...]
    velocities: tuple[str, ...]
    multipliers: tuple[str, ...]

    def rates(self, q: Vector, v: Vector, k: Vector) -> Vector:
        """The rates qdot (nq,) of the coordinates."""

    def force(self, t: float, q: Vector, v: Vector, k: Vector) -> Vector:
        """The forces h (nv,)."""

    def accel(self, t: float, q: Vector, v: Vector, k: Vector) -> Vector:
        """The accelerations vdot (nv,). Raises ModelError, with code 1 if a pivot vanishes."""

    def solve(self, t: float, q: Vector, v: Vector, k: Vector) -> tuple[Vector, Vector]:
        """The accelerations vdot (nv,) and the multipliers lambda (nlambda,). Raises ModelError."""

    def constraint_bias(self, t: float, q: Vector, v: Vector, k: Vector) -> Vector:
        """The right-hand side gamma (nlambda,) of G vdot = gamma, m/s^2 or rad/s^2."""

    def constraint_rates(self, t: float, q: Vector, v: Vector, k: Vector) -> Vector:
        """The time derivatives G v + dg/dt (nlambda,) of the constraints, m/s or rad/s."""

    def project_velocity(self, t: float, q: Vector, k: Vector, r: Vector) -> Vector:
        """The smallest change dv (nv,) of v, in the metric of M, with G dv = r (nlambda,). Raises ModelError."""


def mass_matrix(native: Constraints, q: Vector, k: Vector) -> Matrix:
    """The mass matrix M (nv, nv)."""
    return native.mass_pattern.dense(native.mass(q, k))


def constraint_matrix(native: Constraints, t: float, q: Vector, k: Vector) -> Matrix:
    """The constraint Jacobian G (nlambda, nv); rows that are zero but for rounding errors are zero."""
    G = native.constraint_pattern.dense(native.constraint_jacobian(t, q, k))
    G[np.abs(G).max(axis=1, initial=0.0) <= rounding(q)] = 0.0
    return G


def rounding(q: Vector) -> float:
    """The size (m or rad) of entries of G in the configuration q (nq,) that are zero but for rounding errors."""
    return ROUNDING * max(1.0, float(np.max(np.abs(q), initial=0.0)))


def kkt_matrix(native: ConstrainedSystem, t: float, q: Vector, k: Vector) -> Matrix:
    """The KKT matrix [M, -G^T; -G, 0] (nv + nlambda, nv + nlambda), in SI units and without scaling."""
    M, G = mass_matrix(native, q, k), constraint_matrix(native, t, q, k)
    return np.block([[M, -G.T], [-G, np.zeros((len(G), len(G)))]])


def coordinates_with(native: Constraints, *roles: Role) -> Mask:
    """The mask (nq,) of the coordinates with one of these roles."""
    return np.array([role in roles for role in native.roles], dtype=bool)


def undeformed(native: Constraints, q: Vector) -> Vector:
    """The configuration q (nq,) without deformation: its amplitudes are zero."""
    return np.where(coordinates_with(native, Role.AMPLITUDE), 0.0, q)


def max_norm(values: Vector) -> float:
    """The largest absolute value: infinite if a value is not finite, 0 for an empty vector."""
    if not np.all(np.isfinite(values)):
        return float("inf")
    return float(np.max(np.abs(values), initial=0.0))
