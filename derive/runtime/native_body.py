"""The functions of a compiled body that moves alone: those of a model, and those of an empty set of constraints."""

from __future__ import annotations

import ctypes

import numpy as np
from numpy.typing import ArrayLike

from derive.ir.patterns import Pattern
from derive.runtime.compiled_model import Native
from derive.runtime.native_call import Vector

NONE = np.zeros(0)


class NativeBody(Native):
    """A compiled body: M vdot + h = 0 and qdot = rates(q, v); methods for scenes take it, as it has no constraints."""

    def __init__(self, library: ctypes.CDLL, name: str) -> None:
        super().__init__(library, name)
        self.multipliers: tuple[str, ...] = ()
        self.constraint_pattern = Pattern(0, self.nv, (0,) * (self.nv + 1), (), symmetric=False)

    def constraints(self, t: float, q: ArrayLike, k: ArrayLike) -> Vector:
        """The constraints g, which are empty."""
        return NONE

    def constraint_rates(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """The rates gdot of the constraints, which are empty."""
        return NONE

    def constraint_jacobian(self, t: float, q: ArrayLike, k: ArrayLike) -> Vector:
        """The values of the constraint Jacobian G, which is empty."""
        return NONE

    def solve(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> tuple[Vector, Vector]:
        """The accelerations vdot (nv,), and no multipliers."""
        return self.accel(t, q, v, k), NONE

    def project_velocity(self, t: float, q: ArrayLike, k: ArrayLike, r: ArrayLike) -> Vector:
        """The change of the velocities that constraints need (nv,): zero."""
        return np.zeros(self.nv)
