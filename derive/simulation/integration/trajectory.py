"""What an integration gives: states at the instants asked for, how well they meet the constraints, what it cost."""

from __future__ import annotations

from dataclasses import dataclass

from derive.runtime.native import Matrix, Vector


@dataclass(frozen=True, eq=False)
class Cost:
    """Evaluations of vdot, or of the residual; steps; seconds of CPU of the whole integration; Jacobians, if any."""

    evaluations: int
    steps: int
    seconds: float
    jacobians: int = 0


@dataclass(frozen=True, eq=False)
class Trajectory:
    """t (n,) in s, q (n, nq), v (n, nv) and multipliers lam (n, nlambda) in SI units.

    `drift` (n, 2) is the largest violation of g (m, rad) and of its rate (m/s, rad/s) of each row; `drift_before` what
    it was before the row was projected: the drift of one step, and the error of interpolation within it.
    """

    t: Vector
    q: Matrix
    v: Matrix
    lam: Matrix
    drift: Matrix
    drift_before: Matrix
    cost: Cost
