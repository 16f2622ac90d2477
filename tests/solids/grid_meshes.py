"""Meshes of boxes with solid elements of each kind, in the node order of VTK."""

from __future__ import annotations

from itertools import product

import numpy as np

from derive.solids.element_shapes import element_shape
from derive.spec.model.mesh import ElementKind, Elements, Material, NodeMesh

STEEL = Material("steel", young=210e9, poisson=0.3, density=7800.0)

# the corners of the bricks of the grid, by which tetrahedra and wedges fill them
TETRAHEDRA = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))
WEDGES = ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7))
PARTS = {4: TETRAHEDRA, 6: WEDGES, 8: (tuple(range(8)),)}


def box_mesh(
    kind: ElementKind,
    sides: tuple[float, ...],
    counts: tuple[int, ...],
    crooked: float = 0.0,
    material: Material = STEEL,
) -> tuple[np.ndarray, NodeMesh]:
    """The nodes (n, 3) and the mesh of a box with its first corner in the origin.

    crooked: the largest displacement of corners inside the box, relative to a cell.
    """
    shape = element_shape(kind)
    grid = np.array(list(product(*(range(n + 1) for n in counts))), dtype=np.float64)
    places = {tuple(map(int, corner)): i for i, corner in enumerate(grid)}
    inside = np.all((grid > 0) & (grid < counts), axis=1)
    grid[inside] += crooked * np.random.default_rng(1).uniform(-1, 1, (int(inside.sum()), 3))
    corners = grid * np.array(sides) / np.array(counts)
    cube = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    cells = [[places[a + i, b + j, c + k] for i, j, k in cube] for a, b, c in product(*(range(n) for n in counts))]
    elements = np.array([[cell[i] for i in part] for cell in cells for part in PARTS[shape.corners]])
    linear = {4: ElementKind.TET4, 6: ElementKind.WEDGE6, 8: ElementKind.HEX8}[shape.corners]
    # nodes between corners are the means of these: the shape functions of the corners at the nodes
    weights = corner_functions(linear, shape.nodes)
    every = np.einsum("nc,eck->enk", weights, corners[elements])
    rounded = np.round(every.reshape(-1, 3), 9)
    x, index = np.unique(rounded, axis=0, return_inverse=True)
    nodes = index.reshape(len(elements), -1).astype(np.int64)
    return x, NodeMesh((Elements(kind, nodes, material.name),), {material.name: material})


def corner_functions(linear: ElementKind, places: np.ndarray) -> np.ndarray:
    """The shape functions (places, corners) of a kind without nodes on edges, at places in the element."""
    own = element_shape(linear).nodes
    if linear is ElementKind.TET4:
        return np.column_stack([1 - places.sum(axis=1), places])
    if linear is ElementKind.WEDGE6:
        triangle = np.column_stack([1 - places[:, :2].sum(axis=1), places[:, :2]])
        along = (1 + np.outer(places[:, 2], [-1, 1])) / 2
        return np.concatenate([triangle * along[:, :1], triangle * along[:, 1:]], axis=1)
    return np.asarray(np.prod(1 + places[:, None] * own[None], axis=2) / 8)
