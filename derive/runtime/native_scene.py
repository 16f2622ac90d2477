"""The functions of a compiled scene or body: those of a model, its constraints, and its forms as a DAE."""

from __future__ import annotations

import ctypes
from copy import copy
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from derive.backends.c.optional_parts import OptionalPart
from derive.ir.patterns import Pattern
from derive.runtime.compiled_function import CompiledFunction, not_explicit
from derive.runtime.compiled_model import Native, cj_first
from derive.runtime.compiler import CompilerError
from derive.runtime.descriptor import DaeStruct, names_of, pattern_of
from derive.runtime.native_call import Matrix, Vector, checked_vector, constants_of


class Dae:
    """One form F(t, y, ydot) = 0 of a scene's equations; `pattern` is that of its iteration matrix."""

    def __init__(self, form: DaeStruct, scene: Native) -> None:
        self._scene = scene
        self.name, self.size = form.name.decode(), form.size
        self.pattern = pattern_of(form.pattern.contents)
        called, inputs = f"{scene.name}, form {self.name}: ", (self.size, self.size, scene.nk)
        build, nnz = (scene.hash, scene.name), len(self.pattern.rowidx)
        self._residual = CompiledFunction(f"{called}residual", form.residual, inputs, (self.size,), build)
        self._jacobian = CompiledFunction(f"{called}jacobian", form.jacobian, inputs, (nnz,), build, order=cj_first)

    def of(self, scene: Native) -> Dae:
        """A copy of this form for a scene with other constants at a time, see `Native.own_at`."""
        form = copy(self)
        form._scene = scene
        return form

    def residual(self, t: float, y: ArrayLike, ydot: ArrayLike, k: ArrayLike, out: Vector | None = None) -> Vector:
        """The residual F(t, y, ydot)."""
        return self._residual((y, ydot, self._scene.own_at(t, k)), t, out=out)

    def jacobian(
        self, t: float, y: ArrayLike, ydot: ArrayLike, cj: float, k: ArrayLike, out: Vector | None = None
    ) -> Vector:
        """Values of dF/dy + cj dF/dydot."""
        return self._jacobian((y, ydot, self._scene.own_at(t, k)), t, cj, out=out)


class Forms(dict[str, Dae]):
    """The forms of a scene by their names. Raises CompilerError for one that its library does not have."""

    def __missing__(self, name: str) -> Dae:
        if not self:
            raise not_explicit(f"form {name}")
        raise CompilerError(
            f"the form {name} is not in this library, which has {', '.join(self)}: forms of reduced index are left out "
            f"where the C is compiled with {OptionalPart.REDUCED_FORMS.value}, as simulations do; `load_scene` does not"
        )


NONE = np.zeros(0)
PLANAR_POSE, SPATIAL_POSE = 3, 12


