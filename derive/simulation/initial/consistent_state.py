"""A state that a motion can start from: next to the guess, it meets constraints and their rates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular

from derive.runtime.native import Vector
from derive.simulation.compiled_scene import Mechanism, constraint_matrix, mass_matrix
from derive.simulation.constraints.redundancy import check
from derive.simulation.constraints.scaling import Mask, metric, per_speed, sizes
from derive.simulation.errors import InconsistentStart
from derive.simulation.initial.closest_state import CLOSED, Closure, close, damped_step, largest

RATES_MET = 1e-9
"""Rates of constraints that are off by less than this (m/s, rad/s; times the largest rate if above 1) are met."""
SHAKES = (0.05, 0.2, 0.5)
"""rad: how far a guess is shaken when no state is found from it as it stands (bars that lie in one line, say)."""


@dataclass(frozen=True, eq=False)
class Start:
    """q (nq,) and v (nv,) that meet the constraints at t, to the largest g and its rate that are left.

    `deformed`, `deforming`: whether deformations, or their rates, had to change from those of the guess.
    """

    t: float
    q: Vector
    v: Vector
    position_error: float
    velocity_error: float
    deformed: bool
    deforming: bool


def consistent(native: Mechanism, k: Vector, guess_q: Vector, guess_v: Vector, rigid: Mask, t: float = 0.0) -> Start:
    """The consistent state next to a guess, at rest in its deformations if that is possible.

    `rigid` (nq,) marks the coordinates that are no deformation: they alone change, unless the constraints cannot be met
    so. Raises InconsistentStart with what cannot be met; RedundantConstraints, SingularConfiguration or
    MasslessMotion if accelerations and multipliers of the state have no unique value.
    """
    guess_q, guess_v = np.array(guess_q, dtype=float), np.array(guess_v, dtype=float)
    closure, deformed = _positions(native, k, t, guess_q, rigid)
    v, deforming = _velocities(native, k, t, closure.q, guess_v, rigid)
    check(native, k, t, closure.q)
    error = largest(native.constraint_rates(t, closure.q, v, k))
    return Start(t, closure.q, v, closure.error, error, deformed, deforming)


def _positions(native: Mechanism, k: Vector, t: float, guess: Vector, rigid: Mask) -> tuple[Closure, bool]:
    best: Closure | None = None
    for free in (rigid,) if np.all(rigid) else (rigid, np.ones_like(rigid)):
        for start in (guess, *(_shaken(native, guess, angle, rigid) for angle in SHAKES)):
            found = close(native, k, t, start, free)
            if found.closed:
                return found, free is not rigid
            if best is None or found.error < best.error:
                best = found
    assert best is not None
    limit = max(CLOSED, 1e-3 * best.error)
    raise InconsistentStart("positions", _unmet(native, best.g, limit), t)


def _shaken(native: Mechanism, guess: Vector, angle: float, rigid: Mask) -> Vector:
    """The guess with each rotation changed by about `angle`, and the same each time; positions follow by themselves."""
    turns = np.array([name.endswith("phi") for name in native.coordinates]) & rigid
    numbers = np.random.default_rng(0).uniform(-1.0, 1.0, len(guess))
    return np.asarray(guess + angle * np.where(turns, numbers, 0.0))


def _velocities(native: Mechanism, k: Vector, t: float, q: Vector, guess: Vector, rigid: Mask) -> tuple[Vector, bool]:
    G, M = constraint_matrix(native, t, q, k), mass_matrix(native, q, k)
    v = guess
    for free in (rigid,) if np.all(rigid) else (rigid, np.ones_like(rigid)):
        R = metric(M[np.ix_(free, free)])
        v = guess.copy()
        lengths = sizes(native, k, t, q, R, free)
        scaled = per_speed(G[:, free], R) / lengths[:, None]
        for _ in range(2):  # the second time against rounding errors
            missing = native.constraint_rates(t, q, v, k) / lengths
            v[free] += solve_triangular(R, damped_step(scaled, -missing, 0.0)) if G.size else 0.0
        if largest(native.constraint_rates(t, q, v, k)) <= RATES_MET * max(1.0, largest(v)):
            return v, free is not rigid
    check(native, k, t, q)
    left = native.constraint_rates(t, q, v, k)
    raise InconsistentStart("velocities", _unmet(native, left, 1e-3 * largest(left)), t)


def _unmet(native: Mechanism, left: Vector, limit: float) -> list[tuple[str, float]]:
    return [(name, float(x)) for name, x in zip(native.multipliers, left, strict=True) if not abs(x) <= limit]
