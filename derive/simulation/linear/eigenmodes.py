"""The eigenvalues of a linearisation and their modes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eig

from derive.runtime.native_call import Vector
from derive.simulation.linear.linearisation import Linearisation

ComplexVector = NDArray[np.complex128]

ZERO = 1e-7
"""Eigenvalues below this, relative to the largest, count as zero: the rounding error of a double zero eigenvalue is
about the root of that of the matrix."""

ROUNDING = 1e-13
"""The part of a squared eigenvalue, relative to the largest, that is a rounding error."""

SAME_SHAPE = 1e-4
"""Shapes of zero eigenvalues that differ by less are the same; a double zero with one shape has it twice."""


@dataclass(frozen=True, eq=False)
class Mode:
    """A mode: dq(t) = Re(shape exp(eigenvalue t)).

    Attributes:
        eigenvalue: in 1/s, that with the imaginary part >= 0 of a conjugate pair.
        shape: dq (nq,), whose largest element is 1; in space the elements of a quaternion are those of its change.

    Examples:
        >>> import derive
        >>> mode = derive.modes(derive.planar_beam("beam", bending_stiffness=100)).modes[-1]
        >>> round(mode.frequency, 2), round(mode.damping_ratio, 6)
        (145.87, 0.0)
    """

    eigenvalue: complex
    shape: ComplexVector

    @property
    def frequency(self) -> float:
        """The natural frequency |eigenvalue| / (2 pi) in Hz; 0 of a mode that does not oscillate."""
        return abs(self.eigenvalue) / (2 * math.pi) if self.eigenvalue.imag else 0.0

    @property
    def damping_ratio(self) -> float:
        """-Re(eigenvalue) / |eigenvalue|: negative if the mode grows, 0 of a zero eigenvalue."""
        size = abs(self.eigenvalue)
        return 0.0 - self.eigenvalue.real / size if size else 0.0

    def __repr__(self) -> str:
        ratio = f"damping ratio {self.damping_ratio:.3g}"
        return f"Mode: {self.frequency:.6g} Hz, {ratio}, eigenvalue {self.eigenvalue:.6g} 1/s"


def eigenmodes(linear: Linearisation) -> tuple[Mode, ...]:
    """The modes of a linearisation: one of each shape of zero eigenvalues, then by growing size of the eigenvalue.

    Of a conjugate pair one mode is listed, real eigenvalues each have one. Without damping and gyroscopic forces the
    squares of the eigenvalues are those of an (n, n) matrix, so that undamped modes have no real part.
    """
    n, A = linear.count, linear.A
    if not n:
        return ()
    if not A[:n, :n].any() and not A[n:, n:].any():
        squares, vectors = eig(A[n:, :n])
        squares = np.where(np.abs(squares.imag) <= ROUNDING * np.abs(squares).max(), squares.real, squares)
        roots = np.sqrt(squares.astype(complex))
        values, shapes = np.concatenate([roots, -roots]), np.hstack([vectors, vectors])
    else:
        values, vectors = eig(A)
        shapes = vectors[:n]
    zero = np.abs(values) <= ZERO * np.abs(values).max()
    rigid = _different(shapes[:, zero])
    others = [(value, shape) for value, shape in zip(values[~zero], shapes.T[~zero], strict=True) if value.imag >= 0]
    others.sort(key=lambda pair: (abs(pair[0]), pair[0].real))
    pairs = [*((0j, shape) for shape in rigid), *((complex(value), shape) for value, shape in others)]
    return tuple(Mode(value, normalised(linear.displacements @ shape)) for value, shape in pairs)


def normalised(shape: ComplexVector | Vector) -> ComplexVector:
    """A shape (n,) divided by its largest element: the first one of several that differ by rounding errors alone."""
    sizes = np.abs(shape)
    largest = int(np.flatnonzero(sizes >= (1 - 1e-9) * sizes.max())[0])
    return np.asarray(shape / shape[largest], dtype=complex)


def _different(shapes: NDArray[np.complex128]) -> list[Vector]:
    """A real basis of the span of columns: the columns themselves where they are independent of those before."""
    basis: list[Vector] = []
    result: list[Vector] = []
    for column in shapes.T:
        for part in (column.real, column.imag):
            size = np.linalg.norm(part)
            if size <= SAME_SHAPE * np.linalg.norm(column):
                continue
            rest = part / size
            for direction in basis:
                rest = rest - direction * (direction @ rest)
            if np.linalg.norm(rest) > SAME_SHAPE:
                basis.append(rest / np.linalg.norm(rest))
                result.append(part / size)
    return result
