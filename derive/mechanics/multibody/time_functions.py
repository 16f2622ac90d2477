"""Functions of time of a specification in SymPy."""

from __future__ import annotations

import sympy as sp

from derive.errors import Problem, SpecError
from derive.mechanics.symbols import t
from derive.spec.model.scene import TimeFunction

_BUILD = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "pow": lambda a, b: a**b,
    "neg": lambda a: -a,
    "sin": sp.sin,
    "cos": sp.cos,
    "sqrt": sp.sqrt,
}


def function(of: TimeFunction) -> sp.Expr:
    """The expression of t; numbers stay exact."""
    if of.kind == "number":
        return sp.Rational(of.value)
    if of.kind == "t":
        return t
    return rounded(_BUILD[of.kind](*map(function, of.args)))


def rounded(expr: sp.Expr) -> sp.Expr:
    """A number that is no fraction, such as cos(1/2), as the double next to it, which is the same on any machine."""
    if not expr.is_number or expr.is_Rational or not (expr.is_real and expr.is_finite):
        return expr
    return sp.Rational(float(expr.evalf(30)))


def time_derivatives(of: sp.Expr) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """A function of time with its first two derivatives."""
    return of, of.diff(t), of.diff(t, 2)


def finite_function(of: TimeFunction, path: str) -> sp.Expr:
    """A function of t. Raises SpecError at `path` where it has no value for any t."""
    expr = function(of)
    if expr.has(sp.zoo, sp.nan, sp.oo, -sp.oo, sp.I):
        raise SpecError((Problem(path, f"this is {expr} for every t; a finite function of t is needed"),))
    return expr
