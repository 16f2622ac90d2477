"""Meshes with fewer triangles: points in one cell of a grid become one point."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]
Triangles = NDArray[np.int64]

WELDED = 1e-6
"""The cell in which points are one point, relative to the size of a mesh."""
FINEST = 1024
"""The number of cells along a mesh at which simplification begins."""


def at_most(points: Points, triangles: Triangles, most: int) -> tuple[Points, Triangles]:
    """A mesh of points (n, 3) and triangles (m, 3) of at most so many triangles.

    It has more where even two cells along it have; points that are used more than once are one point.
    """
    cells = float(FINEST)
    size = float(np.ptp(points, axis=0).max()) or 1.0
    points, triangles = clustered(points, triangles, WELDED * size)
    while len(triangles) > most and cells >= 2:
        points, triangles = clustered(points, triangles, size / cells)
        cells /= 2**0.5
    return points, triangles


def clustered(points: Points, triangles: Triangles, cell: float) -> tuple[Points, Triangles]:
    """A mesh whose points in one cell of a grid are one, their mean; triangles that become lines are left out."""
    if not len(triangles):
        return points, triangles
    places = np.rint((points - points.min(axis=0)) / cell).astype(np.int64)
    sizes = places.max(axis=0) + 1
    flat = (places[:, 0] * sizes[1] + places[:, 1]) * sizes[2] + places[:, 2]
    _, cluster, count = np.unique(flat, return_inverse=True, return_counts=True)
    mean = np.stack([np.bincount(cluster, x) / count for x in points.T], axis=1)
    corners = cluster[triangles]
    a, b, c = corners.T
    corners = corners[(a != b) & (b != c) & (c != a)]
    _, first = np.unique(np.sort(corners, axis=1), axis=0, return_index=True)
    used, numbers = np.unique(corners[np.sort(first)], return_inverse=True)
    return mean[used], numbers.reshape(-1, 3)
