"""The values of the run-time inputs of a scene at t = 0, as start values for hosts."""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca
import sympy as sp

from derive.errors import Problem, SpecError
from derive.ir.expressions import Number
from derive.lowering.flat.casadi_symbols import Symbols
from derive.mechanics.quantity import finite_function, function_constant, time_derivatives
from derive.mechanics.symbols import t
from derive.mechanics.time_functions import Lookup
from derive.spec.model.scene import Scene
from derive.spec.model.time_function import TimeFunction, parts

ZERO = TimeFunction("number")


@dataclass(frozen=True)
class InputValue:
    """The value of an input at t = 0, and which time derivative of a prescribed motion it is."""

    number: float
    order: int


def input_start(scene: Scene) -> tuple[InputValue, ...]:
    """The inputs u (nu,) at t = 0 by the functions of the specification; an input without one is 0.

    The value of an input that prescribes a motion is followed by its first two time derivatives.

    Raises SpecError where a function, or a derivative that is needed, has no value at t = 0.
    """
    motions = {drive.motion.name for drive in scene.drives if drive.motion is not None}
    values: list[InputValue] = []
    for given in scene.inputs:
        path, function = f"inputs.{given.name}.value", given.function or ZERO
        derivatives = time_derivatives(finite_function(function, path))[: 3 if given.name in motions else 1]
        for order, derivative in enumerate(derivatives):
            value = _number(derivative, function)
            if not math.isfinite(value):
                what = ("this function", "the first derivative of this function", "its second derivative")[order]
                raise SpecError((Problem(path, f"{what} has no value at t = 0, where a host starts"),))
            values.append(InputValue(value, order))
    return tuple(values)


def _number(expr: sp.Expr, function: TimeFunction) -> float:
    """The value at t = 0 of an expression that was made from a function, with the defaults of its parameters."""
    known: dict[sp.Symbol, sp.Expr] = {t: sp.S.Zero}
    splines = {}
    for part in parts(function):
        if part.parameter is not None:
            known[function_constant(part.parameter)] = sp.Rational(part.parameter.default)
        if part.spline is not None:
            splines[part.spline.name] = part.spline

    def looked_up(name: sp.Basic, order: sp.Expr, x: sp.Expr) -> sp.Expr:
        return sp.Rational(splines[str(name)](float(x), int(order)))

    value = expr.subs(known).replace(Lookup, looked_up)
    if value.has(sp.zoo, sp.nan, sp.oo, -sp.oo):
        return math.nan
    symbols = Symbols(frozenset(), frozenset())
    result = symbols(value)
    numbers = [float(leaf.value) for leaf in symbols.leaves if isinstance(leaf, Number)]
    return float(ca.Function("value", symbols.inputs, [result]).call(numbers)[0]) + 0.0
