"""Functions of time that change at a switch, as choices of two expressions: piecewise, steps, abs, min, max."""

from __future__ import annotations

from derive.algebra import sp
from derive.mechanics.fixed_symbols import t
from derive.mechanics.time_functions import Absolute, Maximum, Minimum, Select, SmoothStep
from derive.mechanics.time_integrals.linear_arguments import linear_in_t

SWITCHES = (Select, SmoothStep, Absolute, Minimum, Maximum)
"""The functions that change to another expression at a time."""


def selection(others: sp.Expr) -> Select | None:
    """An expression as a choice of two, by its first switch with a linear argument; None if there is no switch."""
    for switch in sp.preorder_traversal(others):
        if isinstance(switch, SWITCHES) and switch.has(t) and (choice := _choice(switch)) is not None:
            a, b, x, y = choice.args
            return Select(a, b, others.xreplace({switch: x}), others.xreplace({switch: y}))
    return None


def _choice(switch: sp.Expr) -> Select | None:
    """A switch as a choice by time or by a constant expression; None where its argument is not linear."""
    match switch:
        case Select(args=(a, b, x, y)):
            return switch if not (a - b).has(t) else _sides(a - b, x, y)
        case Absolute(args=(a,)):
            return _sides(a, -a, a)
        case Minimum(args=(a, b)):
            return _sides(a - b, a, b)
        case Maximum(args=(a, b)):
            return _sides(a - b, b, a)
        case SmoothStep(args=(a, x0, x1, _)):
            s = (a - x0) / (x1 - x0)
            between = s**3 * (10 + s * (6 * s - 15))
            forward = _sides(a - x0, sp.S.Zero, Select(a, x1, between, sp.S.One))
            if forward is None or (x1 - x0).is_Rational:
                return forward
            backward = _sides(a - x1, sp.S.One, Select(a, x0, between, sp.S.Zero))  # where parameters exchange the ends
            return Select(x0, x1, forward, backward)
    return None


def _sides(difference: sp.Expr, below: sp.Expr, above: sp.Expr) -> Select | None:
    """A choice by the sign of a difference that is linear in t; two choices if the sign of its slope is unknown."""
    linear = linear_in_t(difference)
    if linear is None:
        return None
    c, d = linear
    rising, falling = Select(t, -d / c, below, above), Select(t, -d / c, above, below)
    if c.is_Rational:
        return rising if c > 0 else falling
    return Select(sp.S.Zero, c, rising, falling)
