"""Eigenvalues of a linearisation with the rounding error of each, which distinguishes growth from rounding."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eig

from derive.runtime.native_call import Matrix

ROUNDING = 1e-13
"""The rounding error of the elements of a matrix relative to its norm, which applies to elements of zero as well."""
COINCIDENT = 1e-5
"""Eigenvalues this close to 0 or to the spin, relative to the largest, belong to rigid motions in rotating axes."""


@dataclass(frozen=True, eq=False)
class Eigenvalues:
    """The eigenvalues (n,) of a state space, 1/s, and bounds (n,) of their rounding errors.

    Of a conjugate pair the one with the positive imaginary part is kept. spin: that of the rotating axes, rad/s.
    """

    values: NDArray[np.complex128]
    errors: NDArray[np.float64]
    spin: float = 0.0

    @property
    def grows(self) -> NDArray[np.bool_]:
        """The mask (n,) of modes that grow by more than rounding errors."""
        return np.asarray(self.values.real > self.errors)

    @property
    def growing(self) -> int:
        """The number of modes that grow."""
        return int(np.sum(self.grows))

    @property
    def diverging(self) -> int:
        """The number of modes that grow without vibrating."""
        return int(np.sum(self.grows & (self.values.imag == 0.0)))

    @property
    def growth(self) -> float:
        """The largest growth rate, 1/s; 0 if nothing grows."""
        return float(self.values.real[self.grows].max(initial=0.0))

    @property
    def frequencies(self) -> NDArray[np.float64]:
        """The angular frequencies (rad/s) that are not zero, rising; without free translations in rotating axes.

        In rotating axes modes that decay faster than they vibrate are left out: they turn at about the spin, by which
        frequencies there differ from others.
        """
        near = COINCIDENT * float(np.abs(self.values).max(initial=0.0))
        vibrates = self.values.imag + abs(self.spin) > -self.values.real
        of = self.values.imag[(self.values.imag > near) & (vibrates | (self.spin == 0))]
        return np.sort(of[np.abs(of - abs(self.spin)) > near] if self.spin else of)


def eigenvalues(A: Matrix, spin: float = 0.0) -> Eigenvalues:
    """The eigenvalues of the state space xdot = A x of n displacements and their n rates, A (2 n, 2 n).

    Displacements are scaled by a frequency, so that both halves have elements of one size. The bound of their errors
    is that of first order, eps |A| / s, with the cosine s between the left and the right eigenvector: a double
    eigenvalue with a single eigenvector, such as that of a free translation, has an s near sqrt(eps), and an error of
    that size.
    """
    if not A.size:
        return Eigenvalues(np.zeros(0, dtype=complex), np.zeros(0), spin)
    n = len(A) // 2
    scale = float(np.sqrt(np.linalg.norm(A[n:, :n], 2))) or 1.0
    units = np.repeat([1.0 / scale, 1.0], n)
    scaled = A * units / units[:, None]
    values, left, right = eig(scaled, left=True, right=True)
    cosines = np.abs(np.sum(left.conj() * right, axis=0))
    errors = ROUNDING * float(np.linalg.norm(scaled, 2)) / np.maximum(cosines, np.sqrt(ROUNDING))
    values = np.where(np.abs(values.imag) <= errors, values.real, values)  # double ones that rounding makes a pair
    upper = values.imag >= 0
    return Eigenvalues(values[upper], errors[upper], spin)
