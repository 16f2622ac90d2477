"""Helpers of the integrals of functions of time: arguments that are linear in t, and values at a time."""

from __future__ import annotations

from typing import TypeAlias

from derive.algebra import sp
from derive.mechanics.fixed_symbols import t
from derive.mechanics.time_expressions import folded

Linear: TypeAlias = "tuple[sp.Expr, sp.Expr]"
"""The coefficients c and d of an argument c t + d."""


def linear_in_t(argument: sp.Expr) -> Linear | None:
    """The coefficients of an argument that is linear in t; None if it is not, or does not depend on t."""
    expanded = sp.expand(argument)
    slope = expanded.coeff(t, 1)
    rest = sp.expand(expanded - slope * t)
    return None if slope == 0 or slope.has(t) or rest.has(t) else (slope, rest)


def at(expr: sp.Expr, time: sp.Expr) -> sp.Expr:
    """The value of an expression at a time; switches whose condition is then a number are resolved."""
    return folded(sp.sympify(expr).subs(t, time))
