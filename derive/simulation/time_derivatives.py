"""The values of a function of time and of its first two derivatives, which are differentiated exactly, at a time.

They are kept in the cache between runs, since SymPy and CasADi compute them.
"""

from __future__ import annotations

import math
from dataclasses import astuple

from derive.algebra import sp
from derive.ir.expressions import Number
from derive.kept_objects import kept_object
from derive.mechanics.quantity import finite_function, function_constant, time_derivatives
from derive.mechanics.symbols import time
from derive.spec.model.time_function import TimeFunction, parts


def derivatives_at(function: TimeFunction, t: float, path: str) -> tuple[float, float, float]:
    """The value of a function at t (s) and its first two time derivatives, with the defaults of its parameters.

    NaN or infinite where there is no value; at a kink the derivative is that of one side, as in the generated code.
    Raises SpecError at `path` for a function without a value at any t.
    """

    def made() -> tuple[float, float, float]:
        value, first, second = (
            _number(expr, function, t) for expr in time_derivatives(finite_function(function, path))
        )
        return value, first, second

    return kept_object("time derivatives", repr((astuple(function), t)), made)


def _number(expr: sp.Expr, function: TimeFunction, t: float) -> float:
    """The value at t of an expression that was made from a function."""
    import casadi as ca  # loaded here alone, since runs of kept models do without it

    from derive.lowering.flat.casadi_symbols import Symbols
    from derive.mechanics.time_functions import Lookup

    known: dict[sp.Symbol, sp.Expr] = {time(): sp.Rational(t)}
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
    converted = Symbols(frozenset(), frozenset())
    result = converted(value)
    numbers = [float(leaf.value) for leaf in converted.leaves if isinstance(leaf, Number)]
    return float(ca.Function("value", converted.inputs, [result]).call(numbers)[0]) + 0.0
