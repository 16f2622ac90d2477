"""Sparse checks that a system is well-posed, linear in its size: they certify what dense decompositions need not show.

A check that fails proves nothing: the singular values of `derive.simulation.constraints.scaling` then decide.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import ConstrainedSystem, rounding
from derive.simulation.constraints.scaling import SINGULAR, orientations

CLEARLY = 10 * SINGULAR
"""Constraints whose scaled singular values are all above this are independent beyond doubt."""
DEFINITE = 1e-11
"""Eigenvalues of a mass matrix, scaled by its diagonal, above this are those of motions with kinetic energy."""
ITERATIONS = 30


def blocks(M: csc_array) -> Iterator[tuple[NDArray[np.intp], Matrix]]:
    """The blocks of a symmetric matrix that are not coupled: the numbers (m,) of their rows, and the entries (m, m)."""
    count, labels = connected_components(M, directed=False)
    order = np.argsort(labels, kind="stable")
    rows = csr_array(M)
    for own in np.split(order, np.cumsum(np.bincount(labels, minlength=count))[:-1]):
        yield own, rows[own][:, own].toarray()


def moves_mass(native: ConstrainedSystem, k: Vector, q: Vector) -> bool:
    """Whether all velocities in the configuration q (nq,) certainly have kinetic energy."""
    M = native.mass_pattern.sparse(native.mass(q, k))
    if not (np.all(np.isfinite(M.data)) and np.all(M.diagonal() > 0.0)):
        return False
    for _, block in blocks(M):
        size = np.sqrt(np.diag(block))
        if not np.linalg.eigvalsh(block / np.outer(size, size))[0] >= DEFINITE:
            return False
    return True


def independent(native: ConstrainedSystem, k: Vector, t: float, q: Vector) -> bool:
    """Whether the constraints in the configuration q (nq,) at t (s) certainly do not depend on each other.

    The smallest eigenvalue of D G M^-1 G^T D, whose rows D scales to a typical length of 1, comes from inverse
    iteration; its root is the smallest singular value of `spectrum`.
    """
    if not native.nlambda:
        return True
    if not moves_mass(native, k, q):
        return False
    inverse = _inverse(native.mass_pattern.sparse(native.mass(q, k)))
    squares, full = np.zeros(native.nlambda), np.zeros(native.nlambda)
    states = orientations(native, q)
    for state in states:
        G = _jacobian(native, t, state, k)
        squares += (G @ inverse).multiply(G).sum(axis=1) / len(states)
        full += (G != 0.0) @ inverse.diagonal() / len(states)
    if not (np.all(np.isfinite(squares)) and np.all(squares > rounding(q) ** 2 * full)):
        return False
    G = _jacobian(native, t, q, k).multiply(1.0 / np.sqrt(squares)[:, None])
    try:
        factor = splu(csc_array(G @ inverse @ G.T), options={"SymmetricMode": True})
    except RuntimeError:  # exactly singular
        return False
    x = np.random.default_rng(0).standard_normal(native.nlambda)
    for _ in range(ITERATIONS):
        x = factor.solve(x / np.linalg.norm(x))
    return bool(np.linalg.norm(x) < CLEARLY**-2)


def _jacobian(native: ConstrainedSystem, t: float, q: Vector, k: Vector) -> csr_array:
    return csr_array(native.constraint_pattern.sparse(native.constraint_jacobian(t, q, k)))


def _inverse(M: csc_array) -> csr_array:
    """The inverse of a positive definite matrix, block by block."""
    parts = [(own, np.linalg.inv(block)) for own, block in blocks(M)]
    rows = np.concatenate([np.repeat(own, len(own)) for own, _ in parts])
    columns = np.concatenate([np.tile(own, len(own)) for own, _ in parts])
    values = np.concatenate([block.ravel() for _, block in parts])
    return csr_array((values, (rows, columns)), shape=M.shape)