class NativeScene(Native):
    """A compiled scene: M vdot + h = G^T lambda with constraints g(t, q) = 0, and qdot = rates(q, v).

    A body that moves alone is a scene without constraints, inputs and outputs; `bodies` and `dae` are empty. Besides
    the names of `Native` it has those of `multipliers`, `bodies`, `inputs` and `outputs`, the patterns
    `constraint_pattern` and `outputs_pattern`, and its forms of reduced index in `dae`. `proximal` is true where
    constraints may be redundant, since the multipliers are then those of least norm; `in_space` where bodies are in
    space.

    Arguments:
        t: the time, s.
        q: the coordinates (nq,).
        v: the generalised velocities (nv,).
        vdot: the accelerations (nv,).
        lam: the multipliers (nlambda,).
        k: the constants (nk,) of `setup`.

    Raises:
        ModelError: when the model returns a code other than 0.
        ValueError: on a wrong length, and for constants of another model.

    Examples:
        >>> import derive
        >>> points = {"top": (0, 0.5), "tip": (0, -0.5)}
        >>> pendulum = derive.scene(
        ...     "pendulum",
        ...     gravity=(0, -9.81),
        ...     ground={"pivot": (0, 0)},
        ...     bodies={"rod": {"mass": 1, "inertia": "1/12", "markers": points, "keep_coordinates": True}},
        ...     joints={"hinge": {"kind": "revolute", "between": ["ground.pivot", "rod.top"]}},
        ...     inputs={"motor": {"value": 0}},
        ...     torques={"drive": {"at": "rod.top", "value": {"input": "motor"}}},
        ...     outputs={"tip": {"kind": "velocity", "marker": "rod.tip"}},
        ... )
        >>> native = derive.load_scene(derive.model_files(derive.lower(derive.derive(pendulum)), pendulum))
        >>> native.coordinates, native.multipliers
        (('rod_c1', 'rod_c2', 'rod_phi'), ('hinge_1', 'hinge_2'))
        >>> k = native.setup()
        >>> q, v = [0, -0.5, 0], [1, 0, 2]
        >>> vdot, lam = native.solve(0.0, q, v, k)
        >>> lam.round(3) + 0.0  # weight and centripetal force, N
        array([ 0.  , 11.81])
    """

    def __init__(self, library: ctypes.CDLL, name: str) -> None:
        """proximal: whether constraints may be redundant, since the multipliers are those of least norm.

        in_space: whether the bodies of a scene are in space.
        """
        super().__init__(library, name)
        self.proximal = hasattr(library, f"{name}_proximal")
        self.in_space = hasattr(library, f"{name}_in_space")
        self.multipliers: tuple[str, ...] = ()
        self.bodies: tuple[str, ...] = ()
        self.constraint_pattern = Pattern(0, self.nv, (0,) * (self.nv + 1), (), symmetric=False)
        self.inputs: tuple[str, ...] = ()
        self.outputs: tuple[str, ...] = ()
        self.output_units: tuple[str, ...] = ()
        self.outputs_pattern: Pattern | None = None
        self.dae = Forms()
        if self.is_scene:
            self._prepare(self._model.scene.contents)
        if self._model.ports:
            self._prepare_ports(self._model.ports.contents)

    @property
    def pose_size(self) -> int:
        """The number of values of a pose."""
        return SPATIAL_POSE if self.in_space else PLANAR_POSE

    def _prepare(self, s: Any) -> None:
        """Prepare the names, the pattern and the functions of a scene."""
        self.multipliers = names_of(s.multipliers, self.nlambda)
        self.bodies = tuple(s.bodies[i].decode() for i in range(s.nbodies))
        self.constraint_pattern = pattern_of(s.pattern.contents)
        self.dae = Forms({form.name: form for form in (Dae(s.forms[i], self) for i in range(s.nforms))})
        at_position, state, n = (self.nq, self.nk), (self.nq, self.nv, self.nk), self.nlambda
        self._add(s, "constraints", at_position, (n,))
        self._add(s, "constraint_jacobian", at_position, (len(self.constraint_pattern.rowidx),))
        self._add(s, "poses", at_position, (self.pose_size * len(self.bodies),))
        self._add(s, "constraint_rates", state, (n,))
        self._add(s, "constraint_bias", state, (n,))
        self._add(s, "solve", state, (self.nv, n))
        self._add(s, "project_velocity", (self.nq, self.nk, n), (self.nv,), constants=1)

    def _prepare_ports(self, ports: Any) -> None:
        """Prepare the names, the pattern and the functions of run-time inputs and outputs."""
        self.inputs = names_of(ports.u, ports.nu)
        self.outputs = names_of(ports.out, ports.nout)
        self.output_units = tuple(ports.out[i].unit.decode() for i in range(ports.nout))
        full = self.nq, self.nv, self.nv, self.nlambda, self.nk
        if self.outputs:
            self._add(ports, "outputs", full, (len(self.outputs),))
        if ports.pattern:
            self.outputs_pattern = pattern_of(ports.pattern.contents)
            self._add(ports, "outputs_jacobian", full, (len(self.outputs_pattern.rowidx),))

    def constraints(self, t: float, q: ArrayLike, k: ArrayLike) -> Vector:
        """The constraints g(t, q) (nlambda,), m or rad.

        Examples:
            >>> native.constraints(0.0, q, k)
            array([0., 0.])
        """
        if not self.nlambda:
            return NONE
        return self._compiled["constraints"]((q, self.own_at(t, k)), t)

    def constraint_rates(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """The rates of the constraints, gdot = G v + dg/dt (nlambda,), m/s or rad/s.

        Examples:
            >>> native.constraint_rates(0.0, q, v, k)
            array([0., 0.])
        """
        if not self.nlambda:
            return NONE
        return self._compiled["constraint_rates"]((q, v, self.own_at(t, k)), t)

    def constraint_jacobian(self, t: float, q: ArrayLike, k: ArrayLike) -> Vector:
        """Values of the constraint Jacobian G by columns, in the order of `constraint_pattern`.

        Examples:
            >>> native.constraint_pattern.dense(native.constraint_jacobian(0.0, q, k)) + 0.0
            array([[ 1. ,  0. , -0.5],
                   [ 0. ,  1. ,  0. ]])
        """
        if not self.nlambda:
            return NONE
        return self._compiled["constraint_jacobian"]((q, self.own_at(t, k)), t)

    def constraint_bias(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """The vector gamma (nlambda,) of G vdot = gamma, m/s^2 or rad/s^2.

        Examples:
            >>> native.constraint_bias(0.0, q, v, k) + 0.0
            array([0., 2.])
        """
        return self._compiled["constraint_bias"]((q, v, self.own_at(t, k)), t)

    def solve(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> tuple[Vector, Vector]:
        """The accelerations vdot (nv,), and the constraint reactions lambda (nlambda,) on body 2 of each joint.

        Examples:
            >>> vdot, lam = native.solve(0.0, q, v, k)
            >>> vdot.round(6) + 0.0, lam.round(3) + 0.0
            (array([0., 2., 0.]), array([ 0.  , 11.81]))
        """
        if not self.is_scene:
            return self.accel(t, q, v, k), NONE
        vdot, multipliers = self._compiled["solve"].results((q, v, self.own_at(t, k)), t)
        return vdot, multipliers

    def project_velocity(self, t: float, q: ArrayLike, k: ArrayLike, r: ArrayLike) -> Vector:
        """The smallest change dv (nv,) of the velocities, measured by dv . M dv, with G dv = r (nlambda,).

        Examples:
            >>> native.project_velocity(0.0, q, k, [0.1, 0]).round(4) + 0.0
            array([ 0.025,  0.   , -0.15 ])
        """
        if not self.nlambda:
            return np.zeros(self.nv)
        return self._compiled["project_velocity"]((q, self.own_at(t, k), r), t)

    def poses(self, t: float, q: ArrayLike, k: ArrayLike) -> Matrix:
        """The poses of the frame of each body in `bodies`: c1, c2 (m) and phi (rad), (bodies, 3).

        In space c1, c2, c3 (m) and the rotation tensor by rows, (bodies, 12).

        Examples:
            >>> native.poses(0.0, q, k)
            array([[ 0. , -0.5,  0. ]])
        """
        return self._compiled["poses"]((q, self.own_at(t, k)), t).reshape(-1, self.pose_size)

    def inputs_at(self, t: float) -> Vector:
        """The inputs u (inputs,) at a time t (s), where they follow functions; otherwise zeros.

        Examples:
            >>> native.inputs_at(0.0)
            array([0.])
        """
        return np.zeros(len(self.inputs))

    def with_inputs(self, k: ArrayLike, u: ArrayLike) -> Vector:
        """The constants k (nk,) with the inputs u (inputs,) behind them, where all functions read them.

        Examples:
            >>> vdot, lam = native.solve(0.0, q, [0, 0, 0], native.with_inputs(k, [2.0]))
            >>> vdot.round(6) + 0.0  # a torque of 2 N m on 1/3 kg m^2
            array([3., 0., 6.])
        """
        result = np.array(checked_vector(self.nk, self.own(k), "k"))
        result[self.nk - len(self.inputs) :] = checked_vector(len(self.inputs), u, "u")
        return constants_of(self.hash, result)

    def evaluate_outputs(
        self, t: float, q: ArrayLike, v: ArrayLike, vdot: ArrayLike, lam: ArrayLike, k: ArrayLike
    ) -> Vector:
        """The values of `outputs` in their `output_units`, from a state with accelerations and multipliers of `solve`.

        Examples:
            >>> native.outputs, native.output_units
            (('tip_1', 'tip_2'), ('m/s', 'm/s'))
            >>> native.evaluate_outputs(0.0, q, v, vdot, lam, k).round(4)
            array([2., 0.])
        """
        return self._port("outputs", (q, v, vdot, lam, self.own_at(t, k)), t)

    def outputs_jacobian(
        self, t: float, q: ArrayLike, v: ArrayLike, vdot: ArrayLike, lam: ArrayLike, k: ArrayLike
    ) -> Vector:
        """Values of the derivatives of the outputs by [q; v; vdot; lambda; u], in the order of `outputs_pattern`.

        Examples:
            >>> values = native.outputs_jacobian(0.0, q, v, vdot, lam, k)
            >>> derivatives = native.outputs_pattern.dense(values)
            >>> derivatives[0, 3:6]  # of the velocity of the tip by that of the rod
            array([1. , 0. , 0.5])
        """
        return self._port("outputs_jacobian", (q, v, vdot, lam, self.own_at(t, k)), t)

    def _port(self, name: str, arrays: tuple[ArrayLike, ...], t: float) -> Vector:
        return self._compiled[name](arrays, t) if self.outputs else np.empty(0)
