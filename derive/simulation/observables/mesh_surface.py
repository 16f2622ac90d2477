"""The surface of a mesh of solid elements: the faces that belong to one element alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from derive.simulation.observables.body_surface import Edge, Face, Surface
from derive.simulation.observables.motion import Array
from derive.solids.element_shapes import element_shape
from derive.spec.model.mesh import Elements


def mesh_surface(elements: tuple[Elements, ...], middles: bool = True) -> Surface:
    """The surface of a mesh, whose faces have the nodes in the middles of edges between their corners, if wanted."""
    faces: list[Face] = []
    edges: set[Edge] = set()
    for corners, between in boundary_faces(elements):
        for face, own in zip(corners.tolist(), between.tolist(), strict=True):
            pairs = zip(face, own, strict=True)
            ring = [node for pair in pairs for node in pair] if middles and own[0] >= 0 else face
            faces.append(tuple(ring))
            edges.update((min(side), max(side)) for side in zip(ring, [*ring[1:], ring[0]], strict=True))
    return Surface(tuple(faces), tuple(sorted(edges)))


def coarsened(shown: Surface, x: Array, most: int) -> Surface:
    """A surface with at most so many nodes: of the nodes in a cell of a grid one is left, the nearest to their mean.

    x (n, 3): the places of all nodes. Faces that lose their corners are left out.
    """
    nodes = np.array(shown.nodes)
    cell = float(np.ptp(x[nodes], axis=0).max()) / most
    while True:
        cells = np.floor((x[nodes] - x[nodes].min(axis=0)) / cell + 1e-9).astype(np.int64)
        _, cluster, counts = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
        if len(counts) <= most:
            break
        cell *= 2**0.5
    means = np.stack([np.bincount(cluster, of_axis) / counts for of_axis in x[nodes].T], axis=1)
    nearest = np.lexsort((np.linalg.norm(x[nodes] - means[cluster], axis=1), cluster))
    kept = nodes[nearest[np.searchsorted(cluster[nearest], np.arange(len(counts)))]]
    of_node = dict(zip(nodes.tolist(), kept[cluster].tolist(), strict=True))
    moved = (tuple(dict.fromkeys(of_node[node] for node in face)) for face in shown.faces)
    faces = {frozenset(face): face for face in moved if len(face) > 2}
    pairs = {(min(pair), max(pair)) for i, j in shown.edges if (pair := (of_node[i], of_node[j]))[0] != pair[1]}
    return Surface(tuple(faces.values()), tuple(sorted(pairs)))


def boundary_faces(elements: tuple[Elements, ...]) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """The faces of one element alone: their corners (faces, 3 or 4), and the nodes in the middles of the edges after
    each corner, -1 where there are none."""
    result = []
    for count in (3, 4):
        parts = [part for block in elements for part in _faces(block, count)]
        if not parts:
            continue
        corners, middles = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
        _, first, counts = np.unique(np.sort(corners, axis=1), axis=0, return_index=True, return_counts=True)
        alone = np.sort(first[counts == 1])
        result.append((corners[alone], middles[alone]))
    return result


def _faces(block: Elements, count: int) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """All faces of a block with so many corners."""
    shape = element_shape(block.kind)
    middle = {frozenset(edge): shape.corners + i for i, edge in enumerate(shape.edges)}
    result = []
    for face in shape.faces:
        if len(face) != count:
            continue
        own = [middle.get(frozenset((face[i], face[(i + 1) % count])), -1) for i in range(count)]
        between = block.nodes[:, own] if middle else np.full((len(block.nodes), count), -1)
        result.append((block.nodes[:, list(face)], between))
    return result
