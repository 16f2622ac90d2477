"""Small linear algebra in a fixed order of additions: the same bytes on every machine with IEEE doubles.

LAPACK and BLAS choose their order by processor and number of threads, so that the last digits of their results, and
with them the generated code, would differ between machines. Here each step is an elementwise operation of NumPy or a
sum in an explicit order.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MAX_SWEEPS = 60
"""The limit of sweeps of Jacobi's method, which converges in about ten; only a matrix with NaN needs more."""


def pairwise_sum(terms: Array) -> Array:
    """The sum of terms (n, ...) over the first axis by pairwise summation: rounding errors grow with log n."""
    if not len(terms):
        return np.zeros(terms.shape[1:])
    while len(terms) > 1:
        half = len(terms) // 2
        terms = np.concatenate([terms[:half] + terms[half : 2 * half], terms[2 * half :]])
    return np.asarray(terms[0], dtype=np.float64)


def matrix_product(a: Array, b: Array) -> Array:
    """The matrix product (m, ...) of a (m, n) and b (n, ...)."""
    result = np.zeros((len(a), *b.shape[1:]))
    for column, row in zip(a.T, b, strict=True):
        result += np.multiply.outer(column, row)
    return result


def inner_products(f: Array, g: Array) -> Array:
    """The inner products (F, G) of the rows of f (F, n) and g (G, n), by pairwise summation over n."""
    return np.array([pairwise_sum(np.ascontiguousarray((row * g).T)) for row in f]).reshape(len(f), len(g))


def symmetric_part(a: Array) -> Array:
    """The symmetric part of a square matrix."""
    return (a + a.T) / 2


def cholesky(a: Array) -> Array | None:
    """The lower triangular L (n, n) with L L^T = a, or None if `a` is not positive definite."""
    lower = np.zeros_like(a)
    for j in range(len(a)):
        pivot = float(a[j, j] - pairwise_sum(lower[j, :j] ** 2))
        if not pivot > 0:
            return None
        lower[j, j] = math.sqrt(pivot)
        lower[j + 1 :, j] = (a[j + 1 :, j] - pairwise_sum((lower[j + 1 :, :j] * lower[j, :j]).T)) / lower[j, j]
    return lower


def forward_substitution(lower: Array, b: Array) -> Array:
    """The solution L^-1 b for a lower triangular L (n, n) and b (n, ...)."""
    result = np.array(b, dtype=np.float64)
    for j in range(len(lower)):
        result[j] /= lower[j, j]
        result[j + 1 :] -= np.multiply.outer(lower[j + 1 :, j], result[j])
    return result


def eigh(a: Array) -> tuple[Array, Array]:
    """The eigenvalues (n,), ascending, and eigenvectors, as ROWS (n, n), of a symmetric matrix, by Jacobi's method."""
    a = symmetric_part(a)
    n = len(a)
    vectors = np.eye(n)
    negligible = 1e-30 * float(np.abs(a).max(initial=0.0))
    for _ in range(MAX_SWEEPS):
        rotated = False
        for p in range(n - 1):
            for q in range(p + 1, n):
                rotated |= _rotate(a, vectors, p, q, negligible)
        if not rotated:
            break
    order = np.argsort(np.diag(a), kind="stable")
    return np.diag(a)[order], vectors[order]


def _rotate(a: Array, vectors: Array, p: int, q: int, negligible: float) -> bool:
    """Rotate so that a[p, q] vanishes; False if it is already negligible beside its diagonal entries."""
    entry, first, second = float(a[p, q]), float(a[p, p]), float(a[q, q])
    if abs(entry) <= 1e-17 * math.sqrt(abs(first * second)) or abs(entry) <= negligible:
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
