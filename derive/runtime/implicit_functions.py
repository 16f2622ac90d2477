"""Functions of a compiled model for implicit methods: its residual, and derivatives of this."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from derive.ir.patterns import Pattern
from derive.runtime.compiled_function import CompiledFunction
from derive.runtime.compiler import CompilerError
from derive.runtime.native_call import (
    Vector,
)


class ImplicitFunctions:
    """The functions of a `Native` as a differential-algebraic equation F(t, y, ydot) = 0, and its sensitivities."""

    name: str
    parameter_pattern: Pattern | None
    _compiled: dict[str, CompiledFunction]
    own_at: Any

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
