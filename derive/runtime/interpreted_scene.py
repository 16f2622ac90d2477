"""A scene whose functions are interpreted instead of compiled, so that `build` needs no C compiler."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from derive.ir.interpreter import RequirementError, check_requirement, interpret
from derive.ir.kernel import Kernel
from derive.ir.model import JACOBIAN, Model, Variable
from derive.ir.patterns import Pattern
from derive.ir.statements import ReturnCode
from derive.ir.straight_line import StraightLine, straight_line_function
from derive.roles import Role
from derive.runtime.compiled_function import CompiledFunction, CompiledFunctions
from derive.runtime.compiled_model import NO_PATTERN, add_jacobian
from derive.runtime.native_call import Matrix, ModelError, Vector
from derive.runtime.native_scene import NativeScene

INTERPRETED_CALLS = 4
"""The calls of a function until one of Python is made of it, which takes as long as some of them."""


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
        self.proximal, self.in_space = model.proximal, model.in_space
        self.multipliers, self.bodies = _names(model.multipliers), model.bodies
        instances = {m.title: (of, number) for of in model.marker_classes for number, m in enumerate(of.markers)}
        self.markers, self._instances = (*_names(model.markers), *instances), instances
        self._lone_markers = {m.title: f"marker_{m.name}" for m in model.markers}
        self.inputs, self.outputs = _names(model.inputs), _names(model.outputs)
        self.mass_pattern = model.pattern("mass", "M")
        self.jacobian_pattern = model.pattern(JACOBIAN, "jac") if model.has_iteration_matrix else NO_PATTERN
        self.constraint_pattern = model.pattern("constraint_jacobian", "G")
        self._compiled = CompiledFunctions(
            {kernel.name: InterpretedFunction(model, kernel) for kernel in model.kernels}
        )
        for name, kernel in self._lone_markers.items():
            self._compiled[f"marker_{name}"] = InterpretedFunction(model, model.kernel(kernel))
        for name, (of, number) in instances.items():
            self._compiled[f"marker_{name}"] = InterpretedFunction(model, model.kernel(f"marker_{of.name}"), number)

    def marker_positions(self, name: str, q: ArrayLike, v: ArrayLike, k: ArrayLike) -> Matrix:
        """Positions (n, dimension) of a marker for each row of q and v."""
        states = zip(np.asarray(q), np.asarray(v), strict=True)
        return np.array([self.marker(name, q_i, v_i, k)[0] for q_i, v_i in states])

    def marker_pattern(self, name: str) -> Pattern:
        """The pattern of the Jacobian of a marker."""
        if name in self._instances:
            of, number = self._instances[name]
            return of.pattern.among(of.columns[number], self.nv)
        return self._kernels.pattern(self._lone_markers[name], "jacobian")


def with_iteration_matrix(native: NativeScene, model: Model) -> NativeScene:
    """A compiled scene that has the iteration matrix of its model, interpreted where the library does without it."""
    if model.has_iteration_matrix and native.jacobian_pattern is NO_PATTERN:
        add_jacobian(native, model.pattern(JACOBIAN, "jac"), InterpretedFunction(model, model.kernel(JACOBIAN)))
    return native


class InterpretedFunction(CompiledFunction):
    """A function that is interpreted."""

    def __init__(self, model: Model, kernel: Kernel, number: int = 0) -> None:
        """number: the integer that functions of instances take."""
        self.name, self._kernel, self._number = f"{model.name}_{kernel.name}", kernel, number
        self._tables = {spline.name: spline for spline in model.splines}
        self._calls = 0
        self._straight: StraightLine | None = None

    def __call__(self, arrays: tuple[ArrayLike, ...], *numbers: float, out: Vector | None = None) -> Vector:
        """The first result, written into `out` where it is given."""
        result = self.results(arrays, *numbers)[0]
        if out is None:
            return result
        out[:] = result
        return out

    def at(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike, out: Vector | None = None) -> Vector:
        """The first result for the inputs q, v, k and the number t."""
        return self((q, v, k), t, out=out)

    def results(self, arrays: tuple[ArrayLike, ...], *numbers: float) -> list[Vector]:
        """All results. Raises ModelError where the compiled function returns a code other than 0."""
        vectors, scalars = iter(arrays), iter(numbers)
        given = {
            a.name: self._number
            if a.integer
            else float(next(scalars))
            if a.scalar
            else np.asarray(next(vectors), dtype=np.float64).tolist()
            for a in self._kernel.arguments
        }
        try:
            outputs = self._outputs(given)
        except RequirementError as error:
            raise ModelError(self.name, error.code) from error
        except (ArithmeticError, ValueError) as error:  # C has an infinity or a NaN there
            raise ModelError(self.name, ReturnCode.NOT_FINITE) from error
        return [np.array(outputs[o.name], dtype=np.float64) for o in self._kernel.outputs]

    def _outputs(self, given: Mapping[str, Any]) -> dict[str, list[Any]]:
        """The outputs by name: interpreted in the first calls, by a function of Python from then on if there is one."""
        self._calls += 1
        if self._calls == INTERPRETED_CALLS:
            self._straight = straight_line_function(self._kernel, check_requirement, self._tables)
        if self._straight is not None:
            return self._straight(given)
        return interpret(self._kernel, given, tables=self._tables)


def _names(variables: tuple[Variable, ...]) -> tuple[str, ...]:
    return tuple(variable.title for variable in variables)
