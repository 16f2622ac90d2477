"""The geometric stiffness of modes under the stresses of static displacements of a mesh."""

from __future__ import annotations

import numpy as np

from derive.solids.element_shapes import Array
from derive.solids.stresses import COMPONENTS, IntegratedMesh, element_points

MAX_PRODUCTS = 4_000_000
"""Products of gradients that are in memory at a time."""


def stress_work(solid: IntegratedMesh, displacements: Array, phi: Array) -> Array:
    """The matrices K0_ij = int sigma : (grad Phi_i^T grad Phi_j), (L, N, N), of modes phi (N, nodes, 3).

    sigma is the stress of each of the displacements (L, nodes, 3), m.
    """
    count, (first, second) = len(phi), np.triu_indices(len(phi))
    result = np.zeros((len(displacements), len(first)))
    for part in element_points(solid):
        stresses = part.stresses(displacements) * part.volumes[..., None]
        gradients = part.displacement_gradients(phi)
        size = max(MAX_PRODUCTS // (6 * len(first) * part.volumes.shape[1]), 1)
        for start in range(0, len(part.nodes), size):
            some = slice(start, start + size)
            products = np.einsum("iepmk,iepml->iepkl", gradients[first, some], gradients[second, some])
            both = products + products.swapaxes(-1, -2)
            rows = np.stack([both[..., k, j] / (2 if k == j else 1) for k, j in COMPONENTS], axis=-1)
            result += stresses[:, some].reshape(len(result), -1) @ rows.reshape(len(first), -1).T
    matrices = np.zeros((len(result), count, count))
    matrices[:, first, second] = matrices[:, second, first] = result
    return matrices
