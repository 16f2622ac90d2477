"""A model as a function of CasADi's symbols: the kernels of its code, run on symbols."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import partial
from typing import Any

import casadi as ca

from derive.export.host_model import HostModel
from derive.ir.interpreter import interpret
from derive.spec.model.time_function import Spline

FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    **{
        name: getattr(ca, name)
        for name in ("sin", "cos", "sqrt", "exp", "log", "tanh", "sign", "atan2", "fmin", "fmax")
    },
    "less": ca.lt,
    "not_greater": ca.le,
    "not": ca.logic_not,
    "when": lambda condition, value: ca.if_else(condition, value, 0),
}
"""The functions of symbols that implement the operators of kernels."""

INPUTS, OUTPUTS = ("t", "x", "u", "p"), ("xdot", "y")


def sizes_of(host: HostModel) -> dict[str, int]:
    """The sizes of t, x = [q; v], u, p, xdot and y."""
    states, outputs = len(host.states), len(host.outputs)
    return {"t": 1, "x": states, "u": len(host.inputs), "p": len(host.parameters), "xdot": states, "y": outputs}


def model_graph(host: HostModel) -> ca.Function:
    """The function (t, x, u, p) -> (xdot, y) of symbols (SX), which CasADi differentiates any number of times.

    The model must have straight-line code. A graph has none of the checks of that code: a pivot that vanishes gives
    numbers that are not finite.
    """
    model, sizes, nq = host.model, sizes_of(host), len(host.coordinates)
    symbols = {name: ca.SX.sym(name, sizes[name]) for name in INPUTS}
    x = ca.vertsplit(symbols["x"])
    values: dict[str, Any] = {"t": symbols["t"], "q": x[:nq], "v": x[nq:]}
    values |= {name: ca.vertsplit(symbols[name]) if sizes[name] else [] for name in ("u", "p")}
    tables = {spline.name: partial(looked_up, spline) for spline in model.splines}
    accelerations = "solve" if model.is_scene else "accel"
    for name in ("setup", "rates", accelerations, *(("outputs",) if model.outputs else ())):
        kernel = model.kernel(name)
        values |= interpret(kernel, values, number=number, functions=FUNCTIONS, check=False, tables=tables)
    results = [ca.vertcat(*values["qdot"], *values["vdot"]), ca.vertcat(*values.get("out", ()))]
    return ca.Function(host.name, list(symbols.values()), results, INPUTS, OUTPUTS)


def number(value: Fraction) -> ca.SX:
    """The nearest double as a constant symbol."""
    return ca.SX(float(value))


def looked_up(spline: Spline, x: ca.SX, order: int) -> ca.SX:
    """The derivative of an order of a piecewise polynomial, constant outside its knots, in symbols."""
    last = spline.knots[-1]
    inside = ca.logic_and(x >= spline.knots[0], x < last)
    at = ca.fmin(ca.fmax(x, spline.knots[0]), last)
    result = ca.SX(0)
    for k, row in enumerate(spline.coefficients):
        d = at - spline.knots[k]
        value = ca.SX(0)
        for j in reversed(range(order, len(row))):
            value = math.perm(j, order) * row[j] + d * value
        end = k == len(spline.coefficients) - 1
        here = at >= spline.knots[k] if end else ca.logic_and(at >= spline.knots[k], at < spline.knots[k + 1])
        result += ca.if_else(here, value, 0)
    return ca.if_else(inside, result, 0) if order else result
