"""States around one that a mechanism can reach: with what it is free to do, with its drives released, and in time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.linalg import null_space, solve_triangular

from derive.runtime.native import Vector
from derive.simulation.compiled_scene import Mechanism, constraint_matrix, mass_matrix
from derive.simulation.constraints.scaling import metric, per_speed, sizes
from derive.simulation.initial.closest_state import close, damped_step, largest

TURN = 0.05
"""rad: how far bodies turn to the states around; of lengths, the part of the size of the mechanism."""
TRIES = 3
SHORTEST, DOUBLINGS = 1e-6, 30
"""s: drives are followed for this time, or twice as long and so on, until they have moved something that far."""


def nearby(
    native: Mechanism, k: Vector, t: float, q: Vector, drives: Sequence[str] = ()
) -> Iterator[tuple[float, Vector]]:
    """A few (time, state) near a consistent state q (nq,) that meet the constraints, all but `drives` (multipliers).

    Only q again where a mechanism cannot move, and its drives do not.
    """
    kept = [i for i, name in enumerate(native.multipliers) if name not in drives]
    times = [later for sign in (1.0, -1.0) if (later := _later(native, k, t, q, sign)) is not None]
    everything = np.ones(native.nq, dtype=bool)
    for direction in _directions(native, k, t, q, kept):
        yield t, _returned(native, k, t, q, direction, kept)
        for later in times:  # from aside, since from a dead centre no way leads on
            found = close(native, k, later, q + direction, everything)
            if found.closed:
                yield later, found.q


def _directions(native: Mechanism, k: Vector, t: float, q: Vector, kept: list[int]) -> Iterator[Vector]:
    """Small motions (nq,) that the constraints `kept` allow to first order; one that is none if they allow none."""
    R = metric(mass_matrix(native, q, k))
    scaled = (per_speed(constraint_matrix(native, t, q, k), R) / sizes(native, k, t, q, R)[:, None])[kept]
    allowed = null_space(scaled, rcond=1e-6) if len(scaled) else np.eye(native.nv)
    random = np.random.default_rng(0)
    for _ in range(TRIES if allowed.size else 0):
        direction = solve_triangular(R, allowed @ random.standard_normal(allowed.shape[1]))
        yield direction * _length(native, q, direction)
    if not allowed.size:
        yield np.zeros(native.nq)


def _returned(native: Mechanism, k: Vector, t: float, q: Vector, direction: Vector, kept: list[int]) -> Vector:
    """The state next to q + direction that meets the constraints `kept` as q does; q again if there is no other."""
    R = metric(mass_matrix(native, q, k))
    lengths = sizes(native, k, t, q, R)[kept]
    moved, asked = q + direction, native.constraints(t, q, k)[kept]
    for _ in range(20):
        g = native.constraints(t, moved, k)[kept] - asked
        if largest(g) < 1e-12 * max(1.0, largest(q)):
            break
        rows = constraint_matrix(native, t, moved, k)[kept]
        A = per_speed(rows, R) / lengths[:, None]
        moved = moved + solve_triangular(R, damped_step(A, -g / lengths, 0.0))
    return moved


def _later(native: Mechanism, k: Vector, t: float, q: Vector, direction: float) -> float | None:
    """When drives will have moved, or had moved, by TURN; None if they stand still."""
    now = native.constraints(t, q, k)
    for doubling in range(DOUBLINGS):
        later = t + direction * SHORTEST * 2.0**doubling
        if largest(native.constraints(later, q, k) - now) >= TURN * _size(native, q):
            return later
    return None


def drives_of(native: Mechanism, k: Vector, t: float, q: Vector) -> tuple[str, ...]:
    """The multipliers of constraints that change with time."""
    rates = native.constraint_rates(t, q, np.zeros(native.nv), k)
    return tuple(name for name, rate in zip(native.multipliers, rates, strict=True) if rate != 0.0)


def _length(native: Mechanism, q: Vector, direction: Vector) -> float:
    """How far to go: until a body turns by TURN, but no further than that part of the size of the mechanism."""
    turns = np.array([name.endswith("phi") for name in native.coordinates])
    turn, shift = largest(direction[turns]), largest(direction[~turns])
    limits = (TURN / turn if turn > 0 else np.inf, _size(native, q) * TURN / shift if shift > 0 else np.inf)
    return min(limits)


def _size(native: Mechanism, q: Vector) -> float:
    """The size of a mechanism (m): how far bodies are from where coordinates count."""
    turns = np.array([name.endswith("phi") for name in native.coordinates])
    return max(largest(q[~turns]), 1e-3)
