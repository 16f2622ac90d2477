"""Modes of a lumped body brought to the mean frame, as plain arrays: (17), (19) and a centred reference."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array, diags_array

from derive.reduction.arithmetic import Array
from derive.reduction.checks import rigid_problems
from derive.reduction.frames import from_centre_of_mass, modes_in_frame, orthonormal_modes, rigid_fields
from derive.reduction.integrals import canonical_csr
from derive.reduction.residuals import departure
from derive.spec.model.body import BodyFrame

__all__ = ["residuals", "rigid_fields", "to_mean_frame"]


def to_mean_frame(
    masses: ArrayLike, positions: ArrayLike, modes: ArrayLike, stiffness: ArrayLike
) -> tuple[Array, Array, Array]:
    """Positions from the centre of mass, modes without rigid motion and orthonormal in the mass, and their stiffness.

    masses (nodes,); positions (nodes, 3); modes (N, nodes, 3); stiffness (N, N). Modes are combined so that c8 is the
    unit matrix and the stiffness diagonal, in ascending order; the strain energy stays as it is.

    Raises ValueError, with the combination, when a combination of the modes is a rigid motion.
    """
    m, x, phi, k = _arrays(masses), *(np.array(a, dtype=np.float64) for a in (positions, modes, stiffness))
    for problem in rigid_problems(m, from_centre_of_mass(m, x), phi):
        raise ValueError(problem.message)
    shapes = modes_in_frame(m, x, phi, k, BodyFrame("mean"))
    if not len(phi):
        return shapes.x, phi, k
    combined, values = orthonormal_modes(m, shapes.phi, k)
    return shapes.x, combined, np.diag(values)


def residuals(masses: ArrayLike, positions: ArrayLike, modes: ArrayLike) -> tuple[float, float]:
    """How far modes are from (17) and (19): the largest mean displacement and mean rotation, relative to the modes."""
    result = departure(_arrays(masses), np.array(positions, dtype=np.float64), np.array(modes, dtype=np.float64))
    return result.displacement, result.rotation


def _arrays(masses: ArrayLike) -> csr_array:
    return canonical_csr(csr_array(diags_array(np.array(masses, dtype=np.float64))))
