"""The area of a set of nodes: integrals over the faces of elements of which it has all nodes.

A face has the shape functions of its element there. Its area is shared by products of these, as a consistent mass is:
lumped weights of quadratic faces are zero or negative at corners, and do not integrate moments of the displacements.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from derive.solids.element_shapes import Array, element_shape, shape_functions
from derive.spec.model.mesh import ElementKind, Elements

GAUSS = 4
"""The points of integration along each side of a face, which integrate products of two shape functions exactly."""


@dataclass(frozen=True, eq=False)
class FaceTable:
    """A face of a kind of element: its nodes in the element, their values (P, nodes), gradients (P, nodes, 2) with
    respect to the coordinates of the face, and the weights (P,) of the points."""

    corners: tuple[int, ...]
    nodes: tuple[int, ...]
    values: Array
    gradients: Array
    weights: Array


def area_products(elements: tuple[Elements, ...], x: Array, nodes: tuple[int, ...]) -> Array | None:
    """The integrals (nodes, nodes) of products of shape functions over the faces of a set, m^2; x: of all nodes.

    None where some node of the set has no face: the set is then no part of the surface.
    """
    own = np.array(nodes)
    place = np.full(len(x), -1)
    place[own] = np.arange(len(own))
    result = np.zeros((len(own), len(own)))
    covered = np.zeros(len(own), dtype=bool)
    for face, rows in _faces_of_set(elements, place):
        products = _products(face, x[rows])
        at = place[rows]
        np.add.at(result, (at[:, :, None], at[:, None, :]), products)
        covered[at] = True
    return result if covered.all() else None


def _products(face: FaceTable, x: Array) -> Array:
    """The integrals (faces, nodes, nodes) over faces with nodes at x (faces, nodes, 3)."""
    tangents = np.einsum("pac,fak->fpck", face.gradients, x)
    area = np.linalg.norm(np.cross(tangents[:, :, 0], tangents[:, :, 1]), axis=-1) * face.weights
    return np.asarray(np.einsum("fp,pa,pb->fab", area, face.values, face.values))


def _faces_of_set(
    elements: tuple[Elements, ...], place: NDArray[np.int64]
) -> Iterator[tuple[FaceTable, NDArray[np.int64]]]:
    """Yield the faces of one element alone whose nodes are all in the set, with their nodes (faces, nodes)."""
    candidates = []
    for block in elements:
        for face in face_tables(block.kind):
            rows = block.nodes[:, list(face.nodes)]
            rows = rows[(place[rows] >= 0).all(axis=1)]
            if len(rows):
                candidates.append((face, rows))
    seen: dict[tuple[int, ...], int] = {}
    keys = [[tuple(sorted(row)) for row in rows[:, : len(face.corners)].tolist()] for face, rows in candidates]
    for key in (key for own in keys for key in own):
        seen[key] = seen.get(key, 0) + 1
    for (face, rows), own in zip(candidates, keys, strict=True):
        alone = np.array([seen[key] == 1 for key in own])
        if alone.any():
            yield face, rows[alone]


@cache
def face_tables(kind: ElementKind) -> tuple[FaceTable, ...]:
    """The faces of a kind of element, with corners as their first nodes."""
    shape = element_shape(kind)
    result = []
    for corners in shape.faces:
        at, along, weights = _points(shape.nodes[list(corners)])
        values = shape_functions(kind, at)
        gradients = np.stack([shape_functions(kind, at, axis) for axis in range(3)], axis=-1)
        others = np.flatnonzero(np.abs(values).max(axis=0) > 1e-12)
        nodes = (*corners, *(int(node) for node in others if node not in corners))
        own = list(nodes)
        result.append(
            FaceTable(corners, nodes, values[:, own], np.einsum("pak,pck->pac", gradients[:, own], along), weights)
        )
    return tuple(result)


def _points(corners: Array) -> tuple[Array, Array, Array]:
    """Points (P, 3) of a face, the derivatives (P, 2, 3) along its coordinates, and weights (P,)."""
    roots, weights = np.polynomial.legendre.leggauss(GAUSS)
    s, t = (grid.ravel() for grid in np.meshgrid((1 + roots) / 2, (1 + roots) / 2, indexing="ij"))
    both = np.outer(weights, weights).ravel() / 4
    if len(corners) == 3:  # the square with one side drawn together
        s, both = s * (1 - t), both * (1 - t)
        sides = np.array([corners[1] - corners[0], corners[2] - corners[0]])
        return corners[0] + np.stack([s, t], axis=1) @ sides, np.tile(sides, (len(s), 1, 1)), both
    factors = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t], axis=1)
    along_s = np.stack([t - 1, 1 - t, t, -t], axis=1)
    along_t = np.stack([s - 1, -s, s, 1 - s], axis=1)
    return factors @ corners, np.stack([along_s @ corners, along_t @ corners], axis=1), both
