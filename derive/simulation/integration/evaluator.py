"""ydot of y = [q; v] with as little Python as possible: buffers are kept, C is called through their addresses."""

from __future__ import annotations

from collections.abc import Callable
from ctypes import POINTER, c_double, c_void_p, cast
from typing import Any

import numpy as np

from derive.runtime.native import ModelError, Native, Vector
from derive.simulation.compiled_scene import Mechanism


class Evaluator:
    """f(t, y) -> ydot for explicit integrators, with y and ydot = [v; vdot] (nq + nv,).

    A state that the model refuses has NaN as its derivative, so that integrators take a smaller step; `refused` then
    holds the time and the error. `evaluations` counts calls.
    """

    def __init__(self, native: Mechanism, k: Vector) -> None:
        self.evaluations = 0
        self.refused: tuple[float, ModelError] | None = None
        self._nq, self._name = native.nq, native.name
        self._y, self._ydot = np.zeros(native.nq + native.nv), np.zeros(native.nq + native.nv)
        self._k = np.ascontiguousarray(k, dtype=float)
        self._accel = self._compiled(native) if isinstance(native, Native) else self._interpreted(native)

    def __call__(self, t: float, y: Vector) -> Vector:
        """[v; vdot], a new array."""
        self.evaluations += 1
        self._y[:] = y
        if code := self._accel(t):
            self.refused = (t, ModelError(f"{self._name}_accel", code))
            return np.full(len(self._y), np.nan)
        ydot = self._ydot.copy()
        ydot[: self._nq] = y[self._nq :]
        return ydot

    def _compiled(self, native: Native) -> Callable[[float], int]:
        size = np.dtype(float).itemsize
        q, v = _address(self._y), _address(self._y, self._nq * size)
        k, vdot = _address(self._k), _address(self._ydot, self._nq * size)
        accel: Callable[..., int] = native.function("accel")
        return lambda t: accel(t, q, v, k, vdot)

    def _interpreted(self, native: Mechanism) -> Callable[[float], int]:
        def accel(t: float) -> int:
            try:
                self._ydot[self._nq :] = native.accel(t, self._y[: self._nq], self._y[self._nq :], self._k)
            except ModelError as error:
                return error.code
            return 0

        return accel


def _address(array: Vector, offset: int = 0) -> Any:
    """A pointer to an element of an array, which must outlive it."""
    return cast(c_void_p(array.ctypes.data + offset), POINTER(c_double))
