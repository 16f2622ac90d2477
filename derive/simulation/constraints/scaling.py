"""Constraints without units: G in the metric of the mass matrix, its rows scaled to a typical length of 1."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cholesky, eigh, solve_triangular

from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import (
    ConstrainedSystem,
    Constraints,
    Mask,
    constraint_matrix,
    mass_matrix,
    rounding,
)
from derive.simulation.configurations import displaced, velocities_with

RANDOM_ORIENTATIONS = 7
"""The number of random orientations of all bodies in which the typical length of a constraint's row is measured."""
SINGULAR = 1e-7
"""Singular values of scaled constraints below this count as zero. A rod of 30 beams that are welded
together has 1e-2. At a dead centre that is a double root, positions have an error of 1e-8, the root of the rounding
error."""


def mass_factor(M: Matrix) -> Matrix:
    """Upper triangular R with R^T R = M (n, n), in which coordinates without mass get the median mass of the others.

    The size of that substitute does not matter, since the constraints determine the motion of such coordinates; but it
    must not be small, or else they would dominate the rows of their constraints. A relative 1e-12 is added to the
    diagonal for bodies whose mass is concentrated in a point. Of an M that is indefinite, as that of a truncated beam
    of second order with large deflections, the absolute values of the eigenvalues count: any metric will do.
    """
    diagonal = np.diag(M).copy()
    empty = diagonal <= 0.0
    typical = float(np.median(diagonal[~empty])) if np.any(~empty) else 1.0
    full = M + np.diag(np.where(empty, typical, 1e-12 * diagonal))
    try:
        return np.asarray(cholesky(full))
    except LinAlgError:
        values, vectors = eigh(full)
        sizes = np.maximum(np.abs(values), 1e-12 * np.abs(values).max())
        return np.asarray(cholesky((vectors * sizes) @ vectors.T))


def in_mass_metric(G: Matrix, R: Matrix) -> Matrix:
    """G R^-1: the rates of the constraints due to velocities whose kinetic energy is 1/2 J."""
    return np.asarray(solve_triangular(R, G.T, trans="T").T) if G.size else G


def typical_row_norms(
    native: Constraints, k: Vector, t: float, q: Vector, R: Matrix, free: Mask | None = None
) -> Vector:
    """The root mean square lengths (nlambda,) of the rows of G R^-1, over this state and random orientations of bodies.

    free: the columns of G that count, all by default. The length in a single state is not suitable, because a row may
    vanish at a dead centre. Rows that are zero in all states but for rounding errors get the length of rows with
    entries of 1, or 1.
    """
    columns = slice(None) if free is None else free
    every = [constraint_matrix(native, t, state, k)[:, columns] for state in orientations(native, q)]
    norms = np.sqrt(np.mean([np.sum(in_mass_metric(G, R) ** 2, axis=1) for G in every], axis=0))
    inverse = solve_triangular(R, np.eye(len(R)))
    full = np.sqrt(np.mean([(G != 0.0) @ np.sum(inverse**2, axis=1) for G in every], axis=0))
    zero = norms <= rounding(q) * full
    return np.where(zero, np.where(full > 0.0, full, 1.0), norms)


def orientations(native: Constraints, q: Vector) -> tuple[Vector, ...]:
    """The configuration q (nq,), and those with random orientations of all bodies, the same each time."""
    angles = velocities_with(native, Role.ROTATION)
    random = np.random.default_rng(0)
    turned = (random.uniform(-np.pi, np.pi, native.nv) for _ in range(RANDOM_ORIENTATIONS))
    if native.nq == native.nv:
        return q, *(np.where(angles, rotations, q) for rotations in turned)
    return q, *(displaced(native, q, np.where(angles, rotations, 0.0)) for rotations in turned)


@dataclass(frozen=True)
class Spectrum:
    """The scaled G (nlambda, nv) and its singular values, one for each constraint, with the left vectors as columns.

    norms (nlambda,): the typical lengths by which its rows are divided.
    """

    scaled: Matrix
    values: Vector
    left: Matrix
    norms: Vector

    @property
    def rank(self) -> int:
        """The number of independent constraints."""
        return int(np.sum(self.values > SINGULAR))

    @property
    def smallest(self) -> float:
        """The smallest singular value; 1 if there is no constraint."""
        return float(self.values[-1]) if len(self.values) else 1.0

    def participation(self, limit: float = SINGULAR) -> Vector:
        """The share (nlambda,), 0 to 1, of each constraint in the singular values up to the smallest one or `limit`."""
        vanishing = self.left[:, self.values <= max(limit, self.smallest)]
        return np.asarray(np.sqrt(np.sum(vanishing**2, axis=1)))


def spectrum(native: ConstrainedSystem, k: Vector, t: float, q: Vector, free: Mask | None = None) -> Spectrum:
    """The singular values of the scaled constraints in the configuration q (nq,) at t (s).

    free: mask (nv,) of the velocities that may change; the others are locked. All may change by default.
    """
    free = np.ones(native.nv, dtype=bool) if free is None else free
    R = mass_factor(mass_matrix(native, q, k)[np.ix_(free, free)])
    G = in_mass_metric(constraint_matrix(native, t, q, k)[:, free], R)
    norms = typical_row_norms(native, k, t, q, R, free)
    scaled = G / norms[:, None]
    count, columns = scaled.shape
    if count == 0:
        return Spectrum(scaled, np.zeros(0), np.zeros((0, 0)), norms)
    left, values, _ = np.linalg.svd(scaled, full_matrices=True)
    return Spectrum(scaled, np.concatenate([values, np.zeros(count - min(count, columns))]), left, norms)
