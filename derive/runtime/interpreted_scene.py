"""A scene whose functions are interpreted instead of compiled, so that `build` needs no C compiler."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from derive.ir.interpreter import RequirementError, interpret
from derive.ir.model import Model, Variable
from derive.ir.patterns import Pattern
from derive.registry import UnknownNameError
from derive.roles import Role
from derive.runtime.native_call import Matrix, ModelError, Vector
from derive.runtime.native_scene import NativeScene


class InterpretedScene(NativeScene):
    """The functions of a NativeScene, slowly: one operation after the other in Python.

    Forms of the equations as a DAE other than that of index 3, batches and loads are not available.
    """

    def __init__(self, model: Model) -> None:
        self._kernels = model
        self.name, self.hash, self.is_scene = model.name, "", True
        self.nq, self.nv, self.np = len(model.coordinates), len(model.velocities), len(model.parameters)
        self.nk, self.nlambda = len(model.constants), len(model.multipliers)
        self.parameters, self.defaults = _names(model.parameters), np.array(model.defaults)
        self.coordinates, self.velocities = _names(model.coordinates), _names(model.velocities)
        self.roles = tuple(variable.role or Role.AMPLITUDE for variable in model.coordinates)
        self.multipliers, self.bodies, self.markers = _names(model.multipliers), model.bodies, _names(model.markers)
        self.mass_pattern, self.jacobian_pattern = model.pattern("mass", "M"), model.pattern("jacobian", "jac")
        self.constraint_pattern = model.pattern("constraint_jacobian", "G")

    def mass_force(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> tuple[Vector, Vector]:
        """Values of M, and h."""
        values, h = self._outputs("mass_force", [t, q, v, k])
        return values, h

    def energy(self, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """Kinetic and strain energy, and the potential of gravity where there is gravity."""
        return self._outputs("energy", [q, v, k])[0]

    def momentum(self, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Vector:
        """Linear and angular momentum in the inertial frame."""
        return self._outputs("momentum", [q, v, k])[0]

    def marker(self, name: str, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> tuple[Vector, Vector, Vector]:
        """Position, velocity and values of the Jacobian of a marker. Raises UnknownNameError."""
        if name not in self.markers:
            raise UnknownNameError(f"marker of {self.name}", name, self.markers)
        x, xdot, jacobian = self._outputs(f"marker_{name}", [q, v, k])
        return x, xdot, jacobian

    def marker_positions(self, name: str, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Matrix:
        """Positions (n, dimension) of a marker for each row of q and v."""
        states = zip(np.asarray(q), np.asarray(v), strict=True)
        return np.array([self.marker(name, q_i, v_i, k)[0] for q_i, v_i in states])

    def marker_pattern(self, name: str) -> Pattern:
        """The pattern of the Jacobian of a marker."""
        return self._kernels.pattern(f"marker_{name}", "jacobian")

    def solve(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> tuple[Vector, Vector]:
        """vdot and lambda."""
        vdot, multipliers = self._outputs("solve", [t, q, v, k])
        return vdot, multipliers

    def _call(self, name: str, arguments: list[Any], size: int) -> Vector:
        values = [a[1] if isinstance(a, tuple) else a for a in arguments]
        return self._outputs(name, values)[0]

    _ask = _call

    def _outputs(self, name: str, arguments: list[Any]) -> tuple[Vector, ...]:
        """The outputs of a function. Raises ModelError where the compiled function returns a code other than 0."""
        kernel = self._kernels.kernel(name)
        given = {
            a.name: float(value) if a.scalar else np.asarray(value, dtype=np.float64).tolist()
            for a, value in zip(kernel.arguments, arguments, strict=True)
        }
        try:
            outputs = interpret(kernel, given)
        except RequirementError as error:
            raise ModelError(f"{self.name}_{name}", error.code) from error
        return tuple(np.array(outputs[o.name], dtype=np.float64) for o in kernel.outputs)


def _names(variables: tuple[Variable, ...]) -> tuple[str, ...]:
    return tuple(variable.name for variable in variables)
