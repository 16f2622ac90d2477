"""A matrix that is a polynomial of the modal coordinates a: m0 + sum a_k m1_k, the building block of a SID."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ZERO, DIAGONAL, SYMMETRIC, GENERAL, UNIT = range(5)
"""Values of `structure`; of a symmetric matrix the lower triangle is written."""


@dataclass(frozen=True, eq=False)
class Taylor:
    """m0 (rows, columns); m1 (rows, modes, columns) or None if the matrix is constant."""

    m0: Array
    m1: Array | None = None
    structure: int = GENERAL

    @property
    def order(self) -> int:
        """The power of a that is the last."""
        return 0 if self.m1 is None else 1


def constant(m0: Array, structure: int = GENERAL) -> Taylor:
    """A constant matrix; its structure is ZERO if all of its entries are zero."""
    return Taylor(m0, None, structure if np.any(m0) else ZERO)
