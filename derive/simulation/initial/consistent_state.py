"""Consistent initialisation: the state next to an initial guess that meets the constraints and their rates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular

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
from derive.simulation.constraints.closest_state import CONSISTENT, ClosestState, closest_state, damped_step
from derive.simulation.constraints.redundancy import check_constraints
from derive.simulation.constraints.scaling import in_mass_metric, mass_factor, typical_row_norms
from derive.simulation.equilibrium import Equilibrium
from derive.simulation.errors import InconsistentInitialState
from derive.simulation.initial.contradictions import InitialValue

RATES_CONSISTENT = 1e-9
"""Constraints on velocities with |gdot| below this (m/s, rad/s; times the largest |v| if above 1) are met."""
PERTURBATIONS = (0.05, 0.2, 0.5)
"""Perturbations (rad) of a guess from which the iteration does not converge, such as bars that lie in one line."""


@dataclass(frozen=True, eq=False)
class InitialState:
    """A consistent state: q (nq,) and v (nv,) at t (s), in SI units.

    position_error, velocity_error: the largest |g| (m, rad) and |gdot| (m/s, rad/s). deformed, deforming: whether
    deformations, or their rates, had to change from those of the guess. values: what the specification gives, and what
    the state has. equilibrium: the static equilibrium that the state is, if it is one.
    """

    t: float
    q: Vector
    v: Vector
    position_error: float
    velocity_error: float
    deformed: bool
    deforming: bool
    values: tuple[InitialValue, ...] = ()
    equilibrium: Equilibrium | None = None

    @property
    def corrections(self) -> tuple[InitialValue, ...]:
        """The given values that the state does not have."""
        return tuple(value for value in self.values if value.corrected)

    @property
    def notes(self) -> tuple[str, ...]:
        """A line on each given value that is changed, and on the equilibrium, for a user to read."""
        reason = (
            "its value in equilibrium" if self.equilibrium else "corrected: it contradicts the joints or other values"
        )
        balance = (str(self.equilibrium),) if self.equilibrium else ()
        return (*balance, *(f"{value} ({reason})" for value in self.corrections))


def consistent_state(
    native: ConstrainedSystem, k: Vector, guess_q: Vector, guess_v: Vector, rigid: Mask, t: float = 0.0
) -> InitialState:
    """The consistent state at t (s) closest to a guess (nq,), (nv,), without change of deformations if possible.

    rigid: mask (nq,) of the coordinates of rigid-body motion. They alone change, unless the constraints cannot be met
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


def perturbed(native: ConstrainedSystem, guess: Vector, angle: float, rigid: Mask) -> Vector:
    """The guess with each rotation changed by up to `angle` (rad), the same each time; positions follow."""
    angles = coordinates_with(native, Role.ROTATION) & rigid
    numbers = np.random.default_rng(0).uniform(-1.0, 1.0, len(guess))
    return np.asarray(guess + angle * np.where(angles, numbers, 0.0))


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


def unmet_constraints(native: ConstrainedSystem, values: Vector, met: float = 0.0) -> list[tuple[str, float]]:
    """The names of constraints whose values (nlambda,) are not small beside the largest, with these values.

    met: values up to this count as zero.
    """
    limit = max(met, 1e-3 * max_norm(values))
    return [(name, float(x)) for name, x in zip(native.multipliers, values, strict=True) if not abs(x) <= limit]
