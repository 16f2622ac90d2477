"""Vectors, rotations and inertias in space as CasADi scalars, of which zeros and ones cost nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from typing import Protocol

import casadi as ca

from derive.lowering.flat.casadi_symbols import added, multiplied, subtracted
from derive.lowering.vectors import ZERO, Matrix, Vector

NEXT = ((1, 2), (2, 0), (0, 1))
"""The axes that follow each axis, in cyclic order."""


def null() -> Vector:
    """A vector of zeros."""
    return [ZERO] * 3


def plus(a: Vector, b: Vector) -> Vector:
    """The sum of two vectors."""
    return [added(x, y) for x, y in zip(a, b, strict=True)]


def dot(a: Sequence[ca.SX], b: Sequence[ca.SX]) -> ca.SX:
    """The product of two vectors."""
    return reduce(added, (multiplied(x, y) for x, y in zip(a, b, strict=True)))


def cross(a: Vector, b: Vector) -> Vector:
    """The vector product."""
    return [subtracted(multiplied(a[i], b[j]), multiplied(a[j], b[i])) for i, j in NEXT]


def times(matrix: Matrix, v: Vector) -> Vector:
    """A matrix times a vector."""
    return [dot(row, v) for row in matrix]


def transposed(matrix: Matrix) -> Matrix:
    """The transpose."""
    return [list(column) for column in zip(*matrix, strict=True)]


def multiply(a: Matrix, b: Matrix) -> Matrix:
    """The product of two matrices."""
    columns = transposed(b)
    return [[dot(row, column) for column in columns] for row in a]


def plus_matrix(a: Matrix, b: Matrix) -> Matrix:
    """The sum of two matrices."""
    return [plus(x, y) for x, y in zip(a, b, strict=True)]


def symmetric(upper: Matrix) -> Matrix:
    """The symmetric matrix whose upper triangle this is."""
    return [[upper[min(i, j)][max(i, j)] for j in range(3)] for i in range(3)]


class Rotation(Protocol):
    """The rotation of a frame: `on` gives the components in it of a vector, `back` those in the frame before."""

    def on(self, v: Vector) -> Vector:
        """The components in the turned frame."""

    def back(self, v: Vector) -> Vector:
        """The components in the frame before."""

    def symmetric_back(self, tensor: Matrix) -> Matrix:
        """A symmetric tensor in the frame before."""


@dataclass(frozen=True)
class Permutation:
    """A rotation that makes axes of axes: axis j of the turned frame is signs[j] times axis axes[j] of that before."""

    axes: tuple[int, ...]
    signs: tuple[int, ...]

    def on(self, v: Vector) -> Vector:
        """The components in the turned frame."""
        return [v[i] if sign > 0 else -v[i] for i, sign in zip(self.axes, self.signs, strict=True)]

    def back(self, v: Vector) -> Vector:
        """The components in the frame before."""
        result = null()
        for x, i, sign in zip(v, self.axes, self.signs, strict=True):
            result[i] = x if sign > 0 else -x
        return result

    def symmetric_back(self, tensor: Matrix) -> Matrix:
        """A symmetric tensor in the frame before."""
        return tensor_back(self, tensor)


@dataclass(frozen=True)
class PlanarTurn:
    """A rotation about an axis, which both frames have in common."""

    axis: int
    cosine: ca.SX
    sine: ca.SX

    def on(self, v: Vector) -> Vector:
        """The components in the turned frame."""
        return self._turned(v, -self.sine)

    def back(self, v: Vector) -> Vector:
        """The components in the frame before."""
        return self._turned(v, self.sine)

    def _turned(self, v: Vector, sine: ca.SX) -> Vector:
        i, j = NEXT[self.axis]
        result = [*v]
        result[i] = subtracted(multiplied(self.cosine, v[i]), multiplied(sine, v[j]))
        result[j] = added(multiplied(sine, v[i]), multiplied(self.cosine, v[j]))
        return result

    @cached_property
    def _products(self) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        """sin^2, 2 cos sin, cos sin and cos^2 - sin^2."""
        square, both = multiplied(self.sine, self.sine), multiplied(self.cosine, self.sine)
        return square, added(both, both), both, subtracted(multiplied(self.cosine, self.cosine), square)

    def symmetric_back(self, tensor: Matrix) -> Matrix:
        """A symmetric tensor in the frame before: its plane takes 9 operations and its other entries 6."""
        k, (i, j) = self.axis, NEXT[self.axis]
        square, twice, both, difference = self._products
        unequal = subtracted(tensor[i][i], tensor[j][j])
        moved = added(multiplied(square, unequal), multiplied(twice, tensor[i][j]))
        result = [[*row] for row in tensor]
        result[i][i] = subtracted(tensor[i][i], moved)
        result[j][j] = added(tensor[j][j], moved)
        result[i][j] = result[j][i] = added(multiplied(both, unequal), multiplied(difference, tensor[i][j]))
        column = self.back([tensor[0][k], tensor[1][k], tensor[2][k]])
        for a in (i, j):
            result[a][k] = result[k][a] = column[a]
        return result


@dataclass(frozen=True)
class FullRotation:
    """Any rotation, by the axes of the turned frame as columns."""

    matrix: Matrix

    def on(self, v: Vector) -> Vector:
        """The components in the turned frame."""
        return times(transposed(self.matrix), v)

    def back(self, v: Vector) -> Vector:
        """The components in the frame before."""
        return times(self.matrix, v)

    def symmetric_back(self, tensor: Matrix) -> Matrix:
        """A symmetric tensor in the frame before."""
        half = multiply(self.matrix, tensor)
        return symmetric([[dot(half[i], self.matrix[j]) if j >= i else ZERO for j in range(3)] for i in range(3)])


def tensor_back(rotation: Rotation, tensor: Matrix) -> Matrix:
    """Any tensor in the frame before."""
    columns = [rotation.back(column) for column in transposed(tensor)]
    return [rotation.back(row) for row in transposed(columns)]


@dataclass(frozen=True)
class SpatialInertia:
    """The force f = A x + B y and the torque n = B^T x + C y about a point with the accelerations x and, angular, y."""

    A: Matrix
    B: Matrix
    C: Matrix

    def __add__(self, other: SpatialInertia) -> SpatialInertia:
        return SpatialInertia(plus_matrix(self.A, other.A), plus_matrix(self.B, other.B), plus_matrix(self.C, other.C))

    def turned_back(self, rotation: Rotation) -> SpatialInertia:
        """The inertia in the frame before a rotation."""
        of = rotation.symmetric_back
        return SpatialInertia(of(self.A), tensor_back(rotation, self.B), of(self.C))

    def shifted(self, r: Vector) -> SpatialInertia:
        """The inertia about a point from which the point of this one is at r: B - A [r], C + [r] B' + ([r] B)^T."""
        B = [plus(row, cross(r, a)) for row, a in zip(self.B, self.A, strict=True)]
        before = transposed([cross(r, column) for column in transposed(self.B)])
        after = transposed([cross(r, column) for column in transposed(B)])
        total = [
            [added(added(before[j][i], after[i][j]), self.C[i][j]) if j >= i else ZERO for j in range(3)]
            for i in range(3)
        ]
        return SpatialInertia(self.A, B, symmetric(total))
