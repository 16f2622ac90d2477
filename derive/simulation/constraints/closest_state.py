"""The closest consistent state: the configuration next to a guess with g(t, q) = 0, by damped Newton steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular

from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import (
    ConstrainedSystem,
    Constraints,
    Mask,
    constraint_matrix,
    mass_matrix,
    max_norm,
)
from derive.simulation.configurations import displaced, velocities_with
from derive.simulation.constraints.scaling import SINGULAR, in_mass_metric, mass_factor, typical_row_norms

CONSISTENT = 1e-11
"""Constraints with |g| below this (m, rad; times the largest coordinate if that is above 1) are met."""
RATES_CONSISTENT = 1e-9
"""Constraints on velocities with |gdot| below this (m/s, rad/s; times the largest |v| if above 1) are met."""
PERTURBATIONS = (0.05, 0.2, 0.5)
"""Perturbations (rad) of a guess from which the iteration does not converge, such as bars that lie in one line."""
ITERATIONS = 100
LARGEST_ROTATION = 1.0
"""rad: the largest rotation in a step that does not nearly meet the constraints, so that bodies do not wind around."""


@dataclass(frozen=True)
class ClosestState:
    """The result of an iteration: the configuration q (nq,), and g (nlambda,) there."""

    q: Vector
    g: Vector

    @property
    def error(self) -> float:
        """The largest |g| (m, rad)."""
        return max_norm(self.g)

    @property
    def converged(self) -> bool:
        """Whether the constraints are met."""
        return self.error <= CONSISTENT * max(1.0, max_norm(self.q))


def closest_state(
    native: Constraints, k: Vector, t: float, guess: Vector, free: Mask, norms: Vector | None = None
) -> ClosestState:
    """The configuration next to `guess` (nq,) that meets the constraints to rounding errors, if there is one.

    free: mask (nv,) of the velocities whose coordinates may change. norms: `typical_row_norms`, if they are known. The
    method is a Levenberg-Marquardt iteration in the metric of the mass matrix; near the solution its steps are Newton
    steps of least norm. It stops when the violation no longer decreases; `ClosestState.converged` tells whether the
    constraints are met then.
    """
    R = mass_factor(mass_matrix(native, guess, k)[np.ix_(free, free)])
    q, g = guess.copy(), native.constraints(t, guess, k)
    G = constraint_matrix(native, t, q, k)[:, free]
    if norms is None:
        norms = typical_row_norms(native, k, t, guess, R, free)
    angles = velocities_with(native, Role.ROTATION)[free]
    damping = 0.0
    for _ in range(ITERATIONS):
        if not g.size or max_norm(g) == 0.0 or not np.isfinite(damping):
            break
        A = in_mass_metric(G, R) / norms[:, None]
        step = solve_triangular(R, damped_step(A, -g / norms, damping))
        trial = changed(native, q, free, step)
        g_trial = native.constraints(t, trial, k)
        before, after = np.linalg.norm(g / norms), np.linalg.norm(g_trial / norms)
        rotation = max_norm(step[angles])
        if rotation > LARGEST_ROTATION and not after < 0.01 * before:
            trial = changed(native, q, free, step * (LARGEST_ROTATION / rotation))
            g_trial = native.constraints(t, trial, k)
            after = np.linalg.norm(g_trial / norms)
        if after < before:  # also false for NaN
            q, g, G = trial, g_trial, constraint_matrix(native, t, trial, k)[:, free]
            damping = 0.0 if after < 0.5 * before else damping / 4
            if after > (1 - 1e-9) * before:
                break
        elif max_norm(g) <= CONSISTENT * max(1.0, max_norm(q)):
            break
        else:
            damping = max(8 * damping, 1e-6)
            if damping > 1e6:
                break
    return ClosestState(q, g)


def damped_step(A: Matrix, r: Vector, damping: float) -> Vector:
    """The least-norm x (n,) of A x = r for A (m, n), each singular value s damped to s^2 + damping; s = 0 dropped."""
    U, s, V = np.linalg.svd(A, full_matrices=False)
    nonzero = s > SINGULAR
    factor = np.where(nonzero, s / np.where(nonzero, s**2 + damping, 1.0), 0.0)
    return np.asarray(V.T @ (factor * (U.T @ r)))


def perturbed(native: ConstrainedSystem, guess: Vector, angle: float, rigid: Mask) -> Vector:
    """The guess with each rotation changed by up to `angle` (rad), the same each time; positions follow."""
    angles = velocities_with(native, Role.ROTATION) & rigid
    numbers = np.random.default_rng(0).uniform(-1.0, 1.0, native.nv)
    return displaced(native, guess, angle * np.where(angles, numbers, 0.0))


def changed(native: Constraints, q: Vector, free: Mask, step: Vector) -> Vector:
    """The configuration q (nq,) after a change of those that are `free` (nv,), a step of as many elements."""
    change = np.zeros(native.nv)
    change[free] = step
    return displaced(native, q, change)


def unmet_constraints(native: ConstrainedSystem, values: Vector, met: float = 0.0) -> list[tuple[str, float]]:
    """The names of constraints whose values (nlambda,) are not small beside the largest, with these values.

    met: values up to this count as zero.
    """
    limit = max(met, 1e-3 * max_norm(values))
    return [(name, float(x)) for name, x in zip(native.multipliers, values, strict=True) if not abs(x) <= limit]
