"""Physical constants of a specification in the derivation: a parameter stays a symbol, a number an exact number."""

from __future__ import annotations

import sympy as sp

from derive.mechanics.symbols import Family
from derive.mechanics.symbols import parameter as parameter_symbol
from derive.mechanics.symbols import quantity as quantity_symbol
from derive.mechanics.terms import ModelConstant, ParameterSymbol
from derive.spec.model.body import Parameter, Quantity

NO_GRAVITY = "the specification (no gravity along this axis)"


def value(quantity: Quantity, positive: bool = True) -> sp.Expr:
    """The symbol of a parameter, or the number."""
    if isinstance(quantity, Parameter):
        return parameter_symbol(quantity.symbol, positive)
    return sp.Rational(quantity)


def parameter(quantity: Parameter, doc: str, positive: bool = True) -> ParameterSymbol:
    """A run-time parameter; setup refuses it unless it is positive, if it must be."""
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
