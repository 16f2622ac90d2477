"""The residuals of a mechanism by hand, as a compiled scene has them; their Jacobians by central differences."""

from __future__ import annotations

from typing import Literal

import numpy as np
from double import Array, Double

from derive.ir.patterns import pattern


class DoubleDae:
    """F(t, y, ydot) = 0 with y = [q; v; lambda], and mu in `ggl`."""

    def __init__(self, model: Double, form: Literal["ggl", "index1", "index3"]) -> None:
        self.model, self.form = model, form
        self.size = 2 * model.nq + (2 if form == "ggl" else 1) * model.nlambda
        self.pattern = pattern(self.size, self.size, {(i, j) for i in range(self.size) for j in range(self.size)})

    def residual(self, t: float, y: Array, ydot: Array, k: Array) -> Array:
        m = self.model
        q, v, lam, mu = np.split(y, np.cumsum([m.nq, m.nv, m.nlambda]))
        G = np.reshape(m.constraint_jacobian(t, q, k), (m.nq, m.nlambda)).T
        kinematic = ydot[: m.nq] - v
        dynamic = m.diagonal * ydot[m.nq : 2 * m.nq] + m.force(t, q, v, k) - G.T @ lam
        g = m.constraints(t, q, k)
        if self.form == "ggl":
            return np.concatenate([kinematic + G.T @ mu, dynamic, m.constraint_rates(t, q, v, k), g])
        if self.form == "index3":
            return np.concatenate([kinematic, dynamic, g])
        return np.concatenate([kinematic, dynamic, G @ ydot[m.nq : 2 * m.nq] - m.constraint_bias(t, q, v, k)])

    def jacobian(self, t: float, y: Array, ydot: Array, cj: float, k: Array) -> Array:
        columns = []
        for unit in np.eye(self.size):
            e = 1e-6 * unit
            columns.append(
                (self.residual(t, y + e, ydot + cj * e, k) - self.residual(t, y - e, ydot - cj * e, k)) / 2e-6
            )
        return np.concatenate(columns)
