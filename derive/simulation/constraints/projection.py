"""Projection onto g(t, q) = 0 and its rate: the smallest change of a state in the metric of the mass matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from derive.runtime.native_call import Vector
from derive.simulation.compiled_scene import ConstrainedSystem, max_norm
from derive.simulation.configurations import displaced, normalised
from derive.simulation.errors import DriftTooLarge

NEWTON_STEPS = 6
ROUNDING = 4e-16
UNAVOIDABLE = 2e-15
"""Constraints that are met to rounding errors are off by up to this part of the largest coordinate or velocity, since
they are differences of positions. It matters where a scene is far from the origin."""


@dataclass(frozen=True, eq=False)
class Drift:
    """The violation of the constraints in a state: the largest |g| (m, rad) and the largest |gdot| (m/s, rad/s)."""

    position: float
    velocity: float


def drift(native: ConstrainedSystem, k: Vector, t: float, q: Vector, v: Vector) -> Drift:
    """The drift of the state q (nq,), v (nv,) at t (s)."""
    return Drift(max_norm(native.constraints(t, q, k)), max_norm(native.constraint_rates(t, q, v, k)))


def project(native: ConstrainedSystem, k: Vector, t: float, q: Vector, v: Vector) -> tuple[Vector, Vector]:
    """The state (q, v) on its constraints, to rounding errors where Newton's method converges; quaternions of length 1.

    Raises ModelError where the constraints are singular. If the state is too far from the constraints,
    Newton's method does not converge and the result violates them: see `check_drift`.
    """
    q = normalised(native, q)
    g = native.constraints(t, q, k)
    for _ in range(NEWTON_STEPS):
        if max_norm(g) <= ROUNDING * max(1.0, max_norm(q)):
            break
        moved = displaced(native, q, native.project_velocity(t, q, k, -g))
        g_moved = native.constraints(t, moved, k)
        if not max_norm(g_moved) < max_norm(g):
            break
        stalled = max_norm(g_moved) > 0.1 * max_norm(g)  # rounding errors prevent further progress
        q, g = moved, g_moved
        if stalled:
            break
    return q, v + native.project_velocity(t, q, k, -native.constraint_rates(t, q, v, k))


def check_drift(native: ConstrainedSystem, k: Vector, t: float, q: Vector, v: Vector, tolerance: float) -> Drift:
    """The drift of a state.

    tolerance: the limit of |g| (m, rad) and |gdot| (m/s, rad/s), to which the rounding errors of q and v are added.
    Raises DriftTooLarge with the worst constraint.
    """
    for level, values, size in (
        ("position", native.constraints(t, q, k), max_norm(q)),
        ("rate", native.constraint_rates(t, q, v, k), max_norm(v)),
    ):
        limit = tolerance + (UNAVOIDABLE * size if size < np.inf else 0.0)
        if not max_norm(values) <= limit:
            worst = int(np.argmax(np.where(np.isfinite(values), np.abs(values), np.inf)))
            raise DriftTooLarge(t, level, native.multipliers[worst], float(abs(values[worst])), limit)
    return drift(native, k, t, q, v)
