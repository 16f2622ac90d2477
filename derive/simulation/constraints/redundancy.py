"""Redundant and singular constraints: those that depend on others in every state, or in one state alone, by name."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import null_space, qr

from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import ConstrainedSystem, constraint_matrix, mass_matrix
from derive.simulation.constraints.neighbouring_states import neighbouring_states
from derive.simulation.constraints.scaling import SINGULAR, Spectrum, spectrum
from derive.simulation.errors import Dependence, MasslessMotion, RedundantConstraints, SingularConfiguration


def check_constraints(native: ConstrainedSystem, k: Vector, t: float, q: Vector, drives: Sequence[str] = ()) -> None:
    """Raise an error if multipliers or accelerations of the consistent configuration q (nq,) at t (s) are not unique.

    drives: names of multipliers that are released to reach neighbouring states. Constraints that depend on each other
    in q and in all neighbouring states are redundant (RedundantConstraints); those that do so in q alone make it a
    dead centre (SingularConfiguration). A mechanism that cannot move at all has redundant constraints. MasslessMotion:
    the constraints allow a motion that moves no mass.
    """
    singular = spectrum(native, k, t, q)
    if singular.rank < native.nlambda:
        around = [spectrum(native, k, time, state) for time, state in neighbouring_states(native, k, t, q, drives)]
        best = max(around, key=lambda s: (s.rank, s.smallest), default=singular)
        if best.rank < native.nlambda:
            raise RedundantConstraints(dependences(best, native.multipliers))
        raise SingularConfiguration(t, singular.smallest, involved(singular, native.multipliers))
    _check_mass(native, k, t, q)


def involved(singular: Spectrum, names: Sequence[str], limit: float = SINGULAR) -> tuple[str, ...]:
    """The names of multipliers with a share above 1 % in singular values up to `limit`, or in the smallest one."""
    return tuple(name for name, share in zip(names, singular.participation(limit), strict=True) if share > 0.01)


def dependences(singular: Spectrum, names: Sequence[str]) -> tuple[Dependence, ...]:
    """A minimal set of constraints that the others imply: the last ones, if the numbers allow the choice."""
    basis = _independent_rows(singular.scaled, singular.rank)
    rows = singular.scaled[basis]
    result = []
    for i in (i for i in range(len(names)) if i not in basis):
        factors = np.linalg.lstsq(rows.T, singular.scaled[i], rcond=None)[0] if basis else np.zeros(0)
        others = tuple(names[j] for j, factor in zip(basis, factors, strict=True) if abs(factor) > 1e-5)
        result.append(Dependence(names[i], others))
    return tuple(result)


def _independent_rows(scaled: Matrix, rank: int) -> list[int]:
    """`rank` independent rows: each that is not in the span of those before it, or else those that pivoting selects."""
    chosen: list[int] = []
    basis = np.zeros((0, scaled.shape[1]))
    for i, row in enumerate(scaled):
        rest = row - basis.T @ (basis @ row)
        rest -= basis.T @ (basis @ rest)
        size = np.linalg.norm(rest)
        if size > 10 * SINGULAR:
            chosen.append(i)
            basis = np.vstack([basis, rest / size])
    if len(chosen) == rank:
        return chosen
    _, _, order = qr(scaled.T, mode="economic", pivoting=True)
    return sorted(int(i) for i in order[:rank])


def _check_mass(native: ConstrainedSystem, k: Vector, t: float, q: Vector) -> None:
    """Raise MasslessMotion if a motion that the constraints allow has no kinetic energy."""
    M, G = mass_matrix(native, q, k), constraint_matrix(native, t, q, k)
    size = np.sqrt(np.where(np.diag(M) > 0, np.diag(M), np.median(np.diag(M)) or 1.0))
    allowed = null_space(G / size) if len(G) else np.eye(native.nv)
    if not allowed.size:
        return
    values, vectors = np.linalg.eigh(allowed.T @ (M / np.outer(size, size)) @ allowed)
    if values[0] < 1e-11:
        motion = np.abs(allowed @ vectors[:, 0])
        raise MasslessMotion([n for n, x in zip(native.coordinates, motion, strict=True) if x > 0.01 * motion.max()])
