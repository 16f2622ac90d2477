"""States around one, which a mechanism reaches when its drives move otherwise."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.linalg import null_space, solve_triangular

from derive.native import Vector
from derive.simulation.least_change import largest
from derive.simulation.mechanism import Mechanism, constraint_matrix, mass_matrix
from derive.simulation.scaling import metric, without_units

TURN = 0.05
"""rad: how far bodies turn to the states around."""
TRIES = 4


def nearby(native: Mechanism, k: Vector, t: float, q: Vector, drives: Sequence[str] | None = None) -> Iterator[Vector]:
    """A few states q (nq,) near a consistent one that meet all constraints but those of the drives.

    Drives are given by their multipliers; None: those constraints whose rate is not zero at rest.
    """
    kept = _joints(native, k, t, q, drives)
    R = metric(mass_matrix(native, q, k))
    scaled, lengths = without_units(constraint_matrix(native, t, q, k)[kept], R)
    allowed = null_space(scaled, rcond=1e-6) if len(scaled) else np.eye(native.nv)
    random = np.random.default_rng(0)
    for _ in range(TRIES if allowed.size else 0):
        direction = solve_triangular(R, allowed @ random.standard_normal(allowed.shape[1]))
        moved = q + _length(native, q, direction) * direction
        for _ in range(20):
            g = native.constraints(t, moved, k)[kept] - native.constraints(t, q, k)[kept]
            if largest(g) < 1e-12 * max(1.0, largest(q)):
                break
            rows = constraint_matrix(native, t, moved, k)[kept]
            A = solve_triangular(R, rows.T, trans="T").T / lengths[:, None]
            moved = moved - solve_triangular(R, np.linalg.pinv(A, rcond=1e-6) @ (g / lengths))
        if np.all(np.isfinite(moved)):
            yield moved


def drives_of(native: Mechanism, k: Vector, t: float, q: Vector) -> tuple[str, ...]:
    """The multipliers of constraints that change with time."""
    rates = native.constraint_rates(t, q, np.zeros(native.nv), k)
    return tuple(name for name, rate in zip(native.multipliers, rates, strict=True) if rate != 0.0)


def _joints(native: Mechanism, k: Vector, t: float, q: Vector, drives: Sequence[str] | None) -> list[int]:
    moving = drives_of(native, k, t, q) if drives is None else drives
    return [i for i, name in enumerate(native.multipliers) if name not in moving]


def _length(native: Mechanism, q: Vector, direction: Vector) -> float:
    """How far to go: until a body turns by TURN, but no further than a part of the size of the mechanism."""
    turns = np.array(["phi" in name for name in native.coordinates])
    turn, shift = largest(direction[turns]), largest(direction[~turns])
    size = max(largest(q[~turns]), 1e-3)
    return min(TURN / turn if turn > 0 else np.inf, size * TURN / shift if shift > 0 else np.inf)
