"""The cubic spline through the rows of a table, computed with the same bits on any machine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from derive.spec.model.time_function import Spline


def cubic_spline(name: str, x: Sequence[float], y: Sequence[float]) -> Spline:
    """The spline through the points (x_i, y_i), x increasing, at least two of them.

    Its third derivative is continuous at the second knot and at the last but one ("not-a-knot"), so that a table of a
    cubic polynomial is that polynomial. Two points give a straight line, three a parabola. The slopes s_i at the knots
    solve a tridiagonal system (de Boor, A Practical Guide to Splines, chapter IV), in plain Python arithmetic, since
    the results of linear algebra libraries differ from machine to machine.

    Raises ArithmeticError where the steps are so small, or the values so large, that coefficients are no doubles.
    """
    n = len(x)
    h = [b - a for a, b in pairwise(x)]
    d = [(b - a) / step for (a, b), step in zip(pairwise(y), h, strict=True)]
    if n == 2:
        slopes = [d[0], d[0]]
    elif n == 3:
        second = (d[1] - d[0]) / (h[0] + h[1])
        slopes = [d[0] - second * h[0], d[0] + second * h[0], d[1] + second * h[1]]
    else:
        slopes = _slopes(h, d)
    coefficients = []
    for i in range(n - 1):
        c2 = (3 * d[i] - 2 * slopes[i] - slopes[i + 1]) / h[i]
        c3 = (slopes[i] + slopes[i + 1] - 2 * d[i]) / (h[i] * h[i])
        if not all(map(math.isfinite, (slopes[i], slopes[i + 1], c2, c3))):
            raise OverflowError(f"the coefficients between {x[i]} and {x[i + 1]} are not finite")
        coefficients.append((y[i], slopes[i], c2, c3))
    return Spline(name, tuple(x), tuple(coefficients))


def _slopes(h: list[float], d: list[float]) -> list[float]:
    """The slopes at the knots, from continuity of the second derivative and the conditions at both ends."""
    n = len(h) + 1
    low, diagonal, high, right = [0.0] * n, [0.0] * n, [0.0] * n, [0.0] * n
    both = h[0] + h[1]
    diagonal[0], high[0] = h[1], both
    right[0] = ((h[0] + 2 * both) * h[1] * d[0] + h[0] * h[0] * d[1]) / both
    for i in range(1, n - 1):
        low[i], diagonal[i], high[i] = h[i], 2 * (h[i - 1] + h[i]), h[i - 1]
        right[i] = 3 * (h[i] * d[i - 1] + h[i - 1] * d[i])
    both = h[-1] + h[-2]
    low[-1], diagonal[-1] = both, h[-2]
    right[-1] = (h[-1] * h[-1] * d[-2] + (2 * both + h[-1]) * h[-2] * d[-1]) / both
    for i in range(1, n):
        factor = low[i] / diagonal[i - 1]
        diagonal[i] -= factor * high[i - 1]
        right[i] -= factor * right[i - 1]
    slopes = [0.0] * n
    slopes[-1] = right[-1] / diagonal[-1]
    for i in reversed(range(n - 1)):
        slopes[i] = (right[i] - high[i] * slopes[i + 1]) / diagonal[i]
    return slopes
