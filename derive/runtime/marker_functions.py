"""Functions of the markers of a compiled model: motion, Jacobian, and generalised forces of loads."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from derive.ir.patterns import Pattern
from derive.registry import UnknownNameError
from derive.runtime.compiled_function import CompiledFunction
from derive.runtime.native_call import (
    Matrix,
    ModelError,
    Vector,
    checked_rows,
    checked_vector,
)
from derive.runtime.native_markers import NativeMarker


class MarkerFunctions:
    """The functions of a `Native` that take the name of a marker."""

    name: str
    nq: int
    nv: int
    nk: int
    markers: tuple[str, ...]
    _compiled: dict[str, CompiledFunction]
    _marker_of: dict[str, NativeMarker]
    own: Any

    def marker(self, name: str, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> tuple[Vector, Vector, Vector]:
        """Position (m) and velocity (m/s) in the inertial frame, and values of the Jacobian, of the marker `name`.

        Raises:
            UnknownNameError: for a name that is not in `markers`.

        Examples:
            >>> x, xdot, jacobian = native.marker("tip", q, v, k)
            >>> x.round(4), xdot.round(4)
            (array([0.434 , 0.2485]), array([-0.7455,  1.302 ]))
            >>> native.marker_pattern("tip").dense(jacobian).shape
            (2, 5)
        """
        self._check_marker(name)
        x, xdot, jacobian = self._compiled[f"marker_{name}"].results((q, v, k))
        return x, xdot, jacobian

    def marker_positions(self, name: str, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Matrix:
        """Positions (n, 2) or (n, 3) in space, m, of the marker `name` for each row of q and v: those of `marker`.

        Raises:
            UnknownNameError: for a name that is not in `markers`.

        Examples:
            >>> native.marker_positions("tip", [q, q], [v, v], k).round(4)
            array([[0.434 , 0.2485],
                   [0.434 , 0.2485]])
        """
        function, marker = f"marker_{name}", self._marker(name)
        # A copy, since a contiguous array of one row, such as q[None], may have a stride of 0.
        qs, vs = (np.array(checked_rows(n, x, function), order="C") for n, x in ((self.nq, q), (self.nv, v)))
        constants = checked_vector(self.nk, self.own(k), function)
        result, xdot = np.empty((len(qs), marker.dimension)), np.empty(marker.dimension)
        jacobian = np.empty(marker.size)
        rows = zip(
            *(range(x.ctypes.data, x.ctypes.data + x.nbytes, x.strides[0]) for x in (qs, vs, result)), strict=True
        )
        evaluate, others = (
            marker.bound(marker.holder.evaluate),
            (constants.ctypes.data, xdot.ctypes.data, jacobian.ctypes.data),
        )
        for q_i, v_i, x_i in rows:  # a row takes a microsecond, and ten by `marker`
            if code := evaluate(q_i, v_i, others[0], x_i, *others[1:]):
                raise ModelError(f"{self.name}_{function}", code)
        return result

    def load(self, name: str, q: ArrayLike, force: ArrayLike, k: ArrayLike) -> Vector:
        """Generalised forces f (nv,) of a `force` (2,) or (3,), N, at the marker `name`: M vdot + h = f.

        The force is given in the inertial frame.

        Raises:
            UnknownNameError: for a name that is not in `markers`.

        Examples:
            >>> native.load("tip", q, [0, -10], k).round(3) + 0.0
            array([  0.   , -10.   ,  -4.34 ,  -8.776,  -8.776])
        """
        self._check_marker(name)
        return self._compiled[f"load_{name}"]((q, force, k))

    def marker_pattern(self, name: str) -> Pattern:
        """The pattern of the Jacobian of the marker `name`.

        Raises:
            UnknownNameError: for a name that is not in `markers`.

        Examples:
            >>> pattern = native.marker_pattern("tip")
            >>> pattern.rows, pattern.cols
            (2, 5)
        """
        return self._marker(name).pattern(self.nv)

    def _check_marker(self, name: str) -> None:
        if name not in self.markers:
            left_out = "" if self.markers else " (simulations in space have no functions of markers: write an output)"
            raise UnknownNameError(f"marker of {self.name}{left_out}", name, self.markers)

    def _marker(self, name: str) -> NativeMarker:
        self._check_marker(name)
        return self._marker_of[name]
