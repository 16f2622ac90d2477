"""Constraints of a mechanism in space through the frames on which they act: G^T lambda, and G vdot - gamma.

A constraint depends on the coordinates of a body only through the frame of its marker. The forces and torques of all
multipliers on a frame are therefore summed up before they act on the rows of its body, and the acceleration of a frame
is computed once for all constraints on it. The entries of G, whose sums with multipliers and accelerations are the
same, have the work on each row for each constraint.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import casadi as ca

from derive.algebra import sp
from derive.lowering.flat.casadi_symbols import Symbols, added, multiplied, subtracted
from derive.lowering.flat.context import Context
from derive.mechanics.terms import ConstrainedFrame, Constraint, load_symbols

Work: TypeAlias = "tuple[tuple[str, sp.Expr], ...]"


def reactions(context: Context, symbols: Symbols, multipliers: Sequence[sp.Symbol]) -> list[ca.SX]:
    """G^T times some multipliers, a value for each row of the equations of motion."""
    rows = {name: ca.SX(0) for name in context.rows}
    frames: dict[Work, _FrameLoad] = {}
    for c, symbol in zip(context.equations.constraints, multipliers, strict=True):
        multiplier = symbols.values[symbol]
        if c.frames is None:
            for row, factor in c.jacobian:
                rows[row] = rows[row] + symbols(factor) * multiplier
            continue
        for frame, sign in ((c.frames.second, 1), (c.frames.first, -1)):
            if frame.work:
                load = frames.setdefault(frame.work, _FrameLoad(sign))
                opposite = sign < 0 and c.frames.axis is not None
                of = c.frames.second if opposite else frame
                load.add(of, sign if opposite else 1, symbols, multiplier)
    for work, load in frames.items():
        values = symbols.evaluated((expr for _, expr in work), dict(zip(load_symbols(), load.total, strict=True)))
        for (row, _), value in zip(work, values, strict=True):
            rows[row] = (added if load.sign > 0 else subtracted)(rows[row], value)
    return list(rows.values())


class _FrameLoad:
    """The force and the torque of all multipliers on a frame, times `sign`."""

    def __init__(self, sign: int) -> None:
        self.sign = sign
        self.total = [ca.SX(0) for _ in load_symbols()]

    def add(self, frame: ConstrainedFrame, sign: int, symbols: Symbols, multiplier: ca.SX) -> None:
        """Add what a multiplier exerts, or the opposite of it."""
        combine = added if sign == self.sign else subtracted
        for k, factor in enumerate((*frame.force, *frame.torque)):
            self.total[k] = combine(self.total[k], multiplied(symbols(factor), multiplier))


def acceleration_residual(c: Constraint, context: Context, symbols: Symbols) -> ca.SX:
    """G vdot - gamma of a constraint."""
    if c.frames is None:
        accelerations = {row.name: row.a for row in context.equations.rows}
        factors = (symbols(f) * symbols.values[accelerations[row]] for row, f in c.jacobian)
        return sum(factors, symbols(c.bias))
    along = (_along(frame, symbols) for frame in (c.frames.first, c.frames.second))
    return sum(along, symbols(c.frames.bias))


def _along(frame: ConstrainedFrame, symbols: Symbols) -> ca.SX:
    """The accelerations of a frame along the force and the torque of a unit multiplier."""
    factors, accelerations = (*frame.force, *frame.torque), (*frame.acceleration, *frame.angular_acceleration)
    pairs = zip(factors, accelerations, strict=True)
    return sum((multiplied(symbols(f), symbols(a)) for f, a in pairs if f != 0 and a != 0), ca.SX(0))
