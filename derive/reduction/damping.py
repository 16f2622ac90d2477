"""Viscous damping of a body: a part of critical in each mode, and a part proportional to mass and stiffness.

What is damped is the deformation, whatever the frame it is measured from. The modes of a free body are those of the
shapes without their rigid motion, so c8 below is that of the projected shapes: the same amplitudes then give the same
damping in every frame.
"""

from __future__ import annotations

import numpy as np

from derive.reduction.arithmetic import Array, cholesky, eigh, forward, product, symmetric
from derive.spec.model.body import Damping


def damping_matrix(damping: Damping, c8: Array, stiffness: Array) -> Array:
    """B = c8 V diag(2 ratio omega) V^T c8 + mass c8 + stiffness K; V are the modes of c8 and K, orthonormal in c8.

    `c8` is that of the shapes without their rigid motion.
    """
    result = float(damping.mass) * c8 + float(damping.stiffness) * stiffness
    if not damping.ratio:
        return np.asarray(result)
    lower = cholesky(c8)
    if lower is None:
        raise ValueError("modes are dependent")  # refused before, with their combination
    values, vectors = eigh(symmetric(forward(lower, forward(lower, stiffness).T)))
    rates = 2 * float(damping.ratio) * np.sqrt(np.maximum(values, 0.0))
    modal = product(lower, vectors.T)  # c8 V, since V = L^-T vectors^T
    return np.asarray(result + symmetric(product(modal * rates, modal.T)))
