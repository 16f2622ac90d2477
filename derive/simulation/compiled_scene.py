"""What the numerics asks of a compiled scene, and its matrices as arrays."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from derive.ir.patterns import Pattern
from derive.runtime.native import Matrix, Vector


class Mechanism(Protocol):
    """M(q) vdot + h(t, q, v) = G^T lambda, g(t, q) = 0, qdot = v: the methods of a compiled scene (`Native`)."""

    name: str
    nq: int
    nv: int
    nlambda: int
    coordinates: tuple[str, ...]
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


def dense(pattern: Pattern, values: Vector) -> Matrix:
    """The matrix (rows, cols) of the values of a pattern, both triangles of a symmetric one."""
    full = np.zeros((pattern.rows, pattern.cols))
    rows = np.array(pattern.rowidx, dtype=int)
    cols = np.repeat(np.arange(pattern.cols), np.diff(pattern.colptr))
    full[rows, cols] = values
    if pattern.symmetric:
        full[cols, rows] = values
    return full


def mass_matrix(native: Mechanism, q: Vector, k: Vector) -> Matrix:
    """M (nv, nv)."""
    return dense(native.mass_pattern, native.mass(q, k))


def constraint_matrix(native: Mechanism, t: float, q: Vector, k: Vector) -> Matrix:
    """G (nlambda, nv)."""
    return dense(native.constraint_pattern, native.constraint_jacobian(t, q, k))
