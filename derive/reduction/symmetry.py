"""Mirror symmetry of a body: planes of reflection of its mass, and the parity of its modes under them.

Planes pass through the centre of mass and are normal to an axis of the data: a body that is symmetric in other
directions must be rotated first by the caller. Two nodes at the same position share a partner and hide a plane.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.spatial import KDTree

from derive.reduction.arithmetic import Array, eigh, product, symmetric
from derive.reduction.frames import Shapes, centred
from derive.reduction.mass import canonical, products
from derive.reduction.reasons import Parities

PLACE = 1e-8
"""Nodes are mirror images up to this part of the size of the body."""

EQUAL = 1e-8
"""Masses, and stiffnesses, are mirror images up to this part of the largest."""

CLEAR = 1e-6
"""A mode has a parity if what speaks against it is below this part of its largest displacement."""

CLOSE = 1e-6
"""Modes whose stiffnesses differ by less than this part may be mixed by whatever computed them."""


@dataclass(frozen=True, eq=False)
class Mirror:
    """Reflection along an axis: node i goes where node partner[i] is."""

    axis: int
    partner: NDArray[np.intp]

    def image(self, fields: Array) -> Array:
        """Fields (..., nodes, 3) reflected."""
        return np.asarray(fields[..., self.partner, :] * np.where(np.arange(3) == self.axis, -1.0, 1.0))


def mirrors(mass: csr_array, x: Array) -> tuple[Mirror, ...]:
    """The reflections along e1, e2, e3 through the centre of mass that leave the nodes and the mass as they are."""
    x = centred(mass, x)
    size = float(np.abs(x).max(initial=0.0))
    tree = KDTree(x)
    result = []
    for axis in range(3):
        distance, partner = tree.query(x * np.where(np.arange(3) == axis, -1.0, 1.0))
        if np.any(distance > PLACE * size) or len(np.unique(partner)) < len(x):
            continue
        if _permuted_alike(mass, np.asarray(partner)):
            result.append(Mirror(axis, np.asarray(partner)))
    return tuple(result)


def apart(mass: csr_array, phi: Array, values: Array, planes: tuple[Mirror, ...]) -> Array:
    """Orthonormal modes, those of equal stiffness combined so that each has a parity where that is possible."""
    result = phi.copy()
    scale = float(np.abs(values).max(initial=0.0))
    start = 0
    for end in range(1, len(phi) + 1):
        if end < len(phi) and values[end] - values[end - 1] <= CLOSE * max(abs(float(values[end])), CLOSE * scale):
            continue
        if end - start > 1 and planes:
            group = phi[start:end]
            # weights 1, 2, 4 give each combination of parities an eigenvalue of its own
            parity = sum(2.0**k * symmetric(products(mass, group, p.image(group))) for k, p in enumerate(planes))
            _, vectors = eigh(np.asarray(parity))
            result[start:end] = product(vectors, group)
        start = end
    return result


def with_parities(shapes: Shapes, planes: tuple[Mirror, ...], stiffness: csr_array | None) -> tuple[Shapes, Parities]:
    """Positions and modes made exactly symmetric where they nearly are, and their parities.

    X has a parity if O lies in the plane. The stiffness is symmetric if its matrix is, or, where that is not known,
    if it does not couple modes of different parity.
    """
    x, phi = shapes.x, shapes.phi.copy()
    fields = np.zeros((len(phi) + 1, len(planes)))
    for at, plane in enumerate(planes):
        image = plane.image(x)
        if np.abs(image - x).max(initial=0.0) <= PLACE * np.abs(x).max(initial=0.0):
            fields[0, at] = 1
            x = (x + image) / 2
        for i, mode in enumerate(phi):
            image = plane.image(mode)
            size = np.abs(mode).max(initial=0.0)
            for parity in (1, -1):
                if np.abs(image - parity * mode).max(initial=0.0) <= CLEAR * size:
                    fields[i + 1, at] = parity
                    phi[i] = (mode + parity * image) / 2
    elastic = tuple(
        _matrix_alike(stiffness, plane) if stiffness is not None else _uncoupled(shapes.stiffness, fields[1:, at])
        for at, plane in enumerate(planes)
    )
    return replace(shapes, x=x + 0.0, phi=phi + 0.0), Parities(tuple(p.axis for p in planes), fields, elastic)


def _uncoupled(stiffness: Array, parity: Array) -> bool:
    """Whether a modal stiffness leaves modes of different parity apart."""
    size = np.sqrt(np.abs(np.diag(stiffness)))
    odd = np.multiply.outer(parity, parity) < 0
    return bool(np.all(np.abs(stiffness[odd]) <= CLEAR * np.multiply.outer(size, size)[odd]))


def _matrix_alike(stiffness: csr_array, plane: Mirror) -> bool:
    """Whether a stiffness matrix is its own mirror image."""
    order = (3 * plane.partner[:, None] + np.arange(3)).ravel()
    signs = np.tile(np.where(np.arange(3) == plane.axis, -1.0, 1.0), len(plane.partner))
    return _permuted_alike(stiffness, order, signs)


def _permuted_alike(matrix: csr_array, order: NDArray[Any], signs: Array | None = None) -> bool:
    matrix = canonical(matrix)
    other = matrix[order][:, order]
    if signs is not None:
        other = other.multiply(signs[:, None]).multiply(signs[None, :])
    difference = csr_array(matrix - other)
    largest = float(np.abs(matrix.data).max(initial=0.0))
    return bool(np.abs(difference.data).max(initial=0.0) <= EQUAL * largest)
