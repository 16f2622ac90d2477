"""The consistent state closest to a guess, all values of which may change: positions, then velocities.

`study` returns to the constraints with it. At the start of a simulation, `initial_state` keeps the values that the
scene gives.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_triangular

from derive.runtime.native_call import Vector
from derive.simulation.compiled_scene import (
    ConstrainedSystem,
    Mask,
    constraint_matrix,
    mass_matrix,
    max_norm,
)
from derive.simulation.constraints.closest_state import (
    CONSISTENT,
    PERTURBATIONS,
    RATES_CONSISTENT,
    ClosestState,
    closest_state,
    damped_step,
    perturbed,
    unmet_constraints,
)
from derive.simulation.constraints.redundancy import check_constraints
from derive.simulation.constraints.scaling import in_mass_metric, mass_factor, typical_row_norms
from derive.simulation.errors import InconsistentInitialState
from derive.simulation.initial.initial_state import InitialState


def closest_consistent_state(
    native: ConstrainedSystem, k: Vector, guess_q: Vector, guess_v: Vector, rigid: Mask, t: float = 0.0
) -> InitialState:
    """The consistent state at t (s) closest to a guess (nq,), (nv,), without change of deformations if possible.

    rigid: mask (nv,) of the velocities of rigid-body motion. They alone change, unless the constraints cannot be met
    so. The distance is measured by the mass matrix.

    Raises InconsistentInitialState with the constraints that cannot be met; RedundantConstraints, SingularConfiguration
    or MasslessMotion if accelerations and multipliers of the state are not unique.
    """
    guess_q, guess_v = np.array(guess_q, dtype=float), np.array(guess_v, dtype=float)
    closest, deformed = _positions(native, k, t, guess_q, rigid)
    v, deforming = _velocities(native, k, t, closest.q, guess_v, rigid)
    check_constraints(native, k, t, closest.q)
    error = max_norm(native.constraint_rates(t, closest.q, v, k))
    return InitialState(t, closest.q, v, closest.error, error, deformed, deforming)


def _positions(native: ConstrainedSystem, k: Vector, t: float, guess: Vector, rigid: Mask) -> tuple[ClosestState, bool]:
    """The closest configuration, and whether deformations had to change."""
    best: ClosestState | None = None
    for free in (rigid,) if np.all(rigid) else (rigid, np.ones_like(rigid)):
        for start in (guess, *(perturbed(native, guess, angle, rigid) for angle in PERTURBATIONS)):
            state = closest_state(native, k, t, start, free)
            if state.converged:
                return state, free is not rigid
            if best is None or state.error < best.error:
                best = state
    assert best is not None
    raise InconsistentInitialState("positions", unmet_constraints(native, best.g, CONSISTENT), t)


def _velocities(
    native: ConstrainedSystem, k: Vector, t: float, q: Vector, guess: Vector, rigid: Mask
) -> tuple[Vector, bool]:
    """The closest velocities, and whether rates of deformations had to change."""
    G, M = constraint_matrix(native, t, q, k), mass_matrix(native, q, k)
    v = guess
    for free in (rigid,) if np.all(rigid) else (rigid, np.ones_like(rigid)):
        R = mass_factor(M[np.ix_(free, free)])
        v = guess.copy()
        norms = typical_row_norms(native, k, t, q, R, free)
        scaled = in_mass_metric(G[:, free], R) / norms[:, None]
        for _ in range(2):  # the second time against rounding errors
            rates = native.constraint_rates(t, q, v, k) / norms
            v[free] += solve_triangular(R, damped_step(scaled, -rates, 0.0)) if G.size else 0.0
        if max_norm(native.constraint_rates(t, q, v, k)) <= RATES_CONSISTENT * max(1.0, max_norm(v)):
            return v, free is not rigid
    check_constraints(native, k, t, q)
    rates = native.constraint_rates(t, q, v, k)
    raise InconsistentInitialState("velocities", unmet_constraints(native, rates), t)
