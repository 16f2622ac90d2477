"""Check of whether a deformation is about to make the mass matrix indefinite.

The kinetic energy of a beam of second order that is truncated is not positive at large deflections, unlike that of
other bodies, whose mass matrix is a Gram matrix. All velocities count, also those that constraints exclude: coordinates
are eliminated from the KKT matrix before the multipliers, and their pivots are safe as long as M is positive definite.
"""

from __future__ import annotations

import numpy as np

from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import ConstrainedSystem, coordinates_with, mass_matrix

ROUNDING = 1e-9
"""A body without mass has an eigenvalue of zero, up to rounding."""
BEYOND = 1.2
"""The factor of deflections up to which M must be definite, see `nearly_indefinite`: an integrator stops before M is
singular, since accelerations grow without bound there."""


def nearly_indefinite(native: ConstrainedSystem, k: Vector, q: Vector) -> bool:
    """Whether M is indefinite at q (nq,), or where deflections are a fifth larger."""
    deflected = coordinates_with(native, Role.AMPLITUDE)
    states = (np.where(deflected, factor * q, q) for factor in (1.0, BEYOND))
    return any(_smallest_eigenvalue(native, k, state) < -ROUNDING for state in states)


def _smallest_eigenvalue(native: ConstrainedSystem, k: Vector, q: Vector) -> float:
    """The smallest eigenvalue of M scaled by its diagonal; 1 if M is not finite."""
    M = mass_matrix(native, q, k)
    if not np.all(np.isfinite(M)):
        return 1.0
    size = np.sqrt(np.abs(np.diag(M)))
    scale = np.where(size > 0, size, 1.0)
    scaled: Matrix = M / np.outer(scale, scale)
    return float(np.linalg.eigvalsh(scaled)[0]) if scaled.size else 1.0
