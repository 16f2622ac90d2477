"""Products of vectors in space, whose factors are expressions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from derive.algebra import sp
from derive.mechanics.quantity import rounded


def skew(v: Iterable[sp.Expr]) -> sp.Matrix:
    """The tensor v x."""
    a, b, c = v
    return sp.Matrix([[0, -c, b], [c, 0, -a], [-b, a, 0]])


def cross(a: Sequence[sp.Expr], b: Sequence[sp.Expr]) -> sp.Matrix:
    """The product a x b, not expanded."""
    pairs = ((1, 2), (2, 0), (0, 1))
    return sp.Matrix([_times(a[i], b[j]) - _times(a[j], b[i]) for i, j in pairs])


def _times(x: sp.Expr, y: sp.Expr) -> sp.Expr:
    """x y; SymPy would ask whether a sum that zero multiplies is finite."""
    return x * y if x and y else sp.S.Zero


def dot(a: Sequence[sp.Expr], b: Sequence[sp.Expr]) -> sp.Expr:
    """The product a . b, not expanded."""
    return sp.Add(*(_product(x, y) for x, y in zip(a, b, strict=True) if x and y))


def _product(x: sp.Expr, y: sp.Expr) -> sp.Expr:
    """x y; SymPy would multiply each term of a sum by a number, and the products of several would share nothing."""
    number = x.is_Rational and y.is_Add and x not in (0, 1, -1)
    return sp.Mul(x, y, evaluate=False) if number else x * y


def length_of(vector: Sequence[sp.Expr]) -> sp.Expr:
    """The length of a vector; simplified where it is a multiple of one expression, as along a guide."""
    from derive.mechanics.time_functions import Absolute  # its class loads SymPy

    components = [x for x in vector if x != 0]
    if len(components) == 1 and not components[0].is_number:
        return Absolute(components[0])
    factor, square = dot(vector, vector).as_coeff_Mul()
    base, exponent = square.as_base_exp()
    return rounded(sp.sqrt(factor)) * Absolute(base) if exponent == 2 else sp.sqrt(factor * square)
