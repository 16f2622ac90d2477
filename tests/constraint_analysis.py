"""Rank and conditioning of the constraints in one state, as tests compare them with theory."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from derive.lowering.redundancy import Dependence, dependences
from derive.runtime.native_call import Vector
from derive.simulation.compiled_scene import ConstrainedSystem, kkt_matrix
from derive.simulation.constraints.redundancy import involved
from derive.simulation.constraints.scaling import spectrum


@dataclass(frozen=True)
class ConstraintAnalysis:
    """Constraints in one state: their number and rank; the smallest singular value of the scaled G.

    condition: the condition number of [M, -G^T; -G, 0] in SI units, not scaled. dependent: a minimal set of constraints
    that the others imply in this state. involved: the multipliers that take part in the smallest singular values.
    """

    count: int
    rank: int
    smallest: float
    condition: float
    dependent: tuple[Dependence, ...]
    involved: tuple[str, ...]


def analyse_constraints(native: ConstrainedSystem, k: Vector, t: float, q: Vector) -> ConstraintAnalysis:
    """Rank and conditioning of the constraints in the configuration q (nq,) at t (s)."""
    singular = spectrum(native, k, t, q)
    return ConstraintAnalysis(
        count=native.nlambda,
        rank=singular.rank,
        smallest=singular.smallest,
        condition=float(np.linalg.cond(kkt_matrix(native, t, q, k))),
        dependent=dependences(singular.scaled, singular.rank, native.multipliers),
        involved=involved(singular, native.multipliers),
    )
