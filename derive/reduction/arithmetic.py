"""Small linear algebra in a fixed order of additions: the same bytes on every machine with IEEE doubles.

LAPACK and BLAS choose their order by processor and number of threads, and the last digits of what they give would end
in generated code. Here each step is one elementwise operation of NumPy, or a sum whose order is explicit.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SWEEPS = 60
"""Jacobi's method converges in some ten sweeps; more than this means that something is not a number."""


def total(terms: Array) -> Array:
    """The sum over the first axis, in pairs of pairs, so that rounding grows with the logarithm of their number."""
    if not len(terms):
        return np.zeros(terms.shape[1:])
    while len(terms) > 1:
        half = len(terms) // 2
        terms = np.concatenate([terms[:half] + terms[half : 2 * half], terms[2 * half :]])
    return np.asarray(terms[0], dtype=np.float64)


def product(a: Array, b: Array) -> Array:
    """The matrix product of a (rows, n) and b (n, ...)."""
    result = np.zeros((len(a), *b.shape[1:]))
    for column, row in zip(a.T, b, strict=True):
        result += np.multiply.outer(column, row)
    return result


def gram(f: Array, g: Array) -> Array:
    """The products of the rows of f and g, which are long."""
    return np.array([total(np.ascontiguousarray((row * g).T)) for row in f]).reshape(len(f), len(g))


def symmetric(a: Array) -> Array:
    """The symmetric part."""
    return (a + a.T) / 2


def cholesky(a: Array) -> Array | None:
    """Lower triangular L with L L^T = a, or None if a is not positive definite."""
    lower = np.zeros_like(a)
    for j in range(len(a)):
        pivot = float(a[j, j] - total(lower[j, :j] ** 2))
        if not pivot > 0:
            return None
        lower[j, j] = math.sqrt(pivot)
        lower[j + 1 :, j] = (a[j + 1 :, j] - total((lower[j + 1 :, :j] * lower[j, :j]).T)) / lower[j, j]
    return lower


def forward(lower: Array, b: Array) -> Array:
    """L^-1 b, for b (n, ...)."""
    result = np.array(b, dtype=np.float64)
    for j in range(len(lower)):
        result[j] /= lower[j, j]
        result[j + 1 :] -= np.multiply.outer(lower[j + 1 :, j], result[j])
    return result


def eigh(a: Array) -> tuple[Array, Array]:
    """Eigenvalues of a symmetric matrix, ascending, and its eigenvectors as ROWS, by Jacobi's rotations."""
    a = symmetric(a)
    n = len(a)
    vectors = np.eye(n)
    least = 1e-30 * float(np.abs(a).max(initial=0.0))
    for _ in range(SWEEPS):
        rotated = False
        for p in range(n - 1):
            for q in range(p + 1, n):
                rotated |= _rotate(a, vectors, p, q, least)
        if not rotated:
            break
    order = np.argsort(np.diag(a), kind="stable")
    return np.diag(a)[order], vectors[order]


def _rotate(a: Array, vectors: Array, p: int, q: int, least: float) -> bool:
    """Make a[p, q] vanish; False if it is nothing beside its diagonal already."""
    entry, first, second = float(a[p, q]), float(a[p, p]), float(a[q, q])
    if abs(entry) <= 1e-17 * math.sqrt(abs(first * second)) or abs(entry) <= least:
        a[p, q] = a[q, p] = 0.0
        return False
    theta = (second - first) / (2 * entry)
    t = math.copysign(1.0, theta) / (abs(theta) + math.sqrt(theta * theta + 1))
    c = 1 / math.sqrt(t * t + 1)
    s = t * c
    for matrix in (a, vectors):
        matrix[p], matrix[q] = c * matrix[p] - s * matrix[q], s * matrix[p] + c * matrix[q]
    a[:, p], a[:, q] = c * a[:, p] - s * a[:, q], s * a[:, p] + c * a[:, q]
    a[p, p], a[q, q] = first - t * entry, second + t * entry
    a[p, q] = a[q, p] = 0.0
    return True
