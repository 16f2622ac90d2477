"""A small body of nodes, and ways to write it down."""

from __future__ import annotations

import numpy as np
from scipy.io import mmwrite
from scipy.sparse import coo_array

N = 4
POSITIONS = np.array([[0.0, 0, 0], [3, 0, 0], [0, 2, 0], [0, 0, 1]])
LUMPED = np.array([1.0, 2.0, 0.0, 4.0])
CONSISTENT = np.diag([2.0, 3.0, 4.0, 5.0]) + np.diag([1.0, 0.5, -0.25], 1) + np.diag([1.0, 0.5, -0.25], -1)
_HALF = np.random.default_rng(7).integers(-9, 9, (3 * N, 3 * N)).astype(float)
STIFFNESS = _HALF + _HALF.T
MODES = np.random.default_rng(8).integers(-9, 9, (2, N, 3)).astype(float)
MODAL = np.array([[5.0, 1], [1, 7]])

LUMPED_BODY = {"positions": POSITIONS, "mass": LUMPED, "stiffness": STIFFNESS}
MODAL_BODY = {"positions": POSITIONS, "mass": LUMPED, "modes": MODES, "modal_stiffness": MODAL}


def entries(key, matrix):
    """A matrix as rows, columns and values of its entries."""
    sparse = coo_array(matrix)
    row, col = sparse.coords
    return {f"{key}_row": row, f"{key}_col": col, f"{key}_value": sparse.data}


def without(arrays, *keys):
    return {key: value for key, value in arrays.items() if key not in keys}


def save(folder, **arrays):
    """The arrays as b.npz."""
    np.savez(folder / "b.npz", **arrays)


def save_mtx(folder, **arrays):
    """The arrays as MatrixMarket files."""
    for key, array in arrays.items():
        mmwrite(folder / f"{key}.mtx", array)


def toml(lines, nodes='"b.npz"', units='"SI"'):
    return f'name = "b"\n[body]\nnodes = {nodes}\nunits = {units}\n{lines}\n'
