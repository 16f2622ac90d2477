"""Check of whether a deformation is about to make the mass matrix indefinite.

The kinetic energy of a beam of second order that is truncated is not positive at large deflections, unlike that of
other bodies, whose mass matrix is a Gram matrix. All velocities count, also those that constraints exclude: coordinates
are eliminated from the KKT matrix before the multipliers, and their pivots are safe as long as M is positive definite.
"""

from __future__ import annotations

import numpy as np

from derive.roles import Role
from derive.runtime.native_call import Vector
from derive.simulation.compiled_scene import ConstrainedSystem, coordinates_with, mass_matrix
from derive.simulation.free_body import flexible_body

ROUNDING = 1e-9
"""A body without mass has an eigenvalue of zero, up to rounding."""
BEYOND = 1.2
"""The factor of deflections up to which M must be definite, see `nearly_indefinite`: an integrator stops before M is
singular, since accelerations grow without bound there."""


def nearly_indefinite(native: ConstrainedSystem, k: Vector, q: Vector) -> bool:
    """Whether M is indefinite at q (nq,), or where deflections are a fifth larger."""
    states = (_deflected(native, q, factor) for factor in (1.0, BEYOND))
    return any(_least_inertia(native, k, state)[0] < -ROUNDING for state in states)


def lost_inertia_of(native: ConstrainedSystem, k: Vector, q: Vector) -> tuple[str, float]:
    """The body that takes part most in the velocity with the least inertia where deflections are a fifth larger.

    The number is the inertia of this velocity in the undeformed state, relative to that of its components alone.
    """
    _, velocity = _least_inertia(native, k, _deflected(native, q, BEYOND))
    M = mass_matrix(native, _deflected(native, q, 0.0), k)
    components = velocity**2 * np.diag(M)
    bodies = {name: flexible_body(name, native) for name in native.bodies}
    parts = {name: components[of.rigid.start : of.rates.stop].sum() for name, of in bodies.items() if of}
    body = max(parts, key=lambda name: float(parts[name]), default="a body")
    return body, float(velocity @ M @ velocity / components.sum())


def _deflected(native: ConstrainedSystem, q: Vector, factor: float) -> Vector:
    """The state q (nq,) with its deflections times a factor."""
    return np.where(coordinates_with(native, Role.AMPLITUDE), factor * q, q)


def _least_inertia(native: ConstrainedSystem, k: Vector, q: Vector) -> tuple[float, Vector]:
    """The smallest eigenvalue of M scaled by its diagonal, and its velocity (nv,); 1 if M is not finite."""
    M = mass_matrix(native, q, k)
    if not np.all(np.isfinite(M)) or not M.size:
        return 1.0, np.zeros(len(M))
    size = np.sqrt(np.abs(np.diag(M)))
    scale = np.where(size > 0, size, 1.0)
    values, velocities = np.linalg.eigh(M / np.outer(scale, scale))
    return float(values[0]), velocities[:, 0] / scale
