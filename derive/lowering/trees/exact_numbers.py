"""Exact numbers of links, and expressions of parameters in their place."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TypeAlias

from derive.algebra import sp

Exact: TypeAlias = "Fraction | sp.Expr"
"""An exact number, or an expression of parameters."""


def exact(value: object, numbers: Mapping[sp.Symbol, sp.Expr] | None = None) -> Exact:
    """An exact number, or an expression of parameters; numbers: the values of constants."""
    expr = sp.sympify(value).xreplace(numbers or {})
    return Fraction(int(expr.p), int(expr.q)) if expr.is_Rational else expr
