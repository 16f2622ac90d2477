"""A body of point masses and springs as arrays of nodes: a row of cells, small and without any symmetry."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array


def lattice(bays: int) -> dict[str, np.ndarray]:
    """A body of point masses at the corners of a row of cells, with springs between all nodes of a cell."""
    x = np.array([[i, 0.31 * (j % 2), 0.47 * (j // 2)] for i in range(bays + 1) for j in range(4)], dtype=float)
    x[:, 1] += 0.05 * x[:, 0]
    k = np.zeros((3 * len(x), 3 * len(x)))
    for first in range(0, 4 * bays, 4):
        for i in range(first, first + 8):
            for j in range(i + 1, first + 8):
                axis = (x[j] - x[i]) / np.linalg.norm(x[j] - x[i])
                stiffness = 1e3 * np.outer(axis, axis)
                for a, b, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
                    k[3 * a : 3 * a + 3, 3 * b : 3 * b + 3] += sign * stiffness
    entries = coo_array(k)
    return {
        "positions": x,
        "mass": 0.3 + 0.02 * np.arange(len(x)),
        "stiffness_row": entries.row,
        "stiffness_col": entries.col,
        "stiffness_value": entries.data,
    }
