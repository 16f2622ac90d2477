"""Shape integrals c1 .. c8 of the appendix, read from the moments of the fields X, Phi_1 .. Phi_N.

C4 and C5 are kept by their symmetric parts here: their antisymmetric parts are c6 and c7.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from derive.reduction.arithmetic import Array, total
from derive.reduction.mass import moments, weighted


@dataclass(frozen=True, eq=False)
class Integrals:
    """Integrals as in `ModalBody`, but S4 and S5 are the symmetric parts of C4 and C5."""

    mass: float
    c1: Array
    c2: Array
    C3: Array
    S4: Array
    S5: Array
    c6: Array
    c7: Array
    c8: Array


def integrals(mass: csr_array, x: Array, phi: Array) -> Integrals:
    """All integrals of a body with positions x (nodes, 3) and modes phi (N, nodes, 3)."""
    fields = np.concatenate([x[None], phi])
    first = np.array([total(field) for field in weighted(mass, fields)])
    second = moments(mass, fields)
    trace = second[..., 0, 0] + second[..., 1, 1] + second[..., 2, 2]
    tensor = trace[..., None, None] * np.eye(3) - (second + np.swapaxes(second, -1, -2)) / 2
    axial = np.stack([second[..., a, b] - second[..., b, a] for a, b in ((1, 2), (2, 0), (0, 1))], axis=-1)
    return Integrals(
        mass=float(total(mass.data)),
        c1=first[0],
        c2=first[1:],
        C3=tensor[0, 0],
        S4=tensor[1:, 0],
        S5=tensor[1:, 1:],
        c6=axial[0, 1:],
        c7=axial[1:, 1:],
        c8=trace[1:, 1:],
    )


def antisymmetric(axial: Array) -> Array:
    """Half of e_abk v_k of vectors v (..., 3): the antisymmetric part of C4 for v = c6, and of C5 for v = -c7."""
    result = np.zeros((*axial.shape[:-1], 3, 3))
    for a, b, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        result[..., a, b] = axial[..., k] / 2
        result[..., b, a] = -axial[..., k] / 2
    return result
