"""Modes of a lumped body brought to the mean frame: (17), (19) and a centred reference, for any given modes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from derive.reduction.rigid import rigid_fields

Array = NDArray[np.float64]

DEPENDENT = 1e-9
"""Modes whose part without rigid motion has a singular value below this part of the largest are dependent."""


def to_mean_frame(
    masses: ArrayLike, positions: ArrayLike, modes: ArrayLike, stiffness: ArrayLike
) -> tuple[Array, Array, Array]:
    """Positions from the centre of mass, modes without rigid motion and orthonormal in the mass, and their stiffness.

    masses (nodes,); positions (nodes, 3); modes (N, nodes, 3); stiffness (N, N). The rigid part of each mode is taken
    out, P = C - R (R^T M R)^-1 R^T M C with R the six rigid fields, which leaves the strain energy as it is; then modes
    are combined so that c8 is the unit matrix and the stiffness diagonal, in ascending order.

    Raises ValueError, with the combination, when a combination of the modes is a rigid motion.
    """
    m, x, phi, k = (np.asarray(a, dtype=np.float64) for a in (masses, positions, modes, stiffness))
    x = x - m @ x / m.sum()
    weight = np.repeat(m, 3)
    rigid = rigid_fields(x).reshape(6, -1)
    if not len(phi):
        return x, phi, k
    fields = phi.reshape(len(phi), -1)
    projected = fields - (fields * weight) @ rigid.T @ np.linalg.pinv((rigid * weight) @ rigid.T) @ rigid
    gram = (projected * weight) @ projected.T
    _refuse_rigid(gram, (fields * weight) @ fields.T)
    root = np.linalg.cholesky(gram)
    values, vectors = np.linalg.eigh(np.linalg.solve(root, np.linalg.solve(root, k).T))
    combination = np.linalg.solve(root.T, vectors).T
    return x, (combination @ projected).reshape(phi.shape), np.diag(values)


def residuals(masses: ArrayLike, positions: ArrayLike, modes: ArrayLike) -> tuple[float, float]:
    """How far modes are from (17) and (19): the largest mean displacement and mean rotation, relative to the modes."""
    m, x, phi = (np.asarray(a, dtype=np.float64) for a in (masses, positions, modes))
    size = np.sqrt(np.einsum("n,ink,ink->i", m, phi, phi).max(initial=np.finfo(float).tiny))
    reach = np.sqrt(np.einsum("n,nk,nk->", m, x, x))
    mean = np.abs(np.einsum("n,ink->ik", m, phi)).max(initial=0.0) / (size * np.sqrt(m.sum()))
    turn = np.abs(np.einsum("n,ink->ik", m, np.cross(x, phi))).max(initial=0.0) / (size * reach)
    return float(mean), float(turn)


def _refuse_rigid(gram: Array, before: Array) -> None:
    """Compare what is left of the modes with what they were."""
    scale = 1 / np.sqrt(np.diag(before))
    values, vectors = np.linalg.eigh(gram * np.outer(scale, scale))
    if values[0] > DEPENDENT**2:
        return
    weights = vectors[:, 0] * scale
    weights /= np.abs(weights).max()
    parts = [f"{w:+.3g} mode {i}" for i, w in enumerate(weights, 1) if abs(w) > 1e-6]
    raise ValueError(f"rigid motion is left in the modes, or they are dependent: {' '.join(parts)}; take one out")
