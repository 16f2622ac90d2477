"""Vectors and matrices of three rows in CasADi; products of constants fold."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

Vector = list[ca.SX]
Matrix = list[list[ca.SX]]
ZERO = ca.SX(0)
PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
"""The entries of a symmetric matrix in their order in arrays."""


def cross(a: Sequence[ca.SX], b: Sequence[ca.SX]) -> Vector:
    """The vector product."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a: Sequence[ca.SX], b: Sequence[ca.SX]) -> ca.SX:
    """The scalar product, added up from the left."""
    total = a[0] * b[0]
    for x, y in zip(a[1:], b[1:], strict=True):
        total = total + x * y
    return total


def plus(*vectors: Sequence[ca.SX]) -> Vector:
    """The sum of vectors."""
    result = list(vectors[0])
    for vector in vectors[1:]:
        result = [x + y for x, y in zip(result, vector, strict=True)]
    return result


def minus(a: Sequence[ca.SX], b: Sequence[ca.SX]) -> Vector:
    """The difference of two vectors."""
    return [x - y for x, y in zip(a, b, strict=True)]


def scaled(factor: ca.SX, a: Sequence[ca.SX]) -> Vector:
    """A vector times a scalar."""
    return [factor * x for x in a]


def applied(a: Matrix, x: Sequence[ca.SX]) -> Vector:
    """The product of a matrix and a vector."""
    return [dot(row, x) for row in a]


def product(a: Matrix, b: Matrix) -> Matrix:
    """The product of two matrices."""
    columns = transposed(b)
    return [[dot(row, column) for column in columns] for row in a]


def transposed(a: Sequence[Sequence[ca.SX]]) -> Matrix:
    """The transpose."""
    return [list(row) for row in zip(*a, strict=True)]


def symmetric(entries: Sequence[ca.SX]) -> Matrix:
    """The symmetric matrix with these entries, in the order of PAIRS."""
    result: Matrix = [[entries[0]] * 3 for _ in range(3)]
    for (i, j), entry in zip(PAIRS, entries, strict=True):
        result[i][j] = result[j][i] = entry
    return result


def packed(a: Matrix) -> Vector:
    """The entries of a symmetric matrix in the order of PAIRS."""
    return [a[i][j] for i, j in PAIRS]


def after_cross(a: Matrix, r: Sequence[ca.SX]) -> Matrix:
    """The product A r~ with r~ x = r x x."""
    return [[row[1] * r[2] - row[2] * r[1], row[2] * r[0] - row[0] * r[2], row[0] * r[1] - row[1] * r[0]] for row in a]


def before_cross(r: Sequence[ca.SX], a: Matrix) -> Matrix:
    """The product r~ A."""
    return transposed([cross(r, column) for column in transposed(a)])
