"""Exact numbers of links, and expressions of parameters in their place, with vectors and matrices of them."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TypeAlias

from derive.algebra import fraction, sp

Exact: TypeAlias = "Fraction | sp.Expr"
"""An exact number, or an expression of parameters."""
Matrix: TypeAlias = tuple[tuple[Exact, ...], ...]
Vector: TypeAlias = tuple[Exact, ...]

ZERO = Fraction(0)


def exact(value: object, numbers: Mapping[sp.Symbol, sp.Expr] | None = None) -> Exact:
    """An exact number, or an expression of parameters; numbers: the values of constants."""
    expr = sp.sympify(value).xreplace(numbers or {})
    return fraction(expr) if expr.is_Rational else expr


def product(a: Matrix, b: Matrix) -> Matrix:
    """The product of two matrices (3, 3)."""
    columns = transposed(b)
    return tuple(tuple(scalar_product(row, column) for column in columns) for row in a)


def applied(a: Matrix, x: Vector) -> Vector:
    """The product of a matrix (3, 3) and a vector (3,)."""
    return tuple(scalar_product(row, x) for row in a)


def transposed(a: Matrix) -> Matrix:
    """The transpose of a matrix."""
    return tuple(zip(*a, strict=True))


def plus(a: Vector, b: Vector) -> Vector:
    """The sum of two vectors."""
    return tuple(x + y for x, y in zip(a, b, strict=True))


def scalar_product(a: Vector, b: Vector) -> Exact:
    """The scalar product of two vectors."""
    return sum((x * y for x, y in zip(a, b, strict=True)), ZERO)
