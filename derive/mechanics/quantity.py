"""Quantities of a specification in the derivation: parameters as symbols, numbers exact, functions of time."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.errors import Problem, SpecError
from derive.mechanics.symbols import Family, identity, run_time_input, time
from derive.mechanics.symbols import element as element_symbol
from derive.mechanics.symbols import parameter as parameter_symbol
from derive.mechanics.symbols import quantity as quantity_symbol
from derive.mechanics.terms import ModelConstant, ParameterSymbol
from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.model.time_function import TimeFunction, parts, value_at

if TYPE_CHECKING:
    from derive.mechanics.typed_symbol import Symbol

NO_GRAVITY = "the specification (no gravity along this axis)"


def value(quantity: Quantity, positive: bool = True) -> sp.Expr:
    """The value of a quantity: the symbol of a parameter, or the number."""
    if isinstance(quantity, Parameter):
        return parameter_symbol(quantity.symbol, positive)
    return sp.Rational(quantity)


def parameter(quantity: Parameter, doc: str, positive: bool = True) -> ParameterSymbol:
    """A run-time parameter; if `positive`, setup refuses values that are not."""
    return ParameterSymbol(value(quantity, positive), doc, quantity.unit, quantity.default, positive)


def gravity(components: tuple[Quantity, ...] | None) -> tuple[tuple[ModelConstant, ...], tuple[ParameterSymbol, ...]]:
    """The acceleration of free fall g_1, g_2, ... and the parameters in it."""
    coefficients, parameters = [], []
    for axis, component in enumerate(components or (), 1):
        doc = f"acceleration of free fall along the inertial e{axis}"
        expr = value(component, positive=False)
        zero = NO_GRAVITY if expr == 0 else None
        coefficients.append(ModelConstant(quantity_symbol(Family.GRAVITY, axis), expr, "(10)", doc, "m/s^2", zero))
        if isinstance(component, Parameter):
            parameters.append(parameter(component, doc, positive=False))
    return tuple(coefficients), tuple(parameters)


def function(of: TimeFunction) -> sp.Expr:
    """The expression of t and of the constants of parameters; numbers stay exact."""
    from derive.mechanics.time_functions import BUILD, lookup, piecewise

    match of.kind:
        case "number":
            return sp.Rational(of.value)
        case "t":
            return time()
        case "parameter":
            assert of.parameter is not None
            return function_constant(of.parameter)
        case "input":
            return run_time_input(of.name)
        case "spline":
            assert of.spline is not None
            return lookup(of.spline, function(of.args[0]))
        case "piecewise":
            conditions = [(function(less.args[0]), function(less.args[1])) for less in of.args[:-1:2]]
            return piecewise(conditions, [function(value) for value in (*of.args[1::2], of.args[-1])])
        case kind if kind in EXACT or any(part.kind in ("t", "parameter", "input") for part in parts(of)):
            return rounded(BUILD[kind](*map(function, of.args)))
        case _:
            return sp.Rational(value_at(of, 0.0))


EXACT = ("add", "sub", "mul", "div", "pow", "neg", "sin", "cos", "sqrt")
"""The kinds of functions of numbers that SymPy evaluates to any number of digits."""


def function_constant(parameter: Parameter) -> Symbol:
    """The constant of the generated code that is the value of a parameter in functions of time."""
    return element_symbol("parameter", parameter.symbol)


def rounded(expr: sp.Expr) -> sp.Expr:
    """A number that is no fraction, such as cos(1/2), as the double next to it, which is the same on any machine."""
    if not expr.is_number or expr.is_Rational or not (expr.is_real and expr.is_finite):
        return expr
    return sp.Rational(float(expr.evalf(30)))


def time_derivatives(of: sp.Expr) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """A function of time with its first two derivatives; those of a run-time input are inputs as well."""
    first = _rate(of)
    return of, first, _rate(first)


def _rate(of: sp.Expr) -> sp.Expr:
    """The time derivative of an expression by the chain rule."""
    inputs = [s for s in of.free_symbols if s != time() and identity(s).family is Family.INPUT]
    following = {s: replace(identity(s), derivative=identity(s).derivative + 1).symbol for s in inputs}
    return of.diff(time()) + sp.Add(*(of.diff(s) * rate for s, rate in following.items()))


def finite_function(of: TimeFunction, path: str) -> sp.Expr:
    """A function of t. Raises SpecError at `path` where it has no value for any t."""
    expr = function(of)
    if expr.has(sp.zoo, sp.nan, sp.oo, -sp.oo, sp.I):
        raise SpecError((Problem(path, f"this is {expr} for every t; a finite function of t is needed"),))
    return expr
