"""The functions of a compiled scene: those of a model, its constraints, and its forms as a DAE."""

from __future__ import annotations

import ctypes
from copy import copy
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from derive.runtime.compiled_model import Native
from derive.runtime.descriptor import DaeStruct, names_of, pattern_of
from derive.runtime.native_call import Matrix, Vector, checked_vector, constants_of, invoke


class Dae:
    """One form F(t, y, ydot) = 0 of a scene's equations; `pattern` is that of its iteration matrix."""

    def __init__(self, form: DaeStruct, scene: Native) -> None:
        self._form, self._scene = form, scene
        self.name, self.size = form.name.decode(), form.size
        self.pattern = pattern_of(form.pattern.contents)
        self._called = f"{scene.name}, form {self.name}: "

    def of(self, scene: Native) -> Dae:
        """The same form for a scene with other constants at a time, see `Native.own_at`."""
        form = copy(self)
        form._scene = scene
        return form

    def residual(self, t: float, y: ArrayLike, ydot: ArrayLike, k: ArrayLike) -> Vector:
        """F(t, y, ydot)."""
        result = np.empty(self.size)
        invoke(
            f"{self._called}residual",
            self._form.residual,
            [t, *self._state(y, ydot), (self._scene.nk, self._scene.own_at(t, k))],
            [result],
        )
        return result

    def jacobian(self, t: float, y: ArrayLike, ydot: ArrayLike, cj: float, k: ArrayLike) -> Vector:
        """Values of dF/dy + cj dF/dydot."""
        result = np.empty(len(self.pattern.rowidx))
        arguments = [t, *self._state(y, ydot), cj, (self._scene.nk, self._scene.own_at(t, k))]
        invoke(f"{self._called}jacobian", self._form.jacobian, arguments, [result])
        return result

    def _state(self, y: ArrayLike, ydot: ArrayLike) -> list[Any]:
        return [(self.size, y), (self.size, ydot)]


class NativeScene(Native):
    """A compiled scene: M vdot + h = G^T lambda with constraints g(t, q) = 0."""

    def __init__(self, library: ctypes.CDLL, name: str) -> None:
        super().__init__(library, name)
        self._scene = s = self._model.scene.contents
        self.multipliers = names_of(s.multipliers, self.nlambda)
        self.bodies = tuple(s.bodies[i].decode() for i in range(s.nbodies))
        self.constraint_pattern = pattern_of(s.pattern.contents)
        ports = self._ports = self._model.ports.contents if self._model.ports else None
        self.inputs = names_of(ports.u, ports.nu) if ports else ()
        self.outputs = names_of(ports.out, ports.nout) if ports else ()
        self.output_units = tuple(ports.out[i].unit.decode() for i in range(ports.nout)) if ports else ()
        self.outputs_pattern = pattern_of(ports.pattern.contents) if ports and self.outputs else None
        self.dae = {form.name: form for form in (Dae(s.forms[i], self) for i in range(s.nforms))}

    def constraints(self, t: float, q: ArrayLike, k: ArrayLike) -> Vector:
        """g(t, q)."""
        return self._ask("constraints", [t, (self.nq, q), (self.nk, self.own_at(t, k))], self.nlambda)

    def constraint_rates(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """gdot = G v + dg/dt."""
        return self._ask("constraint_rates", [t, *self._state(q, v, self.own_at(t, k))], self.nlambda)

    def constraint_jacobian(self, t: float, q: ArrayLike, k: ArrayLike) -> Vector:
        """Values of G by columns."""
        size = len(self.constraint_pattern.rowidx)
        return self._ask("constraint_jacobian", [t, (self.nq, q), (self.nk, self.own_at(t, k))], size)

    def constraint_bias(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """gamma of G vdot = gamma."""
        return self._ask("constraint_bias", [t, *self._state(q, v, self.own_at(t, k))], self.nlambda)

    def solve(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> tuple[Vector, Vector]:
        """vdot (nv,) and lambda (nlambda,), the constraint reactions on body 2 of each joint."""
        vdot, multipliers = np.empty(self.nv), np.empty(self.nlambda)
        invoke(f"{self.name}_solve", self._scene.solve, [t, *self._state(q, v, self.own_at(t, k))], [vdot, multipliers])
        return vdot, multipliers

    def project_velocity(self, t: float, q: ArrayLike, k: ArrayLike, r: ArrayLike) -> Vector:
        """The smallest change dv (nv,) of the velocities, measured by dv . M dv, with G dv = r (nlambda,)."""
        return self._ask(
            "project_velocity", [t, (self.nq, q), (self.nk, self.own_at(t, k)), (self.nlambda, r)], self.nv
        )

    def poses(self, t: float, q: ArrayLike, k: ArrayLike) -> Matrix:
        """c1, c2 (m) and phi (rad) of the frame of each body in `bodies`, (bodies, 3)."""
        return self._ask("poses", [t, (self.nq, q), (self.nk, self.own_at(t, k))], 3 * len(self.bodies)).reshape(-1, 3)

    def inputs_at(self, t: float) -> Vector:
        """The inputs u (inputs,) at a time, where they follow functions; otherwise zeros."""
        return np.zeros(len(self.inputs))

    def with_inputs(self, k: ArrayLike, u: ArrayLike) -> Vector:
        """The constants k (nk,) with the inputs u (inputs,) behind them, where all functions read them."""
        result = np.array(checked_vector(self.nk, self.own(k), "k"))
        result[self.nk - len(self.inputs) :] = checked_vector(len(self.inputs), u, "u")
        return constants_of(self.hash, result)

    def evaluate_outputs(
        self, t: float, q: ArrayLike, v: ArrayLike, vdot: ArrayLike, lam: ArrayLike, k: ArrayLike
    ) -> Vector:
        """The values of `outputs`, from a state with its accelerations and multipliers as `solve` computes them."""
        return self._port(
            "outputs", [t, *self._full_state(q, v, vdot, lam), (self.nk, self.own_at(t, k))], len(self.outputs)
        )

    def outputs_jacobian(
        self, t: float, q: ArrayLike, v: ArrayLike, vdot: ArrayLike, lam: ArrayLike, k: ArrayLike
    ) -> Vector:
        """Values of the derivatives of the outputs by [q; v; vdot; lambda; u], in the order of `outputs_pattern`."""
        size = len(self.outputs_pattern.rowidx) if self.outputs_pattern else 0
        return self._port(
            "outputs_jacobian", [t, *self._full_state(q, v, vdot, lam), (self.nk, self.own_at(t, k))], size
        )

    def _full_state(self, q: ArrayLike, v: ArrayLike, vdot: ArrayLike, lam: ArrayLike) -> list[Any]:
        return [(self.nq, q), (self.nv, v), (self.nv, vdot), (self.nlambda, lam)]

    def _port(self, name: str, arguments: list[Any], size: int) -> Vector:
        result = np.empty(size)
        if size:
            invoke(f"{self.name}_{name}", getattr(self._ports, name), arguments, [result])
        return result

    def _ask(self, name: str, arguments: list[Any], size: int) -> Vector:
        result = np.empty(size)
        invoke(f"{self.name}_{name}", getattr(self._scene, name), arguments, [result])
        return result
