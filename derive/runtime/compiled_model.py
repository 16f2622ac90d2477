"""The functions of a compiled model, called through NumPy by means of its descriptor."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from derive.backends.c.source import ABI
from derive.ir.patterns import Pattern
from derive.registry import UnknownNameError
from derive.runtime.compiler import CompilerError
from derive.runtime.descriptor import ModelStruct, names_of, pattern_of, roles_of
from derive.runtime.native_call import (
    Matrix,
    ModelError,
    Vector,
    checked_number,
    checked_origin,
    checked_rows,
    checked_vector,
    constants_of,
    doubles,
    invoke,
)


class Native:
    """A compiled model. Arrays are vectors of doubles in SI units; matrices come as the values of their pattern.

    The pattern makes a matrix of them, dense or in SciPy's compressed columns:
    `native.mass_pattern.dense(native.mass(q, k))`, `native.jacobian_pattern.sparse(native.jacobian(t, y, ydot, c, k))`.

    Functions raise ModelError when the model returns a code other than 0, ValueError on a wrong length.
    """

    follows_functions = False
    """Whether inputs follow functions in Python, so that a function of the library alone does not know them."""

    def __init__(self, library: ctypes.CDLL, name: str) -> None:
        entry = getattr(library, f"{name}_model")
        entry.restype = ctypes.POINTER(ModelStruct)
        self._library = library  # keeps the code loaded
        self._model = m = entry().contents
        if m.abi != ABI:
            raise CompilerError(f"{name}: its interface has number {m.abi}, this Tisserand knows {ABI}")
        self.name, self.hash = name, m.hash.decode()
        self.is_scene = bool(m.scene)
        self.nq, self.nv, self.np, self.nk, self.nlambda = m.nq, m.nv, m.np, m.nk, m.nlambda
        self.parameters = names_of(m.p, m.variables_p)
        self.coordinates = names_of(m.q, m.variables_q)
        self.roles = roles_of(m.q, m.variables_q)
        self.velocities = names_of(m.v, m.variables_v)
        self.defaults = np.empty(m.np)
        m.defaults(self.defaults.ctypes.data)
        self.mass_pattern = pattern_of(m.mass_pattern.contents)
        self.jacobian_pattern = pattern_of(m.jacobian_pattern.contents)
        self.markers = tuple(m.markers[i].name.decode() for i in range(m.nmarkers))

    @property
    def address(self) -> int:
        """The address of the descriptor, for hosts in C."""
        return ctypes.addressof(self._model)

    def function(self, name: str) -> Any:
        """The C function of that name in the descriptor, for calls with addresses; the lookup is slow."""
        return getattr(self._model, name)

    def setup(self, p: ArrayLike | Mapping[str, float] | None = None, /, **named: float) -> Vector:
        """The constants k (nk,) that all other functions take, from the parameters.

        p: all parameters (np,) in SI units, in the order of `parameters`; or some of them by name, in a mapping or as
        keyword arguments: `setup(EI=30)`, `setup({"EI": 30})`. Those that are not given have their defaults.

        Raises UnknownNameError for a name that is not in `parameters`, ValueError on a wrong length, ModelError
        with the names of the parameters that the model refuses.
        """
        values = self.parameter_values(p, named)
        try:
            return constants_of(self.hash, self._call("setup", [(self.np, values)], self.nk))
        except ModelError as error:
            raise ModelError(f"{self.name}_setup", error.code, self._refused(values)) from None

    def _refused(self, values: Vector) -> list[str]:
        """The parameters whose values the model refuses even if all others have their defaults."""
        result = []
        for k in np.flatnonzero(values != self.defaults):
            trial = self.defaults.copy()
            trial[k] = values[k]
            try:
                self._call("setup", [(self.np, trial)], self.nk)
            except ModelError:
                result.append(f"{self.parameters[k]} = {values[k]:g}")
        return result

    def parameter_values(self, p: ArrayLike | Mapping[str, float] | None, named: Mapping[str, float]) -> Vector:
        """All parameters (np,): `p` as `setup` takes it, or the defaults, and those that are `named` instead."""
        if isinstance(p, Mapping):
            named = {**p, **named}
            p = None
        setup = f"{self.name}_setup"
        values = np.array(self.defaults if p is None else doubles(p, setup))
        for name, value in named.items():
            if name not in self.parameters:
                raise UnknownNameError(f"parameter of {self.name}", name, self.parameters)
            values[self.parameters.index(name)] = checked_number(value, setup)
        return values

    def mass(self, q: ArrayLike, k: ArrayLike) -> Vector:
        """Values of M(q), the lower triangle in the order of `mass_pattern`."""
        return self._call("mass", [(self.nq, q), (self.nk, self.own(k))], len(self.mass_pattern.rowidx))

    def force(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """h(t, q, v) (nv,)."""
        return self._call("force", [t, *self._state(q, v, self.own_at(t, k))], self.nv)

    def mass_force(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> tuple[Vector, Vector]:
        """Values of M, and h."""
        values, h = np.empty(len(self.mass_pattern.rowidx)), np.empty(self.nv)
        self._invoke("mass_force", self._model.mass_force, [t, *self._state(q, v, self.own_at(t, k))], [values, h])
        return values, h

    def accel(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """vdot (nv,) of M vdot + h = 0; of a scene with its constraint reactions."""
        return self._call("accel", [t, *self._state(q, v, self.own_at(t, k))], self.nv)

    def energy(self, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """Kinetic and strain energy, and the potential of gravity where there is gravity."""
        return self._call("energy", self._state(q, v, k), self._model.nenergy)

    def momentum(self, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """Linear and angular momentum in the inertial frame."""
        return self._call("momentum", self._state(q, v, k), self._model.nmomentum)

    def rates(self, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """qdot (nq,) of the generalised velocities v."""
        return self._call("rates", self._state(q, v, k), self.nq)

    def residual(self, t: float, y: ArrayLike, ydot: ArrayLike, k: ArrayLike) -> Vector:
        """F(t, y, ydot); of a scene that of index 3."""
        n = self.nq + self.nv + self.nlambda
        return self._call("residual", [t, (n, y), (n, ydot), (self.nk, self.own_at(t, k))], n)

    def jacobian(self, t: float, y: ArrayLike, ydot: ArrayLike, cj: float, k: ArrayLike) -> Vector:
        """Values of dF/dy + cj dF/dydot."""
        n = self.nq + self.nv + self.nlambda
        arguments = [t, (n, y), (n, ydot), cj, (self.nk, self.own_at(t, k))]
        return self._call("jacobian", arguments, len(self.jacobian_pattern.rowidx))

    def mass_batch(self, q: ArrayLike, k: ArrayLike, check: bool = True) -> Matrix:
        """Values of M (n, nnz) for each row of q (n, nq). The C takes structures of arrays: both are transposed.

        States that fail have NaN; `check`: ModelError.
        """
        return self._checked_batch("mass", [], [(self.nq, q)], k, len(self.mass_pattern.rowidx), check)

    def force_batch(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike, check: bool = True) -> Matrix:
        """h (n, nv) for each row of q (n, nq) and v (n, nv). States that fail have NaN; `check`: ModelError."""
        return self._checked_batch("force", [t], [(self.nq, q), (self.nv, v)], k, self.nv, check)

    def accel_batch(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike, check: bool = True) -> Matrix:
        """vdot (n, nv) for each row of q (n, nq) and v (n, nv). States that fail have NaN; `check`: ModelError."""
        return self._checked_batch("accel", [t], [(self.nq, q), (self.nv, v)], k, self.nv, check)

    def marker(self, name: str, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> tuple[Vector, Vector, Vector]:
        """Position (m), velocity (m/s) in the inertial frame, and values of the Jacobian of a marker.

        Raises UnknownNameError.
        """
        marker = self._marker(name)
        results = [np.empty(marker.dimension), np.empty(marker.dimension), np.empty(marker.pattern.contents.nnz)]
        self._invoke(f"marker_{name}", marker.evaluate, self._state(q, v, k), results)
        return results[0], results[1], results[2]

    def marker_positions(self, name: str, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Matrix:
        """Positions (n, dimension), m, of a marker for each row of q (n, nq) and v (n, nv): those of `marker`.

        Raises UnknownNameError, ModelError.
        """
        function, marker = f"marker_{name}", self._marker(name)
        qs, vs = (np.ascontiguousarray(checked_rows(n, x, function)) for n, x in ((self.nq, q), (self.nv, v)))
        constants = checked_vector(self.nk, self.own(k), function)
        result, xdot = np.empty((len(qs), marker.dimension)), np.empty(marker.dimension)
        jacobian = np.empty(marker.pattern.contents.nnz)
        rows = zip(
            *(range(x.ctypes.data, x.ctypes.data + x.nbytes, x.strides[0]) for x in (qs, vs, result)), strict=True
        )
        evaluate, others = marker.evaluate, (constants.ctypes.data, xdot.ctypes.data, jacobian.ctypes.data)
        for q_i, v_i, x_i in rows:  # a row takes a microsecond, and ten by `marker`
            if code := evaluate(q_i, v_i, others[0], x_i, *others[1:]):
                raise ModelError(f"{self.name}_{function}", code)
        return result

    def load(self, name: str, q: ArrayLike, force: ArrayLike, k: ArrayLike) -> Vector:
        """Generalised forces f (nv,) of a force (N) at a marker, given in the inertial frame: M vdot + h = f."""
        marker = self._marker(name)
        result = np.empty(self.nv)
        arguments = [(self.nq, q), (marker.dimension, force), (self.nk, self.own(k))]
        self._invoke(f"load_{name}", marker.load, arguments, [result])
        return result

    def marker_pattern(self, name: str) -> Pattern:
        """The pattern of the Jacobian of a marker."""
        return pattern_of(self._marker(name).pattern.contents)

    def _marker(self, name: str) -> Any:
        if name not in self.markers:
            raise UnknownNameError(f"marker of {self.name}", name, self.markers)
        return self._model.markers[self.markers.index(name)]

    def _state(self, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> list[Any]:
        return [(self.nq, q), (self.nv, v), (self.nk, self.own(k))]

    def own(self, k: ArrayLike) -> ArrayLike:
        """The constants as they are given. Raises ValueError if they come from the setup of another model."""
        return checked_origin(self.hash, self.name, k)

    def own_at(self, t: float, k: ArrayLike) -> ArrayLike:
        """The constants as functions of the time read them: with the inputs at t (s), where these follow functions."""
        return self.own(k)

    def _call(self, name: str, arguments: list[Any], size: int) -> Vector:
        result = np.empty(size)
        self._invoke(name, getattr(self._model, name), arguments, [result])
        return result

    def _invoke(self, name: str, function: Callable[..., int], arguments: list[Any], results: list[Vector]) -> None:
        invoke(f"{self.name}_{name}", function, arguments, results)

    def _checked_batch(
        self, kernel: str, t: list[float], states: list[tuple[int, ArrayLike]], k: ArrayLike, size: int, check: bool
    ) -> Matrix:
        result, code = self._batch(kernel, t, states, k, size)
        if code and check:
            raise ModelError(f"{self.name}_{kernel}_batch", code)
        return result

    def _batch(
        self, kernel: str, t: list[float], states: list[tuple[int, ArrayLike]], k: ArrayLike, size: int
    ) -> tuple[Matrix, int]:
        name = f"{kernel}_batch"
        rows = [checked_rows(columns, given, name) for columns, given in states]
        count = len(rows[0])
        if any(len(given) != count for given in rows):
            raise ValueError(f"{name}: {' and '.join(str(len(given)) for given in rows)} states do not go together")
        columns_first = [np.ascontiguousarray(given.T) for given in rows]
        result = np.empty((size, count))
        arrays = [*columns_first, checked_vector(self.nk, self.own(k), name), result]
        function: Callable[..., int] = getattr(self._model, name)
        code = function(count, *(checked_number(x, name) for x in t), *(a.ctypes.data for a in arrays))
        return np.ascontiguousarray(result.T), code
