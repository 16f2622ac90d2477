"""Gaussian elimination of the KKT matrices of many states in one given order, without exchanges, and its stability."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from derive.ir.patterns import Pattern
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import kkt_matrix
from derive.study.states import State

VANISHING = 1e-8
"""A pivot below this part of the largest entry of its column has vanished."""


@dataclass(frozen=True, eq=False)
class Elimination:
    """The elimination P A Q = L U of the matrices A of n states.

    pivots (n, size): in their order. ratios (n, size): |pivots| divided by the largest entries of their columns, in the
    reduced matrix and in A. growth (n,): max |U| / max |A|; U is D L^T where rows and columns have the same order.
    x (n, size): the solution of A x = b. A pivot of zero makes everything that follows NaN or infinite.
    """

    pivots: Matrix
    ratios: Matrix
    growth: Vector
    x: Matrix

    @property
    def failed(self) -> NDArray[np.bool_]:
        """The mask (n,) of the states whose solution is not finite."""
        return np.asarray(~np.all(np.isfinite(self.x), axis=1))

    @property
    def vanished(self) -> NDArray[np.bool_]:
        """The mask (size,) of pivots that vanish in a state, or between it and the next, where no earlier pivot does.

        A pivot vanishes between two states if its sign changes.
        """
        in_state = _first(~(self.ratios >= VANISHING))
        changed = _first(np.sign(self.pivots[1:]) * np.sign(self.pivots[:-1]) < 0)
        intact = np.asarray(~np.any(in_state, axis=1))
        between = changed & (intact[1:] & intact[:-1])[:, None]
        return np.asarray(np.any(in_state, axis=0) | np.any(between, axis=0))


def _first(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The mask of the first True of each row."""
    return np.asarray(mask & (np.cumsum(mask, axis=1) == 1))


def eliminate(A: Matrix, b: Matrix, rows: tuple[int, ...], cols: tuple[int, ...]) -> Elimination:
    """Eliminate matrices A (n, size, size) in the order of `rows` and `cols`, and solve A x = b for b (n, size).

    Structural zeros stay exactly zero, as in a sparse code.
    """
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
    """The backward errors (n,): the relative change of A and b that makes x exact, in the maximum norm.

    They are |A x - b| / (|A| |x| + |b|) (Rigal and Gaches, 1967, J. ACM 14, 543-548), infinite where x is not finite.
    """
    finite = np.asarray(np.isfinite(x).all(axis=1))
    safe = np.where(finite[:, None], x, 0.0)
    left = np.abs(np.einsum("sij,sj->si", A.astype(np.longdouble), safe) - b).max(axis=1)
    norms = np.abs(A).sum(axis=2).max(axis=1) * np.abs(safe).max(axis=1) + np.abs(b).max(axis=1)
    error = np.divide(left, norms, out=np.zeros_like(left), where=norms > 0)
    return np.where(finite, error.astype(float), np.inf)


def kkt_systems(native: NativeScene, k: Vector, states: Sequence[State]) -> tuple[Matrix, Matrix]:
    """Matrices (states, n, n) and right-hand sides [-h; -gamma] (states, n) of vdot and lambda."""
    left = np.array([kkt_matrix(native, t, q, k) for t, q, _ in states])
    right = [-np.concatenate([native.force(t, q, v, k), native.constraint_bias(t, q, v, k)]) for t, q, v in states]
    return left, np.array(right)


def entry_mask(shape: Pattern) -> NDArray[np.bool_]:
    """The mask (n, n) of the entries of a symmetric pattern, both triangles."""
    mask = np.zeros((shape.rows, shape.cols), dtype=bool)
    rows, cols = (np.array(x, dtype=int) for x in zip(*shape.entries, strict=True))
    mask[rows, cols] = mask[cols, rows] = True
    return mask


def equilibrated(A: Matrix, b: Matrix) -> tuple[Matrix, Matrix]:
    """Matrices A (n, size, size) with rows and columns scaled until their largest entries are 1, and b (n, size).

    Each row is scaled as its column (Ruiz, 2001, RAL-TR-2001-034): the matrices stay symmetric, and the size of pivots
    no longer depends on units.
    """
    for _ in range(20):
        scale = 1 / np.sqrt(np.abs(A).max(axis=2))
        A, b = A * scale[:, :, None] * scale[:, None, :], b * scale
    return A, b
