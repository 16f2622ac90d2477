"""Mirror symmetry of a body: the mirror planes of its mass, and the parity of its modes under reflection.

Only planes through the centre of mass that are normal to an axis of the data are considered: the caller must rotate a
body that is symmetric in other directions. A plane is not detected if two nodes have the same position.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.spatial import KDTree

from derive.reduction.arithmetic import Array, eigh, matrix_product, symmetric_part
from derive.reduction.frames import ModeShapes, from_centre_of_mass
from derive.reduction.integrals import canonical_csr, mass_products
from derive.reduction.reasons import Parities

POSITION_TOLERANCE = 1e-8
"""The largest distance between a node and the mirror image of its partner, relative to the size of the body."""

MATRIX_TOLERANCE = 1e-8
"""The largest difference between a mass or stiffness matrix and its mirror image, relative to its largest entry."""

PARITY_TOLERANCE = 1e-6
"""The largest difference between a mode of definite parity and its mirror image, relative to its largest entry."""

DEGENERATE = 1e-6
"""Modes whose stiffnesses differ by less than this fraction count as degenerate: any combination of them is a mode."""


@dataclass(frozen=True, eq=False)
class Mirror:
    """A reflection along an axis (0 to 2) that maps node i to the position of node partner[i]."""

    axis: int
    partner: NDArray[np.intp]

    def image(self, fields: Array) -> Array:
        """The mirror images of fields (..., nodes, 3)."""
        return np.asarray(fields[..., self.partner, :] * np.where(np.arange(3) == self.axis, -1.0, 1.0))


def mirror_planes(mass: csr_array, x: Array) -> tuple[Mirror, ...]:
    """The reflections along e1, e2, e3 that leave the nodes x (nodes, 3) and the mass matrix unchanged."""
    x = from_centre_of_mass(mass, x)
    size = float(np.abs(x).max(initial=0.0))
    tree = KDTree(x)
    result = []
    for axis in range(3):
        distance, partner = tree.query(x * np.where(np.arange(3) == axis, -1.0, 1.0))
        if np.any(distance > POSITION_TOLERANCE * size) or len(np.unique(partner)) < len(x):
            continue
        if _invariant(mass, np.asarray(partner)):
            result.append(Mirror(axis, np.asarray(partner)))
    return tuple(result)


def separated_by_parity(mass: csr_array, phi: Array, values: Array, planes: tuple[Mirror, ...]) -> Array:
    """The modes, where degenerate ones are combined so that each has a definite parity, if that is possible.

    phi (N, nodes, 3): orthonormal modes. values (N,): their stiffnesses, ascending.
    """
    result = phi.copy()
    scale = float(np.abs(values).max(initial=0.0))
    start = 0
    for end in range(1, len(phi) + 1):
        if end < len(phi) and values[end] - values[end - 1] <= DEGENERATE * max(
            abs(float(values[end])), DEGENERATE * scale
        ):
            continue
        if end - start > 1 and planes:
            group = phi[start:end]
            # With weights 1, 2, 4 each combination of parities has a different eigenvalue.
            parity = sum(
                2.0**k * symmetric_part(mass_products(mass, group, p.image(group))) for k, p in enumerate(planes)
            )
            _, vectors = eigh(np.asarray(parity))
            result[start:end] = matrix_product(vectors, group)
        start = end
    return result


def made_symmetric(
    shapes: ModeShapes, planes: tuple[Mirror, ...], stiffness: csr_array | None
) -> tuple[ModeShapes, Parities]:
    """Positions and modes, made exactly symmetric if they are symmetric within the tolerances, and their parities.

    X has a parity if O lies in the plane. The stiffness counts as symmetric if its matrix is or, without a matrix, if
    it does not couple modes of different parity.
    """
    x, phi = shapes.x, shapes.phi.copy()
    fields = np.zeros((len(phi) + 1, len(planes)))
    for at, plane in enumerate(planes):
        image = plane.image(x)
        if np.abs(image - x).max(initial=0.0) <= POSITION_TOLERANCE * np.abs(x).max(initial=0.0):
            fields[0, at] = 1
            x = (x + image) / 2
        for i, mode in enumerate(phi):
            image = plane.image(mode)
            size = np.abs(mode).max(initial=0.0)
            for parity in (1, -1):
                if np.abs(image - parity * mode).max(initial=0.0) <= PARITY_TOLERANCE * size:
                    fields[i + 1, at] = parity
                    phi[i] = (mode + parity * image) / 2
    elastic = tuple(
        _symmetric_stiffness(stiffness, plane)
        if stiffness is not None
        else _uncoupled(shapes.stiffness, fields[1:, at])
        for at, plane in enumerate(planes)
    )
    return replace(shapes, x=x + 0.0, phi=phi + 0.0), Parities(tuple(p.axis for p in planes), fields, elastic)


def _uncoupled(stiffness: Array, parity: Array) -> bool:
    """Whether a modal stiffness does not couple modes of different parity."""
    size = np.sqrt(np.abs(np.diag(stiffness)))
    odd = np.multiply.outer(parity, parity) < 0
    return bool(np.all(np.abs(stiffness[odd]) <= PARITY_TOLERANCE * np.multiply.outer(size, size)[odd]))


def _symmetric_stiffness(stiffness: csr_array, plane: Mirror) -> bool:
    """Whether a stiffness matrix (3 nodes, 3 nodes) equals its mirror image."""
    order = (3 * plane.partner[:, None] + np.arange(3)).ravel()
    signs = np.tile(np.where(np.arange(3) == plane.axis, -1.0, 1.0), len(plane.partner))
    return _invariant(stiffness, order, signs)


def _invariant(matrix: csr_array, order: NDArray[Any], signs: Array | None = None) -> bool:
    """Whether a matrix equals itself after a permutation of rows and columns and a change of their signs."""
    matrix = canonical_csr(matrix)
    other = matrix[order][:, order]
    if signs is not None:
        other = other.multiply(signs[:, None]).multiply(signs[None, :])
    difference = csr_array(matrix - other)
    largest = float(np.abs(matrix.data).max(initial=0.0))
    return bool(np.abs(difference.data).max(initial=0.0) <= MATRIX_TOLERANCE * largest)
