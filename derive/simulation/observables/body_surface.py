"""The surface of a cloud of nodes, for drawings where the finite elements between them are not known."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, cKDTree

from derive.simulation.observables.motion import Array

NEIGHBOURS = 26
"""The number of nearest nodes to which edges are considered."""

CELL_DIAGONAL = 1.75
"""The longest edge of a cell relative to the longest edge between neighbours there: sqrt(3) in a cube."""

BENT = 0.5
"""The least cosine of the angle between two triangles that are one face."""

FLAT = 1e-9
"""The extent of a cloud in a direction, relative to its largest extent, in which it counts as flat."""

Edge = tuple[int, int]
Face = tuple[int, ...]


@dataclass(frozen=True)
class Surface:
    """The surface of a body by numbers of its nodes: faces with three or more corners, and edges of its cells."""

    faces: tuple[Face, ...]
    edges: tuple[Edge, ...]

    @property
    def nodes(self) -> list[int]:
        """The nodes that the surface has, ascending."""
        return sorted({node for part in (*self.faces, *self.edges) for node in part})


def surface(x: Array) -> Surface:
    """The surface of nodes x (n, 3), m: a hull that follows notches and holes wider than a cell.

    Nodes in a plane have a surface with one side; of nodes on a line there are edges alone.
    """
    edges = neighbours(x)
    triangles = _triangles(x, edges)
    faces = tuple(_quadrilaterals(x, triangles, set(edges)))
    if not faces:
        return Surface((), edges)
    shown = {edge for face in faces for edge in _sides(face)}
    return Surface(faces, tuple(edge for edge in edges if edge in shown))


def neighbours(x: Array) -> tuple[Edge, ...]:
    """The edges of the Gabriel graph of nodes (n, 3): pairs with no other node in the sphere between them, or on it.

    For a grid these are the edges of its cells. Only the nearest nodes are considered.
    """
    if len(x) < 2:
        return ()
    tree = cKDTree(x)
    distances, indices = tree.query(x, k=min(NEIGHBOURS + 1, len(x)))
    edges: list[Edge] = []
    for i, (lengths, others) in enumerate(zip(distances, indices, strict=True)):
        for length, j in zip(lengths, others, strict=True):
            if i < j and length and len(tree.query_ball_point((x[i] + x[j]) / 2, length / 2 * (1 + 1e-6))) == 2:
                edges.append((i, int(j)))
    return tuple(edges)


def _triangles(x: Array, edges: tuple[Edge, ...]) -> list[Face]:
    """The triangles around the cells of a Delaunay triangulation that are no longer than cells are."""
    values, directions = np.linalg.svd(x - x.mean(axis=0), full_matrices=False)[1:]
    extent = int((values > FLAT * values[0]).sum()) if len(x) > 2 and values[0] else 0
    if extent < 2:
        return []
    cells = Delaunay((x - x.mean(axis=0)) @ directions[:extent].T).simplices
    reach = np.zeros(len(x))
    for i, j in edges:
        length = np.linalg.norm(x[i] - x[j])
        reach[[i, j]] = np.maximum(reach[[i, j]], length)
    cells = cells[_longest(x, cells) <= CELL_DIAGONAL * reach[cells].max(axis=1)]
    if extent == 2:
        return [tuple(sorted(map(int, cell))) for cell in cells]
    count: dict[Face, int] = {}
    for cell in cells:
        for face in combinations(sorted(map(int, cell)), 3):
            count[face] = count.get(face, 0) + 1
    return [face for face, cells_beside in count.items() if cells_beside == 1]


def _longest(x: Array, cells: NDArray[np.int32]) -> Array:
    """The longest edges (cells,), m."""
    pairs = combinations(range(cells.shape[1]), 2)
    lengths: Array = np.max([np.linalg.norm(x[cells[:, i]] - x[cells[:, j]], axis=1) for i, j in pairs], axis=0)
    return lengths


def _quadrilaterals(x: Array, triangles: list[Face], edges: set[Edge]) -> list[Face]:
    """The triangles, of which those that share an edge that no cell has are one face with four corners, if it is flat
    enough."""
    by_diagonal: dict[Edge, list[int]] = {}
    for number, triangle in enumerate(triangles):
        for side in _sides(triangle):
            if side not in edges:
                by_diagonal.setdefault(side, []).append(number)
    joined: set[int] = set()
    faces: list[Face] = []
    for (i, j), pair in sorted(by_diagonal.items()):
        if len(pair) == 2 and not joined & set(pair):
            first, second = (next(node for node in triangles[number] if node not in (i, j)) for number in pair)
            if _is_flat(x, i, first, j, second):
                joined.update(pair)
                faces.append((i, first, j, second))
    return faces + [triangle for number, triangle in enumerate(triangles) if number not in joined]


def _is_flat(x: Array, i: int, first: int, j: int, second: int) -> bool:
    """Whether the triangles on both sides of the edge from i to j are nearly in one plane."""
    one, other = np.cross(x[j] - x[i], x[first] - x[i]), np.cross(x[second] - x[i], x[j] - x[i])
    return bool(one @ other >= BENT * np.linalg.norm(one) * np.linalg.norm(other))


def _sides(face: Face) -> list[Edge]:
    """The edges of a face, each with the smaller number first."""
    return [(min(pair), max(pair)) for pair in zip(face, (*face[1:], face[0]), strict=True)]
