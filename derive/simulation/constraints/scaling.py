"""Constraints without units: G seen in the metric of the mass, with rows whose length is 1 as a rule."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular

from derive.runtime.native import Matrix, Vector
from derive.simulation.compiled_scene import Mechanism, constraint_matrix, mass_matrix

Mask = NDArray[np.bool_]

TURNED = 7
"""In so many states with all bodies turned at random is seen how large a constraint is."""
SINGULAR = 1e-7
"""Singular values of scaled constraints below this count as zero. A rod in 30 beams that are welded together has 1e-2,
and where a dead centre is a double root, positions are good to the root of the rounding error, 1e-8."""


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


def per_speed(G: Matrix, R: Matrix) -> Matrix:
    """G R^-1: what rates of unit kinetic energy (times 2) do to the constraints."""
    return np.asarray(solve_triangular(R, G.T, trans="T").T) if G.size else G


def sizes(native: Mechanism, k: Vector, t: float, q: Vector, R: Matrix, free: Mask | None = None) -> Vector:
    """How long a row of G R^-1 (nlambda, `free` columns) is as a rule: in this state, and with bodies turned anyhow.

    A row may vanish at a dead centre, where a drive has a body of one coordinate on a line; so its length there is no
    measure. 1 for rows that are always zero.
    """
    turns = np.array([name.endswith("phi") for name in native.coordinates])
    random = np.random.default_rng(0)
    states = [q, *(np.where(turns, random.uniform(-np.pi, np.pi, native.nq), q) for _ in range(TURNED))]
    columns = slice(None) if free is None else free
    squares = [np.sum(per_speed(constraint_matrix(native, t, s, k)[:, columns], R) ** 2, axis=1) for s in states]
    found = np.sqrt(np.mean(squares, axis=0))
    return np.where(found > 0.0, found, 1.0)


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
    R = metric(mass_matrix(native, q, k))
    scaled = per_speed(constraint_matrix(native, t, q, k), R) / sizes(native, k, t, q, R)[:, None]
    count, columns = scaled.shape
    if count == 0:
        return Spectrum(scaled, np.zeros(0), np.zeros((0, 0)))
    left, values, _ = np.linalg.svd(scaled, full_matrices=True)
    return Spectrum(scaled, np.concatenate([values, np.zeros(count - min(count, columns))]), left)
