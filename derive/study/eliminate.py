"""Gaussian elimination of many matrices in one given order, without any exchange of rows, and how stable it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from derive.runtime.native import Matrix, Vector

VANISHING = 1e-8
"""A pivot below this part of the largest entry of its column has vanished."""


@dataclass(frozen=True, eq=False)
class Elimination:
    """P A Q = L U of the matrices of n states, as far as it went.

    `pivots` (n, size) in their order; `ratios` (n, size): |pivots| over the largest entries of their columns, in what
    was left of the matrix then and in A. `growth` (n,) is max |U| / max |A|; U is D L^T where rows and columns have the
    same order. `x` (n, size) solves A x = b; a pivot of zero makes all that follows NaN or infinite.
    """

    pivots: Matrix
    ratios: Matrix
    growth: Vector
    x: Matrix

    @property
    def failed(self) -> NDArray[np.bool_]:
        """(n,): whether something is not finite."""
        return np.asarray(~np.all(np.isfinite(self.x), axis=1))

    @property
    def vanished(self) -> NDArray[np.bool_]:
        """(size,): which pivots vanish in a state, or between it and the next, where no pivot before them does.

        Between two states a pivot has vanished when its sign has changed.
        """
        in_state = _first(~(self.ratios >= VANISHING))
        changed = _first(np.sign(self.pivots[1:]) * np.sign(self.pivots[:-1]) < 0)
        intact = np.asarray(~np.any(in_state, axis=1))
        between = changed & (intact[1:] & intact[:-1])[:, None]
        return np.asarray(np.any(in_state, axis=0) | np.any(between, axis=0))


def _first(found: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The first True of each row alone."""
    return np.asarray(found & (np.cumsum(found, axis=1) == 1))


def eliminate(A: Matrix, b: Matrix, rows: tuple[int, ...], cols: tuple[int, ...]) -> Elimination:
    """Eliminate matrices (n, size, size) and solve with them. Zeros stay exactly zero, as in a sparse code."""
    count, size = b.shape
    work, y = A[:, rows][:, :, cols].astype(float), b[:, rows].astype(float)
    largest, top = np.abs(work).max(axis=1), np.abs(A).max(axis=(1, 2))
    pivots, ratios, grown = np.empty((count, size)), np.zeros((count, size)), np.zeros(count)
    with np.errstate(all="ignore"):
        for j in range(size):
            pivot, below = work[:, j, j].copy(), work[:, j + 1 :, j]
            pivots[:, j] = pivot
            grown = np.maximum(grown, np.abs(work[:, j, j:]).max(axis=1))
            column = np.abs(below).max(axis=1, initial=0.0)
            ratios[:, j] = np.abs(pivot) / np.maximum(np.maximum(column, largest[:, j]), np.abs(pivot))
            factors = below / pivot[:, None]
            work[:, j + 1 :, j + 1 :] -= factors[:, :, None] * work[:, j, None, j + 1 :]
            y[:, j + 1 :] -= factors * y[:, j, None]
        for j in range(size - 1, -1, -1):
            y[:, j] -= np.einsum("si,si->s", work[:, j, j + 1 :], y[:, j + 1 :])
            y[:, j] /= work[:, j, j]
        x = np.empty_like(y)
        x[:, cols] = y
        return Elimination(pivots, ratios, np.where(np.isfinite(x).all(axis=1), grown / top, np.inf), x)


def backward_error(A: Matrix, b: Matrix, x: Matrix) -> Vector:
    """(n,): |A x - b| / (|A| |x| + |b|) in the largest norm, the relative change of A and b that would make x exact.

    Rigal and Gaches, 1967, J. ACM 14, 543-548. Infinite where x is not finite.
    """
    finite = np.asarray(np.isfinite(x).all(axis=1))
    safe = np.where(finite[:, None], x, 0.0)
    left = np.abs(np.einsum("sij,sj->si", A.astype(np.longdouble), safe) - b).max(axis=1)
    norms = np.abs(A).sum(axis=2).max(axis=1) * np.abs(safe).max(axis=1) + np.abs(b).max(axis=1)
    error = np.divide(left, norms, out=np.zeros_like(left), where=norms > 0)
    return np.where(finite, error.astype(float), np.inf)
