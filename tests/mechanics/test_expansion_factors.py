"""The factors of accelerations in sums, which are the mass matrix."""

from __future__ import annotations

import sympy as sp

from derive.mechanics.expansion import linear_factors

a, b, x, y = sp.symbols("a b x y")


def test_factors_are_the_derivatives_of_what_is_linear() -> None:
    expr = 2 * a * x - a * (x + y) + (a + b) * y + 3 * b + x * y + a
    found = linear_factors(expr, [a, b])
    assert found == {a: expr.diff(a), b: expr.diff(b)}
    assert linear_factors(x * y, [a]) == {a: 0}
