"""Vectors, rotations and linear equations of decimal numbers with 60 digits.

Arrays are NumPy arrays of `decimal.Decimal`, whose arithmetic is ten times as fast as that of mpmath; elementary
functions come from mpmath. Every function that computes runs under `precise()`.
"""

from __future__ import annotations

import decimal
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from decimal import Decimal
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np

DIGITS = 60
STEP = Decimal(10) ** -14
"""The step of differences, whose errors are of the order 1e-28 for first and second derivatives."""

Array = np.ndarray
ZERO, ONE = Decimal(0), Decimal(1)


def precise() -> AbstractContextManager[decimal.Context]:
    """The context of all computations."""
    return decimal.localcontext(decimal.Context(prec=DIGITS, Emin=-10000, Emax=10000))


def number(x: Any) -> Decimal:
    """A number with all its digits: a float is the binary number, a text or a Decimal the decimal one or a fraction."""
    if isinstance(x, str) and "/" in x:
        x = Fraction(x)
    if isinstance(x, Fraction):
        return Decimal(x.numerator) / Decimal(x.denominator)
    if isinstance(x, np.floating):
        return Decimal(float(x))
    return Decimal(int(x)) if isinstance(x, np.integer) else Decimal(x)


def array(values: Any) -> Array:
    """An array of numbers, of any shape."""
    values = np.array(values, dtype=object)
    result = np.array([number(x) for x in values.ravel()], dtype=object)
    return result.reshape(values.shape)


def zeros(*shape: int) -> Array:
    """An array of zeros."""
    return array(np.zeros(shape, dtype=int))


def identity(n: int) -> Array:
    """The unit matrix."""
    return array(np.eye(n, dtype=int))


def elementary(f: Callable[..., Any], *x: Decimal) -> Decimal:
    """A function of mpmath."""
    with mpmath.workdps(DIGITS + 5):
        return Decimal(mpmath.nstr(f(*(mpmath.mpf(str(a)) for a in x)), DIGITS + 3, strip_zeros=False))


def length(a: Array) -> Decimal:
    """|a|."""
    return (a @ a).sqrt()


def cross(a: Array, b: Array) -> Array:
    """a x b."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]], dtype=object)


def skew(a: Array) -> Array:
    """The matrix of a x."""
    return np.array([[ZERO, -a[2], a[1]], [a[2], ZERO, -a[0]], [-a[1], a[0], ZERO]], dtype=object)


def about(vector: Array) -> Array:
    """The rotation by |vector| about its direction, by Rodrigues' formula, as a series near zero."""
    square, k = vector @ vector, skew(vector)
    if square < Decimal(10) ** -20:
        first, second = ONE - square / 6 + square * square / 120, ONE / 2 - square / 24 + square * square / 720
        return identity(3) + first * k + second * (k @ k)
    angle = square.sqrt()
    first, second = elementary(mpmath.sin, angle) / angle, (1 - elementary(mpmath.cos, angle)) / square
    return identity(3) + first * k + second * (k @ k)


def of_quaternion(e: Array) -> Array:
    """The rotation e r e* / |e|^2 of a quaternion, scalar first."""
    s, u = e[0], e[1:]
    norm = e @ e
    return ((s * s - u @ u) * identity(3) + 2 * np.outer(u, u) + 2 * s * skew(u)) / norm


def solved(matrix: Array, right: Array) -> Array:
    """The solution of linear equations, by elimination with pivots."""
    n = len(matrix)
    work = np.hstack([matrix, right.reshape(n, -1)])
    for k in range(n):
        pivot = k + int(np.argmax([abs(x) for x in work[k:, k]]))
        if not work[pivot, k]:
            raise ZeroDivisionError("the matrix is singular")
        work[[k, pivot]] = work[[pivot, k]]
        work[k] = work[k] / work[k, k]
        rows = [i for i in range(n) if i != k and work[i, k]]
        for i in rows:
            work[i] = work[i] - work[i, k] * work[k]
    return work[:, n:].reshape(right.shape)


def cholesky(matrix: Array) -> Array:
    """L with L L^T = matrix, which may be semidefinite: its columns are zero where nothing is left."""
    n = len(matrix)
    rest, result = matrix.copy(), zeros(n, n)
    size = max(abs(matrix[i, i]) for i in range(n)) or ONE
    for k in range(n):
        if rest[k, k] > size * Decimal(10) ** -40:
            result[:, k] = rest[:, k] / rest[k, k].sqrt()
            rest = rest - np.outer(result[:, k], result[:, k])
    return result


def floats(values: Any) -> Array:
    """An array of decimals as doubles."""
    return np.array(values, dtype=object).astype(float)


def stacked(parts: Sequence[Any]) -> Array:
    """Numbers and vectors one after the other."""
    return np.array([x for part in parts for x in np.atleast_1d(np.array(part, dtype=object))], dtype=object)


def rotation_vector_of_set(weights: Array, arms: Array, displacements: Array) -> Array:
    """The small rotation of points that fits their displacements best, by weighted least squares.

    weights (P,), of sum 1; arms (P, 3) from the weighted mean of the points; displacements (P, 3).
    """
    matrix, right = zeros(3, 3), zeros(3)
    for w, r, u in zip(weights, arms, displacements, strict=True):
        matrix = matrix + w * ((r @ r) * identity(3) - np.outer(r, r))
        right = right + w * cross(r, u)
    return solved(matrix, right)
