"""Back onto g(t, q) = 0 and its rate: the smallest change of a state, in the metric of the mass."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from derive.runtime.native import Vector
from derive.simulation.compiled_scene import Mechanism
from derive.simulation.errors import DriftTooLarge
from derive.simulation.initial.closest_state import largest

NEWTON_STEPS = 6
ROUNDING = 4e-16


@dataclass(frozen=True, eq=False)
class Drift:
    """How far a state is from its constraints: the largest g (m, rad), the largest rate (m/s, rad/s)."""

    position: float
    velocity: float


def drift_of(native: Mechanism, k: Vector, t: float, q: Vector, v: Vector) -> Drift:
    """The drift of a state."""
    return Drift(largest(native.constraints(t, q, k)), largest(native.constraint_rates(t, q, v, k)))


def project(native: Mechanism, k: Vector, t: float, q: Vector, v: Vector) -> tuple[Vector, Vector]:
    """The state (q, v) on its constraints, to rounding errors where Newton's method gets there.

    Raises ModelError where the constraints are singular. A state that is too far off is left off: see `keep`.
    """
    g = native.constraints(t, q, k)
    for _ in range(NEWTON_STEPS):
        if largest(g) <= ROUNDING * max(1.0, largest(q)):
            break
        moved = q + native.project_velocity(t, q, k, -g)
        g_moved = native.constraints(t, moved, k)
        if not largest(g_moved) < largest(g):
            break
        done = largest(g_moved) > 0.1 * largest(g)  # rounding errors: no more to gain
        q, g = moved, g_moved
        if done:
            break
    return q, v + native.project_velocity(t, q, k, -native.constraint_rates(t, q, v, k))


def keep(native: Mechanism, k: Vector, t: float, q: Vector, v: Vector, tolerance: float) -> Drift:
    """The drift of a state; raises DriftTooLarge, with the constraint that is furthest off, if it is more than that."""
    for what, values in (("position", native.constraints(t, q, k)), ("rate", native.constraint_rates(t, q, v, k))):
        if not largest(values) <= tolerance:
            worst = int(np.argmax(np.where(np.isfinite(values), np.abs(values), np.inf)))
            raise DriftTooLarge(t, what, native.multipliers[worst], float(abs(values[worst])), tolerance)
    return drift_of(native, k, t, q, v)
