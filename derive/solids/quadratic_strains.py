"""The loads of the stresses that the quadratic part of the strain of modes would cause in the elements of a mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from derive.solids.element_shapes import Array
from derive.solids.stresses import COMPONENTS, IntegratedMesh, element_points, hooke

MAX_PRODUCTS = 4_000_000
"""Products of gradients that are in memory at a time."""


def quadratic_loads(solid: IntegratedMesh, phi: Array, first: NDArray[np.intp], second: NDArray[np.intp]) -> Array:
    """The loads -int sigma_ij : grad v at nodes, (pairs, nodes, 3), of pairs of modes among phi (N, nodes, 3).

    sigma_ij is the stress, by the law of Hooke, of the strain sym(grad Phi_i^T grad Phi_j).
    """
    result = np.zeros((len(first), *solid.x.shape))
    for part in element_points(solid):
        gradients = part.displacement_gradients(phi)
        size = max(MAX_PRODUCTS // (9 * len(first) * part.volumes.shape[1]), 1)
        for start in range(0, len(part.nodes), size):
            some = slice(start, start + size)
            products = np.einsum("iepmk,iepml->iepkl", gradients[first, some], gradients[second, some])
            stresses = hooke(products, part.lame) * part.volumes[some, :, None]
            tensors = np.empty_like(products)
            for c, (k, j) in enumerate(COMPONENTS):
                tensors[..., k, j] = tensors[..., j, k] = stresses[..., c]
            loads = np.einsum("iepkl,epnl->enik", tensors, part.gradients[some], optimize=True)
            np.subtract.at(result.swapaxes(0, 1), part.nodes[some], loads)
    return result
