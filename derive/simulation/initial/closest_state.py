"""The state next to a guess that meets g(t, q) = 0: damped Newton steps of the smallest kinetic energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular

from derive.runtime.native import Matrix, Vector
from derive.simulation.compiled_scene import Mechanism, constraint_matrix, mass_matrix
from derive.simulation.constraints.scaling import SINGULAR, Mask, metric, per_speed, sizes

CLOSED = 1e-11
"""Constraints that are off by less than this (m, rad; times the largest coordinate if that is above 1) are met."""
ITERATIONS = 100


@dataclass(frozen=True)
class Closure:
    """Where the search ended: q (nq,), and g (nlambda,) there."""

    q: Vector
    g: Vector

    @property
    def error(self) -> float:
        """The largest g (m, rad)."""
        return largest(self.g)

    @property
    def closed(self) -> bool:
        """Whether the constraints are met."""
        return self.error <= CLOSED * max(1.0, largest(self.q))


def largest(values: Vector) -> float:
    """The largest absolute value; infinite if one is not finite, 0 for none."""
    if not np.all(np.isfinite(values)):
        return float("inf")
    return float(np.max(np.abs(values), initial=0.0))


def close(native: Mechanism, k: Vector, t: float, guess: Vector, free: Mask) -> Closure:
    """Change the coordinates `free` until the constraints are met to rounding errors, or nothing improves any more.

    A Levenberg-Marquardt iteration in the metric of the mass: Newton with the least change where it converges.
    """
    R = metric(mass_matrix(native, guess, k)[np.ix_(free, free)])
    q, g = guess.copy(), native.constraints(t, guess, k)
    G = constraint_matrix(native, t, q, k)[:, free]
    lengths = sizes(native, k, t, guess, R, free)
    damping = 0.0
    for _ in range(ITERATIONS):
        if not g.size or largest(g) == 0.0 or not np.isfinite(damping):
            break
        A = per_speed(G, R) / lengths[:, None]
        trial = q.copy()
        trial[free] += solve_triangular(R, damped_step(A, -g / lengths, damping))
        g_trial = native.constraints(t, trial, k)
        before, after = np.linalg.norm(g / lengths), np.linalg.norm(g_trial / lengths)
        if after < before:  # also false for NaN
            q, g, G = trial, g_trial, constraint_matrix(native, t, trial, k)[:, free]
            damping = 0.0 if after < 0.5 * before else damping / 4
            if after > (1 - 1e-9) * before:
                break
        elif largest(g) <= CLOSED * max(1.0, largest(q)):
            break
        else:
            damping = max(8 * damping, 1e-6)
            if damping > 1e6:
                break
    return Closure(q, g)


def damped_step(A: Matrix, r: Vector, damping: float) -> Vector:
    """The smallest x next to A x = r, for singular values s of A: damped by s^2 + damping, none where s vanishes."""
    U, s, V = np.linalg.svd(A, full_matrices=False)
    kept = s > SINGULAR
    factor = np.where(kept, s / np.where(kept, s**2 + damping, 1.0), 0.0)
    return np.asarray(V.T @ (factor * (U.T @ r)))
