"""The functions of a compiled model, called through NumPy by means of its descriptor."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from derive.backends.c.optional_parts import OptionalPart
from derive.backends.c.source import ABI
from derive.ir.patterns import Pattern
from derive.registry import UnknownNameError
from derive.runtime.compiled_function import CompiledFunction
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
)
from derive.runtime.native_markers import NativeMarker, native_markers
from derive.runtime.requested_functions import RequestedFunctions
from derive.short_text import listed, summary


def cj_first(function: Callable[..., int]) -> Callable[..., int]:
    """The function jacobian(t, y, ydot, cj, k, values) with its numbers t, cj in front."""
    return lambda t, cj, y, ydot, k, values: function(t, y, ydot, cj, k, values)


class CompiledFunctions(dict[str, CompiledFunction]):
    """The functions of a model by their names. Raises CompilerError for one that its library does not have."""

    def __missing__(self, name: str) -> CompiledFunction:
        raise not_explicit(name)


def not_explicit(name: str) -> CompilerError:
    """The error of a call of a function that a model for explicit integration does not have."""
    return CompilerError(
        f"there is no {name} in this library, whose model is for explicit integration alone: `derive.lower` and "
        '`build` make complete ones, of long trees in relative coordinates with lowering = "flat"'
    )


NO_PATTERN = Pattern(0, 0, (0,), (), symmetric=False)
"""The pattern of a matrix that a model does not have."""


class Native(RequestedFunctions):
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

    def residual(self, t: float, y: ArrayLike, ydot: ArrayLike, k: ArrayLike, out: Vector | None = None) -> Vector:
        """The residual F(t, y, ydot) of the equations as a differential-algebraic equation, of the length of y.

        For a body y = [q; v]; for a scene y = [q; v; lambda], in the form of index 3.

        Examples:
            >>> y, ydot = [*q, *v], [*native.rates(q, v, k), *native.accel(0.0, q, v, k)]
            >>> bool(abs(native.residual(0.0, y, ydot, k)).max() < 1e-12)
            True
        """
        return self._compiled["residual"]((y, ydot, self.own_at(t, k)), t, out=out)

    def jacobian(
        self, t: float, y: ArrayLike, ydot: ArrayLike, cj: float, k: ArrayLike, out: Vector | None = None
    ) -> Vector:
        """Values of dF/dy + cj dF/dydot in the order of `jacobian_pattern`.

        Implicit methods choose the factor cj (1/s), which is that of a step.

        Examples:
            >>> y, ydot = [*q, *v], [*native.rates(q, v, k), *native.accel(0.0, q, v, k)]
            >>> native.jacobian_pattern.sparse(native.jacobian(0.0, y, ydot, 100.0, k)).shape
            (10, 10)
        """
        return self._compiled["jacobian"]((y, ydot, self.own_at(t, k)), t, cj, out=out)

    def parameter_jacobian(self, t: float, y: ArrayLike, ydot: ArrayLike, k: ArrayLike) -> Vector:
        """Values of the derivatives with respect to parameters and inputs [p; u], in the order of `parameter_pattern`.

        The rows are those of M vdot + h - G^T lambda, g, gdot, G vdot - gamma and the outputs; for a body, those
        of M vdot + h. t, y and ydot are fixed.

        Raises:
            CompilerError: if the model was generated without sensitivities.

        Examples:
            >>> y, ydot = [*q, *v], [*native.rates(q, v, k), *native.accel(0.0, q, v, k)]
            >>> derivatives = native.parameter_pattern.dense(native.parameter_jacobian(0.0, y, ydot, k))
            >>> derivatives[:, native.parameters.index("EI")].round(4)
            array([0.  , 0.  , 0.  , 1.44, 0.  ])
        """
        return self._of_sensitivities("parameter_jacobian")((y, ydot, self.own_at(t, k)), t)

    def solve_kkt(self, t: float, q: ArrayLike, k: ArrayLike, a: ArrayLike, b: ArrayLike = ()) -> tuple[Vector, Vector]:
        """The solution x (nv,), lambda (nlambda,) of M x - G^T lambda = a (nv,), G x = b (nlambda,).

        Raises:
            ModelError: if a pivot vanishes.
            CompilerError: if the model was generated without sensitivities.

        Examples:
            >>> x, multipliers = native.solve_kkt(0.0, q, k, [1, 0, 0, 0, 0])
            >>> x  # a force of 1 N on 1 kg
            array([1., 0., 0., 0., 0.])
        """
        x, lam = self._of_sensitivities("solve_kkt").results((q, self.own_at(t, k), a, b), t)
        return x, lam

    def _of_sensitivities(self, name: str) -> CompiledFunction:
        if self.parameter_pattern is None:
            raise CompilerError(f"{self.name} has no {name}; generate it with sensitivities")
        return self._compiled[name]

    def mass_batch(self, q: ArrayLike, k: ArrayLike, check: bool = True) -> Matrix:
        """Values of M (n, nnz) for each row of q. The C takes structures of arrays: both are transposed.

        Examples:
            >>> native.mass_batch([q, q, q], k).shape
            (3, 5)
        """
        (values,) = self._batch("mass", [], [(self.nq, q)], k, [len(self.mass_pattern.rowidx)], check)
        return values

    def force_batch(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike, check: bool = True) -> Matrix:
        """The vector h (n, nv) for each row of q and v.

        Examples:
            >>> native.force_batch(0.0, [q, q], [v, v], k).shape
            (2, 5)
        """
        (h,) = self._batch("force", [t], [(self.nq, q), (self.nv, v)], k, [self.nv], check)
        return h

    def mass_force_batch(
        self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike, check: bool = True
    ) -> tuple[Matrix, Matrix]:
        """Values of M (n, nnz), and h (n, nv), for each row of q and v.

        Examples:
            >>> M, h = native.mass_force_batch(0.0, [q, q], [v, v], k)
            >>> M.shape, h.shape
            ((2, 5), (2, 5))
        """
        sizes = [len(self.mass_pattern.rowidx), self.nv]
        values, h = self._batch("mass_force", [t], [(self.nq, q), (self.nv, v)], k, sizes, check)
        return values, h

    def accel_batch(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike, check: bool = True) -> Matrix:
        """The accelerations vdot (n, nv) for each row of q and v.

        Examples:
            >>> native.accel_batch(0.0, [q, q], [[0, 0, 3, 0, 0], [0, 0, 6, 0, 0]], k).round(2) + 0.0
            array([[   0.  ,    0.  ,    0.  , -215.91,    0.  ],
                   [   0.  ,    0.  ,    0.  , -215.64,    0.  ]])
        """
        (vdot,) = self._batch("accel", [t], [(self.nq, q), (self.nv, v)], k, [self.nv], check)
        return vdot

    def energy_batch(self, q: ArrayLike, v: ArrayLike, k: ArrayLike, check: bool = True) -> Matrix:
        """The energies of `energy` (n, energies), J, for each row of q and v.

        Examples:
            >>> native.energy_batch([q, q], [[0, 0, 3, 0, 0], [0, 0, 6, 0, 0]], k).round(4)
            array([[0.3751, 0.216 ],
                   [1.5004, 0.216 ]])
        """
        (energies,) = self._batch("energy", [], [(self.nq, q), (self.nv, v)], k, [self._model.nenergy], check)
        return energies

    def momentum_batch(self, q: ArrayLike, v: ArrayLike, k: ArrayLike, check: bool = True) -> Matrix:
        """The momenta of `momentum` (n, momenta) for each row of q and v.

        Examples:
            >>> native.momentum_batch([q], [v], k).round(4)
            array([[0.    , 0.    , 0.2501]])
        """
        (momenta,) = self._batch("momentum", [], [(self.nq, q), (self.nv, v)], k, [self._model.nmomentum], check)
        return momenta

    def rates_batch(self, q: ArrayLike, v: ArrayLike, k: ArrayLike, check: bool = True) -> Matrix:
        """The rates qdot (n, nq) for each row of q and v.

        Examples:
            >>> native.rates_batch([q], [v], k)
            array([[0., 0., 3., 0., 0.]])
        """
        (qdot,) = self._batch("rates", [], [(self.nq, q), (self.nv, v)], k, [self.nq], check)
        return qdot

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

    def _batch(
        self,
        kernel: str,
        t: list[float],
        states: list[tuple[int, ArrayLike]],
        k: ArrayLike,
        sizes: list[int],
        check: bool,
        holder: Any = None,
    ) -> list[Matrix]:
        name = f"{kernel}_batch"
        rows = [checked_rows(columns, given, name) for columns, given in states]
        count = len(rows[0])
        if any(len(given) != count for given in rows):
            raise ValueError(f"{name}: {' and '.join(str(len(given)) for given in rows)} states do not go together")
        columns_first = [np.ascontiguousarray(given.T) for given in rows]
        results = [np.empty((size, count)) for size in sizes]
        arrays = [*columns_first, checked_vector(self.nk, self.own(k), name), *results]
        function: Callable[..., int] | None = getattr(holder or self._model, name)  # a null pointer is false
        if not function:
            macro = OptionalPart.BATCHES.value
            raise CompilerError(f"{self.name}_{name} is not in this library, whose C was compiled with {macro}")
        code = function(count, *(checked_number(x, name) for x in t), *(a.ctypes.data for a in arrays))
        if code and check:
            raise ModelError(f"{self.name}_{name}", code)
        return [np.ascontiguousarray(result.T) for result in results]

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
