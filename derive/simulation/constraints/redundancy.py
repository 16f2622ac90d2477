"""Constraints that say what others say, always or in one state alone, found out and named."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space, qr

from derive.runtime.native import Matrix, Vector
from derive.simulation.compiled_scene import Mechanism, constraint_matrix, mass_matrix
from derive.simulation.constraints.neighbouring_states import nearby
from derive.simulation.constraints.scaling import SINGULAR, Spectrum, spectrum
from derive.simulation.errors import Dependence, MasslessMotion, RedundantConstraints, SingularConfiguration


@dataclass(frozen=True)
class Analysis:
    """Constraints in one state: how many there are, and are independent; the smallest singular value of scaled G.

    `condition` is the condition number of [M G^T; G 0] as it stands, in SI units. `dependent`: a minimal set of
    constraints that the others imply in this state. `involved`: multipliers with a part in what vanishes, or comes
    nearest to it.
    """

    count: int
    rank: int
    smallest: float
    condition: float
    dependent: tuple[Dependence, ...]
    involved: tuple[str, ...]


def analyse(native: Mechanism, k: Vector, t: float, q: Vector) -> Analysis:
    """Rank and conditioning of the constraints in a state."""
    found = spectrum(native, k, t, q)
    return Analysis(
        count=native.nlambda,
        rank=found.rank,
        smallest=found.smallest,
        condition=_condition(native, k, t, q),
        dependent=dependences(found, native.multipliers),
        involved=involved(found, native.multipliers),
    )


def check(native: Mechanism, k: Vector, t: float, q: Vector, drives: Sequence[str] = ()) -> None:
    """Raise RedundantConstraints, SingularConfiguration or MasslessMotion if multipliers or accelerations of a
    consistent state are not unique.

    What depends on each other in this state is redundant if it does so in all states around it as well: those that the
    mechanism is free to reach, also with its `drives` (multipliers) released, and those where it is a little earlier
    or later. A mechanism that cannot move at all has redundant constraints.
    """
    found = spectrum(native, k, t, q)
    if found.rank < native.nlambda:
        around = [spectrum(native, k, at, state) for at, state in nearby(native, k, t, q, drives)]
        best = max(around, key=lambda s: (s.rank, s.smallest), default=found)
        if best.rank < native.nlambda:
            raise RedundantConstraints(dependences(best, native.multipliers))
        raise SingularConfiguration(t, found.smallest, involved(found, native.multipliers))
    _check_mass(native, k, t, q)


def involved(found: Spectrum, names: Sequence[str], limit: float = SINGULAR) -> tuple[str, ...]:
    """The multipliers with a share of 1 % or more in what vanishes."""
    return tuple(name for name, share in zip(names, found.involved(limit), strict=True) if share > 0.01)


def dependences(found: Spectrum, names: Sequence[str]) -> tuple[Dependence, ...]:
    """A minimal set of constraints that the others imply: the last ones, if numbers allow the choice."""
    kept = _independent(found.scaled, found.rank)
    rows = found.scaled[kept]
    result = []
    for i in (i for i in range(len(names)) if i not in kept):
        factors = np.linalg.lstsq(rows.T, found.scaled[i], rcond=None)[0] if kept else np.zeros(0)
        result.append(
            Dependence(names[i], tuple(names[j] for j, x in zip(kept, factors, strict=True) if abs(x) > 1e-5))
        )
    return tuple(result)


def _independent(scaled: Matrix, rank: int) -> list[int]:
    """`rank` independent rows: each that is not in the span of those before it, or else those that pivoting picks."""
    kept: list[int] = []
    basis = np.zeros((0, scaled.shape[1]))
    for i, row in enumerate(scaled):
        rest = row - basis.T @ (basis @ row)
        rest -= basis.T @ (basis @ rest)
        size = np.linalg.norm(rest)
        if size > 10 * SINGULAR:
            kept.append(i)
            basis = np.vstack([basis, rest / size])
    if len(kept) == rank:
        return kept
    _, _, order = qr(scaled.T, mode="economic", pivoting=True)
    return sorted(int(i) for i in order[:rank])


def _condition(native: Mechanism, k: Vector, t: float, q: Vector) -> float:
    M, G = mass_matrix(native, q, k), constraint_matrix(native, t, q, k)
    return float(np.linalg.cond(np.block([[M, G.T], [G, np.zeros((len(G), len(G)))]])))


def _check_mass(native: Mechanism, k: Vector, t: float, q: Vector) -> None:
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
