"""Natural frequencies of a mechanism in a state, and the stability limit of explicit steps there."""

from __future__ import annotations

import numpy as np
from scipy.linalg import null_space, solve_triangular

from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import ConstrainedSystem, constraint_matrix, mass_matrix
from derive.simulation.configurations import displaced
from derive.simulation.constraints.scaling import in_mass_metric, mass_factor, typical_row_norms

RK4_LIMIT = float(np.sqrt(8.0))
"""The classical Runge-Kutta method is stable for an oscillation of omega rad/s up to this product of step and omega."""


def natural_frequencies(
    native: ConstrainedSystem, k: Vector, t: float, q: Vector, v: Vector, loaded: bool = True
) -> Vector:
    """Undamped natural frequencies (rad/s, ascending) of small motions about a consistent state (q, v) at t (s).

    They are those of M ddq + K dq = 0 with G dq = 0 and K = d/dq (M vdot + h - G^T lambda), at vdot and lambda of the
    state. loaded: if false, those at rest and without constraint reactions. A motion that grows, or that is
    unconstrained and has no stiffness, has 0.
    """
    return natural_modes(native, k, t, q, v, loaded)[0]


def natural_modes(
    native: ConstrainedSystem, k: Vector, t: float, q: Vector, v: Vector, loaded: bool = True
) -> tuple[Vector, Matrix]:
    """The frequencies (n,) of `natural_frequencies`, and the motions dq (nv, n) of the modes as columns."""
    R = mass_factor(mass_matrix(native, q, k))
    G = in_mass_metric(constraint_matrix(native, t, q, k), R)
    scaled = G / typical_row_norms(native, k, t, q, R)[:, None]
    allowed = null_space(scaled) if len(scaled) else np.eye(native.nv)
    motions = solve_triangular(R, allowed)  # columns of unit kinetic energy
    if not motions.size:
        return np.zeros(0), np.zeros((native.nv, 0))
    K = _stiffness(native, k, t, q, v if loaded else np.zeros(native.nv), motions, loaded)
    squares, shapes = np.linalg.eig(motions.T @ K)
    order = np.argsort(squares.real)
    return np.sqrt(np.maximum(squares.real[order], 0.0)), motions @ shapes.real[:, order]


def rk4_step_limit(native: ConstrainedSystem, k: Vector, t: float, q: Vector, v: Vector) -> float:
    """The step (s) above which the classical Runge-Kutta method is unstable in this state; infinite if none is."""
    highest = float(np.max(natural_frequencies(native, k, t, q, v), initial=0.0))
    return RK4_LIMIT / highest if highest > 0.0 else float("inf")


def _stiffness(
    native: ConstrainedSystem, k: Vector, t: float, q: Vector, v: Vector, motions: Matrix, loaded: bool
) -> Matrix:
    """Central differences of M vdot + h - G^T lambda along each column of `motions`."""
    vdot, lam = native.solve(t, q, v, k) if loaded else (np.zeros(native.nv), np.zeros(native.nlambda))

    def residual(q: Vector) -> Vector:
        inertia = mass_matrix(native, q, k) @ vdot
        reactions = constraint_matrix(native, t, q, k).T @ lam
        return np.asarray(inertia + native.force(t, q, v, k) - reactions)

    columns = []
    for motion in motions.T:
        step = 1e-6 * max(1e-3, float(np.max(np.abs(q)))) / float(np.max(np.abs(motion)))
        ahead, behind = (displaced(native, q, sign * step * motion) for sign in (1.0, -1.0))
        columns.append((residual(ahead) - residual(behind)) / (2 * step))
    return np.array(columns).T
