"""The stiffness and the mass of meshes of solid elements, for tests: what a finite-element program gives."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csr_array

from derive.solids.stresses import COMPONENTS, IntegratedMesh, element_points


def assembled(solid: IntegratedMesh) -> tuple[csr_array, csr_array]:
    """The consistent mass (nodes, nodes) and the stiffness (3 nodes, 3 nodes), with the points of elements.

    All elements have one density.
    """
    n = len(solid.x)
    rows, columns, values = [], [], []
    for part in element_points(solid):
        count = part.nodes.shape[1]
        strains = np.zeros((*part.gradients.shape[:2], 6, count, 3))
        for c, (i, j) in enumerate(COMPONENTS):
            strains[..., c, :, i] += part.gradients[..., j] / (1 + (i == j))
            strains[..., c, :, j] += part.gradients[..., i] / (1 + (i == j))
        b = strains.reshape(*strains.shape[:3], 3 * count)
        lam, mu = part.lame
        hooke = np.diag([2 * mu] * 3 + [mu] * 3)
        hooke[:3, :3] += lam
        k = np.einsum("ep,epca,cd,epdb->eab", part.volumes, b, hooke, b, optimize=True)
        places = (3 * part.nodes[:, :, None] + np.arange(3)).reshape(len(k), -1)
        rows.append(np.repeat(places, 3 * count, axis=1).ravel())
        columns.append(np.tile(places, (1, 3 * count)).ravel())
        values.append(k.ravel())
    entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    stiffness = csr_array(coo_array(entries, shape=(3 * n, 3 * n)).tocsr())
    return consistent_mass(solid), csr_array((stiffness + stiffness.T) / 2)


def consistent_mass(solid: IntegratedMesh) -> csr_array:
    """The matrix m of M = m (x) I3."""
    total = csr_array((len(solid.x), len(solid.x)))
    (density,) = {material.density for material in solid.mesh.materials.values()}
    assert density is not None
    for part in element_points(solid):
        m = np.einsum("ep,pa,pb->eab", density * part.volumes, part.shape.values, part.shape.values, optimize=True)
        count = part.nodes.shape[1]
        entries = (m.ravel(), (np.repeat(part.nodes, count, axis=1).ravel(), np.tile(part.nodes, (1, count)).ravel()))
        total = total + csr_array(coo_array(entries, shape=total.shape))
    return csr_array((total + total.T) / 2)
