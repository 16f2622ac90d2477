"""Constraints without units: G seen in the metric of the mass, with rows of length 1."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from derive.native import Matrix, Vector
from derive.simulation.mechanism import Mechanism, constraint_matrix, mass_matrix

SINGULAR = 1e-7
"""Singular values of scaled constraints below this count as zero. Constraints of a mechanism that moves have 1e-3 or
more; where a dead centre is a double root, positions are good to the root of the rounding error, 1e-8."""


def metric(M: Matrix) -> Matrix:
    """Upper triangular R with R^T R = M, in which coordinates without mass have that of others.

    How large does not matter, as constraints say all about their motion, but it must not be small: they would hide the
    rest of a constraint. A little is added for bodies whose mass is in a point.
    """
    diagonal = np.diag(M).copy()
    empty = diagonal <= 0.0
    typical = float(np.median(diagonal[~empty])) if np.any(~empty) else 1.0
    full = M + np.diag(np.where(empty, typical, 1e-12 * diagonal))
    return np.asarray(cholesky(full))


def without_units(G: Matrix, R: Matrix) -> tuple[Matrix, Vector]:
    """G R^-1 with rows of length 1, and the lengths they had (1 for rows of zeros)."""
    weighted = solve_triangular(R, G.T, trans="T").T if G.size else G
    lengths = np.sqrt(np.sum(weighted**2, axis=1))
    lengths[lengths == 0.0] = 1.0
    return weighted / lengths[:, None], lengths


@dataclass(frozen=True)
class Spectrum:
    """Scaled G (nlambda, nv) and its singular values with the left vectors as columns, one for each constraint."""

    scaled: Matrix
    values: Vector
    left: Matrix

    @property
    def rank(self) -> int:
        """How many constraints are independent."""
        return int(np.sum(self.values > SINGULAR))

    @property
    def smallest(self) -> float:
        """The smallest singular value: 1 if there is no constraint."""
        return float(self.values[-1]) if len(self.values) else 1.0

    def involved(self, limit: float = SINGULAR) -> Vector:
        """The share of each constraint in what vanishes (0 to 1), of singular values up to the smallest or `limit`."""
        vanishing = self.left[:, self.values <= max(limit, self.smallest)]
        return np.asarray(np.sqrt(np.sum(vanishing**2, axis=1)))


def spectrum(native: Mechanism, k: Vector, t: float, q: Vector) -> Spectrum:
    """Singular values of the scaled constraints in a state."""
    scaled, _ = without_units(constraint_matrix(native, t, q, k), metric(mass_matrix(native, q, k)))
    count, columns = scaled.shape
    if count == 0:
        return Spectrum(scaled, np.zeros(0), np.zeros((0, 0)))
    left, values, _ = np.linalg.svd(scaled, full_matrices=True)
    return Spectrum(scaled, np.concatenate([values, np.zeros(count - min(count, columns))]), left)
