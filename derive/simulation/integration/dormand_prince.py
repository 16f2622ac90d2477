"""DOP853 of SciPy with the error estimates of `templates/host/dormand_prince.c`, which hold for fast vibrations."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import DOP853, DenseOutput

from derive.runtime.integrators.dormand_prince import interpolant_error, step_error
from derive.runtime.native_call import Matrix, Vector


class DormandPrince(DOP853):  # type: ignore[misc]  # SciPy has no types
    """DOP853 whose estimate vanishes at no phase of a vibration, and whose states within a step are as exact as it."""

    def _estimate_error_norm(self, K: Matrix, h: float, scale: Vector) -> float:
        return step_error(h, h * (self.B @ K[: self.n_stages]), K, scale)

    def _dense_output_impl(self) -> Any:
        interpolant = super()._dense_output_impl()
        allowed = self.atol + self.rtol * np.maximum(np.abs(self.y_old), np.abs(self.y))
        if interpolant_error(interpolant.F, allowed) < 1:
            return interpolant
        return _OwnSteps(self.fun, self.t_old, self.t, self.y_old, self.K[0].copy())


class _OwnSteps(DenseOutput):  # type: ignore[misc]  # SciPy has no types
    """States within a step, each by a shorter step from its begin."""

    def __init__(self, fun: Callable[[float, Vector], Vector], t_old: float, t: float, y: Vector, f: Vector) -> None:
        super().__init__(t_old, t)
        self._fun, self._y, self._f = fun, y, f

    def _call_impl(self, t: Vector) -> Vector:
        h, K = float(t) - self.t_old, np.empty((DOP853.n_stages, len(self._y)))
        K[0] = self._f
        for i in range(1, DOP853.n_stages):
            K[i] = self._fun(self.t_old + DOP853.C[i] * h, self._y + h * (DOP853.A[i, :i] @ K[:i]))
        return np.asarray(self._y + h * (DOP853.B @ K))
