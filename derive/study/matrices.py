"""The KKT matrix [M, -G^T; -G, 0] of a compiled scene as numbers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from derive.ir.patterns import Pattern
from derive.runtime.native import Matrix, NativeScene, Vector
from derive.simulation.compiled_scene import kkt_matrix

State = tuple[float, Vector, Vector]
"""t, q and v."""


def systems(native: NativeScene, k: Vector, states: Sequence[State]) -> tuple[Matrix, Matrix]:
    """Matrices (states, n, n) and right-hand sides [-h; -gamma] (states, n) of vdot and lambda."""
    left = np.array([kkt_matrix(native, t, q, k) for t, q, _ in states])
    right = [-np.concatenate([native.force(t, q, v, k), native.constraint_bias(t, q, v, k)]) for t, q, v in states]
    return left, np.array(right)


def present(shape: Pattern) -> NDArray[np.bool_]:
    """Where a symmetric pattern has entries, both triangles (n, n)."""
    found = np.zeros((shape.rows, shape.cols), dtype=bool)
    rows, cols = (np.array(x, dtype=int) for x in zip(*shape.entries, strict=True))
    found[rows, cols] = found[cols, rows] = True
    return found


def equilibrated(A: Matrix, b: Matrix) -> tuple[Matrix, Matrix]:
    """Matrices (n, size, size) with rows and columns scaled until their largest entries are 1; b (n, size) as its rows.

    Each row is scaled as its column (Ruiz, 2001, RAL-TR-2001-034): elimination in any order goes on as before, but
    what is large and what is small in it has nothing to do with units.
    """
    for _ in range(20):
        scale = 1 / np.sqrt(np.abs(A).max(axis=2))
        A, b = A * scale[:, :, None] * scale[:, None, :], b * scale
    return A, b
