"""Consistent states around a given one: along free motions, with drives released, and a little earlier or later."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.linalg import null_space, solve_triangular

from derive.roles import Role
from derive.runtime.native_call import Vector
from derive.simulation.compiled_scene import (
    ConstrainedSystem,
    Mask,
    constraint_matrix,
    coordinates_with,
    mass_matrix,
    max_norm,
)
from derive.simulation.configurations import displaced, velocities_with
from derive.simulation.constraints.closest_state import changed, closest_state, damped_step
from derive.simulation.constraints.scaling import in_mass_metric, mass_factor, typical_row_norms

ANGLE = 0.05
"""rad: the rotation of bodies to the neighbouring states; of lengths, the part of the size of the mechanism."""
DIRECTIONS = 3
FIRST_DELAY, DOUBLINGS = 1e-6, 30
"""The first delay (s) after which the motion of drives is considered, and how often it is doubled to reach ANGLE."""


def neighbouring_states(
    native: ConstrainedSystem, k: Vector, t: float, q: Vector, drives: Sequence[str] = (), free: Mask | None = None
) -> Iterator[tuple[float, Vector]]:
    """A few pairs of time (s) and configuration (nq,) near a consistent configuration q (nq,).

    drives: names of multipliers whose constraints are released; the states meet all other constraints. free: mask (nv,)
    of the velocities that may change, all by default. The iterator yields q alone where the mechanism cannot move and
    its drives stand still.
    """
    free = np.ones(native.nv, dtype=bool) if free is None else free
    active = [i for i, name in enumerate(native.multipliers) if name not in drives]
    times = [time for sign in (1.0, -1.0) if (time := _time_of_motion(native, k, t, q, sign)) is not None]
    for direction in _directions(native, k, t, q, active, free):
        yield t, _projected(native, k, t, q, direction, active, free)
        for time in times:  # start next to q, because a dead centre itself has no continuation
            state = closest_state(native, k, time, displaced(native, q, direction), free)
            if state.converged:
                yield time, state.q


def driven_multipliers(native: ConstrainedSystem, k: Vector, t: float, q: Vector) -> tuple[str, ...]:
    """The names of the multipliers whose constraints change with time."""
    rates = native.constraint_rates(t, q, np.zeros(native.nv), k)
    return tuple(name for name, rate in zip(native.multipliers, rates, strict=True) if rate != 0.0)


def _directions(
    native: ConstrainedSystem, k: Vector, t: float, q: Vector, active: list[int], free: Mask
) -> Iterator[Vector]:
    """Small motions (nv,) that the active constraints allow to first order; zero alone if they allow none."""
    R = mass_factor(mass_matrix(native, q, k)[np.ix_(free, free)])
    G = in_mass_metric(constraint_matrix(native, t, q, k)[:, free], R)
    scaled = (G / typical_row_norms(native, k, t, q, R, free)[:, None])[active]
    allowed = null_space(scaled, rcond=1e-6) if len(scaled) else np.eye(int(np.sum(free)))
    random = np.random.default_rng(0)
    for _ in range(DIRECTIONS if allowed.size else 0):
        direction = np.zeros(native.nv)
        direction[free] = solve_triangular(R, allowed @ random.standard_normal(allowed.shape[1]))
        yield direction * _step_length(native, k, t, q, direction)
    if not allowed.size:
        yield np.zeros(native.nv)


def _projected(
    native: ConstrainedSystem, k: Vector, t: float, q: Vector, direction: Vector, active: list[int], free: Mask
) -> Vector:
    """The configuration next to q + direction with the same g of the active constraints as q."""
    R = mass_factor(mass_matrix(native, q, k)[np.ix_(free, free)])
    norms = typical_row_norms(native, k, t, q, R, free)[active]
    moved, target = displaced(native, q, direction), native.constraints(t, q, k)[active]
    for _ in range(20):
        g = native.constraints(t, moved, k)[active] - target
        if max_norm(g) < 1e-12 * max(1.0, max_norm(q)):
            break
        rows = constraint_matrix(native, t, moved, k)[active][:, free]
        A = in_mass_metric(rows, R) / norms[:, None]
        moved = changed(native, moved, free, solve_triangular(R, damped_step(A, -g / norms, 0.0)))
    return moved


def _time_of_motion(native: ConstrainedSystem, k: Vector, t: float, q: Vector, sign: float) -> float | None:
    """The time (s), after or before t, at which drives have moved the mechanism by ANGLE; None if they do not.

    It is None as well where functions of time, such as exp(-t) long before, exceed all numbers first.
    """
    now = native.constraints(t, q, k)
    for doubling in range(DOUBLINGS):
        time = t + sign * FIRST_DELAY * 2.0**doubling
        moved = native.constraints(time, q, k) - now
        if not np.all(np.isfinite(moved)):
            return None
        if max_norm(moved) >= ANGLE * _size(native, k, t, q):
            return time
    return None


def _step_length(native: ConstrainedSystem, k: Vector, t: float, q: Vector, direction: Vector) -> float:
    """The factor of a direction: until a body rotates by ANGLE, at most that part of the size of the mechanism."""
    angles = velocities_with(native, Role.ROTATION)
    rotation, shift = max_norm(direction[angles]), max_norm(direction[~angles])
    size = _size(native, k, t, q)
    return min(ANGLE / rotation if rotation > 0 else np.inf, size * ANGLE / shift if shift > 0 else np.inf)


def _size(native: ConstrainedSystem, k: Vector, t: float, q: Vector) -> float:
    """The size of a mechanism (m): the longest arm between the origin of a body and a point that a constraint holds.

    Where nothing rotates it is the largest displacement among the coordinates. Positions are no measure otherwise,
    because a mechanism may be far from the origin.
    """
    angles = velocities_with(native, Role.ROTATION)
    arm = max_norm(constraint_matrix(native, t, q, k)[:, angles])
    lengths = ~coordinates_with(native, Role.ROTATION, Role.QUATERNION)
    return max(arm if arm > 0 else max_norm(q[lengths]), 1e-3)
