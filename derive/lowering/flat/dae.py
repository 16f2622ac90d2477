"""The equations of a scene as F(t, y, ydot) = 0 for implicit integrators, in three forms, with their Jacobians.

`index3`: y = [q; v; lambda], the last block is g. `index1`: the same with G vdot - gamma. `ggl`, stabilised index 2 of
Gear, Gupta & Leimkuhler: y = [q; v; lambda; mu], qdot = v - G^T mu, with both gdot and g.
"""

from __future__ import annotations

import casadi as ca
import sympy as sp

from derive.ir.model import Kernel
from derive.ir.patterns import pattern
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.constraints import jacobian_entries
from derive.lowering.flat.context import Context, Input, array_input, stores
from derive.lowering.flat.schedule import Step
from derive.lowering.functions import ModelFunction, OutputElements
from derive.mechanics.symbols import local, state_rate


def _states(context: Context, form: str) -> tuple[Input, Input]:
    """y and ydot."""
    extra = context.forces + (_stabilising(context) if form == "ggl" else ())
    blocks = "[q; v; lambda; mu]" if form == "ggl" else "[q; v; lambda]"
    y = array_input("y", context.state + extra, f"state {blocks}")
    return y, array_input("ydot", (*context.state_rates, *map(state_rate, extra)), "time derivative of y")


def _stabilising(context: Context) -> tuple[sp.Symbol, ...]:
    """The multipliers mu that keep the coordinates on the constraints."""
    return tuple(local(f"mu_{name}") for name in context.multipliers)


def _rows(context: Context, form: str, symbols: Symbols) -> list[ca.SX]:
    eq = context.equations
    entries = jacobian_entries(context, symbols)

    def transposed(multipliers: tuple[sp.Symbol, ...]) -> list[ca.SX]:
        """G^T times some multipliers."""
        total = [ca.SX(0) for _ in context.rows]
        for (i, j), value in entries.items():
            total[j] = total[j] + value * symbols.values[multipliers[i]]
        return total

    rows = [symbols.values[state_rate(c.q)] - symbols(rate) for c, rate in zip(eq.coordinates, eq.rates, strict=True)]
    if form == "ggl":  # in the plane rates are those of the coordinates, one to one
        mu = transposed(_stabilising(context))
        rows = [row + part for row, part in zip(rows, mu, strict=True)]
    reactions = transposed(context.forces)
    rows += [symbols(eq.sum_of(row.name)) - f for row, f in zip(eq.rows, reactions, strict=True)]
    if form == "ggl":
        rows += [symbols(c.rate) for c in eq.constraints]
    if form in ("", "ggl"):
        return rows + [symbols(c.position) for c in eq.constraints]
    return rows + [_second(c.bias, dict(c.jacobian), context, symbols) for c in eq.constraints]


def _second(bias: sp.Expr, factors: dict[str, sp.Expr], context: Context, symbols: Symbols) -> ca.SX:
    """G vdot - gamma of one constraint."""
    acceleration = {row.name: row.a for row in context.equations.rows}
    return sum((symbols(f) * symbols.values[acceleration[row]] for row, f in factors.items()), symbols(bias))


def residual(context: Context, function: ModelFunction) -> Kernel:
    """F(t, y, ydot) in the form that is the variant of the function."""
    form = function.variant
    y, ydot = _states(context, form)
    symbols = context.symbols(context.t, y, ydot)
    rows = _rows(context, form, symbols)
    return context.kernel(
        function,
        {"F": OutputElements(y.elements)},
        symbols,
        Step("residual", "(15)", "kinematics, equations of motion, constraints", stores("F", rows)),
        inputs=(y, ydot),
    )


def jacobian(context: Context, function: ModelFunction) -> Kernel:
    """dF/dy + cj dF/dydot of that form."""
    form = function.variant
    y, ydot = _states(context, form)
    symbols = context.symbols(context.t, y, ydot, context.cj)
    rows = ca.vertcat(*_rows(context, form, symbols))
    by_y, by_ydot = (ca.jacobian(rows, ca.vertcat(*symbols.many(given.symbols))) for given in (y, ydot))
    (cj,) = symbols.many(context.cj.symbols)
    matrix = by_y + cj * by_ydot
    diagonal = {(i, i) for i in range(len(y.symbols))}
    size = len(y.symbols)
    shape = pattern(size, size, diagonal | set(zip(*matrix.sparsity().get_triplet(), strict=True)))
    labels = tuple(f"d F[{y.elements[i]}] / d {y.elements[j]}" for i, j in shape.entries)
    return context.kernel(
        function,
        {"jac": OutputElements(labels, shape)},
        symbols,
        Step(
            "jacobian", "(15)", "derivatives of the residual", stores("jac", [matrix[i, j] for i, j in shape.entries])
        ),
        inputs=(y, ydot),
    )
