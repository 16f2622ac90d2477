"""The functions of a compiled model, called through NumPy by means of its descriptor."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from derive.backends.c.source import ABI
from derive.ir.patterns import Pattern
from derive.registry import UnknownNameError
from derive.runtime.batched_functions import BatchedFunctions
from derive.runtime.compiled_function import CompiledFunction, CompiledFunctions
from derive.runtime.compiler import CompilerError
from derive.runtime.descriptor import ModelStruct, names_of, pattern_of, roles_of
from derive.runtime.implicit_functions import ImplicitFunctions
from derive.runtime.marker_functions import MarkerFunctions
from derive.runtime.native_call import (
    ModelError,
    Vector,
    checked_number,
    checked_origin,
    constants_of,
    doubles,
)
from derive.runtime.native_markers import native_markers
from derive.runtime.requested_functions import RequestedFunctions
from derive.short_text import listed, summary


def cj_first(function: Callable[..., int]) -> Callable[..., int]:
    """The function jacobian(t, y, ydot, cj, k, values) with its numbers t, cj in front."""
    return lambda t, cj, y, ydot, k, values: function(t, y, ydot, cj, k, values)


NO_PATTERN = Pattern(0, 0, (0,), (), symmetric=False)
"""The pattern of a matrix that a model does not have."""


class Native(ImplicitFunctions, BatchedFunctions, MarkerFunctions, RequestedFunctions):
    """A compiled model. Arrays are vectors of doubles in SI units; matrices come as the values of their pattern.

    The pattern makes a matrix of them, dense or in SciPy's compressed columns: `native.mass_pattern.dense(values)`,
    `native.jacobian_pattern.sparse(values)`. `coordinates`, `velocities`, `parameters` and `markers` are names, `nq`,
    `nv`, `np`, `nk` and `nlambda` sizes; `defaults` are the parameters p (np,) that `setup` takes by default.

    A call with the same arrays as the last one, whose values may have changed, takes about a microsecond and allocates
    nothing; new arrays, lists and slices take a few: see `CompiledFunction`. The functions share these arguments;
    batches take matrices with a row for each state, and have NaN for states that fail:

    Arguments:
        t: the time, s.
        q: the coordinates (nq,), in batches (n, nq).
        v: the generalised velocities (nv,), in batches (n, nv).
        y: the state [q; v; lambda] (nq + nv + nlambda,) of the model as a differential-algebraic equation.
        ydot: its time derivative, of the same length.
        k: the constants (nk,) of `setup`.
        out: an array of doubles that the result is written into, and that is returned; a new one by default.
        check: whether a batch raises ModelError if a state fails.

    Raises:
        ModelError: when the model returns a code other than 0.
        ValueError: on a wrong length, and for constants of another model.
        CompilerError: for a function that the library does not have, such as one of sensitivities.

    Examples:
        >>> import derive
        >>> beam = derive.planar_beam("beam", markers={"tip": 1})
        >>> model = derive.lower(derive.derive(beam), sensitivities=True)
        >>> native = derive.load(derive.model_files(model, beam))
        >>> native.coordinates
        ('c1', 'c2', 'phi', 'alpha1', 'alpha2')
        >>> k = native.setup(EI=30)
        >>> q, v = [0, 0, 0.5, 0.01, 0], [0, 0, 3, 0, 0]
        >>> native.mass_pattern.dense(native.mass(q, k)).diagonal().round(4)
        array([1.    , 1.    , 0.0834, 0.2   , 0.1429])
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
        self.jacobian_pattern = pattern_of(m.jacobian_pattern.contents) if m.jacobian_pattern else NO_PATTERN
        self._marker_of = native_markers(library, m, name)
        self.markers = tuple(self._marker_of)
        state, n, nnz = (m.nq, m.nv, m.nk), m.nq + m.nv + m.nlambda, len(self.mass_pattern.rowidx)
        self._compiled = CompiledFunctions()
        self._add(m, "setup", (m.np,), (m.nk,), constants=None)
        self._add(m, "mass", (m.nq, m.nk), (nnz,))
        self._add(m, "mass_force", state, (nnz, m.nv))
        for member, size in (
            ("force", m.nv),
            ("accel", m.nv),
            ("energy", m.nenergy),
            ("momentum", m.nmomentum),
            ("rates", m.nq),
        ):
            self._add(m, member, state, (size,))
        self._add(m, "residual", (n, n, m.nk), (n,))
        self._add(m, "jacobian", (n, n, m.nk), (len(self.jacobian_pattern.rowidx),), order=cj_first)
        self.parameter_pattern = pattern_of(m.parameter_pattern.contents) if m.parameter_pattern else None
        if self.parameter_pattern:
            self._add(m, "parameter_jacobian", (n, n, m.nk), (len(self.parameter_pattern.rowidx),))
            self._add(m, "solve_kkt", (m.nq, m.nk, m.nv, m.nlambda), (m.nv, m.nlambda), constants=1)
        for point, marker in self._marker_of.items():
            dimension, of = marker.dimension, marker.holder
            results = dimension, dimension, marker.size
            self._add(of, "evaluate", state, results, f"marker_{point}", order=marker.bound)
            self._add(of, "load", (m.nq, dimension, m.nk), (m.nv,), f"load_{point}", order=marker.bound)
        self._add_requested(m)

    def _add(
        self,
        holder: Any,
        member: str,
        inputs: Sequence[int],
        results: Sequence[int],
        name: str = "",
        constants: int | None = -1,
        order: Callable[[Callable[..., int]], Callable[..., int]] = lambda function: function,
    ) -> None:
        """Prepare a function, which is a member of a structure, unless it is left out.

        constants: which of the inputs are those of `setup`, if any.
        """
        name, build = name or member, None if constants is None else (self.hash, self.name)
        if function := getattr(holder, member):
            called = f"{self.name}_{name}"
            self._compiled[name] = CompiledFunction(called, function, inputs, results, build, constants or 0, order)

    @property
    def address(self) -> int:
        """The address of the descriptor, for hosts in C."""
        return ctypes.addressof(self._model)

    def function(self, name: str) -> Any:
        """The C function of that name in the descriptor, for calls with addresses; the lookup is slow.

        Examples:
            >>> native.function("mass") is not None
            True
        """
        return getattr(self._model, name)

    def setup(self, p: ArrayLike | Mapping[str, float] | None = None, /, **named: float) -> Vector:
        """The constants k (nk,) that all other functions take, from the parameters.

        Arguments:
            p: all parameters (np,) in SI units, in the order of `parameters`; or a mapping of some of them by name, as
                {"EI": 30}. Those that are not given have their defaults.
            named: parameters by name, such as EI=30.

        Raises:
            UnknownNameError: for a name that is not in `parameters`.
            ValueError: on a wrong length.
            ModelError: with the names of the parameters that the model refuses.

        Examples:
            >>> native.parameters, native.defaults
            (('m', 'l', 'EI'), array([1., 1., 1.]))
            >>> bool((native.setup(EI=60) == native.setup({"EI": 60})).all())
            True
        """
        values = self.parameter_values(p, named)
        try:
            return constants_of(self.hash, self._compiled["setup"]((values,)))
        except ModelError as error:
            raise ModelError(f"{self.name}_setup", error.code, self._refused(values)) from None

    def _refused(self, values: Vector) -> list[str]:
        """The parameters whose values the model refuses even if all others have their defaults."""
        result = []
        for k in np.flatnonzero(values != self.defaults):
            trial = self.defaults.copy()
            trial[k] = values[k]
            try:
                self._compiled["setup"]((trial,))
            except ModelError:
                result.append(f"{self.parameters[k]} = {values[k]:g}")
        return result

    def parameter_values(self, p: ArrayLike | Mapping[str, float] | None, named: Mapping[str, float]) -> Vector:
        """All parameters (np,): `p` as `setup` takes it, or the defaults, and those that are `named` instead.

        Raises:
            UnknownNameError: for a name that is not in `parameters`.
            ValueError: for a value that is not a number.

        Examples:
            >>> native.parameter_values(None, {"EI": 30})
            array([ 1.,  1., 30.])
        """
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

    def mass(self, q: ArrayLike, k: ArrayLike, out: Vector | None = None) -> Vector:
        """Values (nnz,) of M(q), the lower triangle in the order of `mass_pattern`.

        The unit of an entry is that of a force of its row over an acceleration of its column: kg, kg m or kg m^2.

        Examples:
            >>> native.mass_pattern.dense(native.mass(q, k)).diagonal().round(4)
            array([1.    , 1.    , 0.0834, 0.2   , 0.1429])
        """
        return self._compiled["mass"]((q, k), out=out)

    def force(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike, out: Vector | None = None) -> Vector:
        """The vector h(t, q, v) (nv,) of M vdot + h = 0, N and N m.

        Examples:
            >>> native.force(0.0, q, v, k).round(2) + 0.0  # stiffness less the centrifugal force of the first shape
            array([ 0.  ,  0.  ,  0.  , 43.18,  0.  ])
        """
        return self._compiled["force"].at(t, q, v, self.own_at(t, k), out)

    def mass_force(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> tuple[Vector, Vector]:
        """Values (nnz,) of M as those of `mass`, and h (nv,) as that of `force`, for little more than the time of one.

        Examples:
            >>> M, h = native.mass_force(0.0, q, v, k)
            >>> len(M), len(h)
            (5, 5)
        """
        values, h = self._compiled["mass_force"].results((q, v, self.own_at(t, k)), t)
        return values, h

    def accel(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike, out: Vector | None = None) -> Vector:
        """The accelerations vdot (nv,) of M vdot + h = 0, SI units; those of a scene include its constraint reactions.

        Examples:
            >>> native.accel(0.0, q, v, k).round(2) + 0.0
            array([   0.  ,    0.  ,    0.  , -215.91,    0.  ])
        """
        return self._compiled["accel"].at(t, q, v, self.own_at(t, k), out)

    def energy(self, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """Kinetic and strain energy, and the potential of gravity where there is gravity, J.

        Examples:
            >>> native.energy(q, v, k).round(4)  # 1/2 J phidot^2 and 1/2 K alpha1^2
            array([0.3751, 0.216 ])
        """
        return self._compiled["energy"]((q, v, k))

    def momentum(self, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """Linear momentum (kg m/s) and angular momentum (kg m^2/s) about the origin, in the inertial frame.

        They have 2 + 1 elements in the plane and 3 + 3 in space.

        Examples:
            >>> native.momentum(q, v, k).round(4)
            array([0.    , 0.    , 0.2501])
        """
        return self._compiled["momentum"]((q, v, k))

    def rates(self, q: ArrayLike, v: ArrayLike, k: ArrayLike, out: Vector | None = None) -> Vector:
        """The rates qdot (nq,) of the coordinates, from the generalised velocities v; both differ in space.

        Examples:
            >>> native.rates(q, v, k)
            array([0., 0., 3., 0., 0.])
        """
        return self._compiled["rates"]((q, v, k), out=out)

    def own(self, k: ArrayLike) -> ArrayLike:
        """The constants as they are given. Raises ValueError if they come from the setup of another model.

        Examples:
            >>> native.own(k) is k
            True
        """
        return checked_origin(self.hash, self.name, k)

    def own_at(self, t: float, k: ArrayLike) -> ArrayLike:
        """The constants for functions that depend on t (s): with the inputs at t, where these follow functions.

        Examples:
            >>> native.own_at(0.0, k) is k
            True
        """
        return k

    def __repr__(self) -> str:
        head = f"{type(self).__name__} {self.name}: nq = {self.nq}, nv = {self.nv}, np = {self.np}"
        constrained = f", nlambda = {self.nlambda}" if self.is_scene else ""
        return summary(
            f"{head}{constrained}",
            {"coordinates": listed(self.coordinates), "parameters": listed(self.parameters)},
        )


def add_jacobian(native: Native, pattern: Pattern, jacobian: CompiledFunction) -> None:
    """Give compiled functions the iteration matrix, which their library does without, from elsewhere."""
    native.jacobian_pattern = pattern
    native._compiled["jacobian"] = jacobian
