"""The equations of a mechanism as F(t, y, ydot) = 0 for implicit integrators, in three forms, with iteration matrices.

The variant of a function selects its form, a key of `FORMS`. "" (index 3): y = [q; v; lambda], and the last block of F
is g. "index1": the same with G vdot - gamma as the last block. "ggl", the stabilised form of index 2 of Gear, Gupta &
Leimkuhler: y = [q; v; lambda; mu], qdot = v - G^T mu, with the blocks gdot and g.
"""

from __future__ import annotations

import casadi as ca

from derive.algebra import sp
from derive.ir.kernel import Kernel
from derive.ir.patterns import pattern
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context, Input, array_input, stores
from derive.lowering.flat.frame_loads import acceleration_residual, reactions
from derive.lowering.flat.schedule import Step
from derive.lowering.flat.trees.tree_dynamics import tree_dynamics
from derive.lowering.flat.vertex_elimination import by_elimination, fewest_operations
from derive.lowering.model_functions import ModelFunction, OutputElements
from derive.mechanics.symbols import local, state_rate


def states(context: Context, form: str) -> tuple[Input, Input]:
    """The arguments y and ydot."""
    extra = context.forces + (_stabilising(context) if form == "ggl" else ())
    blocks = "[q; v; lambda; mu]" if form == "ggl" else "[q; v; lambda]"
    y = array_input("y", context.state + extra, f"state {blocks}")
    return y, array_input("ydot", (*context.state_rates, *map(state_rate, extra)), "time derivative of y")


def _stabilising(context: Context) -> tuple[sp.Symbol, ...]:
    """The multipliers mu by which the stabilised form keeps the coordinates on the constraints."""
    return tuple(local(f"mu_{name}") for name in context.multipliers)


def residual_rows(
    context: Context, form: str, symbols: Symbols, joints_alone: bool = False, stabilised: bool = True
) -> list[ca.SX]:
    """The rows of F; joints_alone: without qdot - v; stabilised: with G^T mu, if the form has it."""
    eq = context.equations
    rows = [ca.SX(0) for _ in eq.coordinates]
    if not joints_alone:
        kinematics = zip(eq.coordinates, eq.rates, strict=True)
        rows = [symbols.values[state_rate(c.q)] - symbols(rate) for c, rate in kinematics]
    if form == "ggl" and stabilised:
        rows = [row + part for row, part in zip(rows, stabilising_rows(context, symbols), strict=True)]
    loads = reactions(context, symbols, context.forces)
    tree = tree_dynamics(context, symbols)
    known = tree.forces(symbols.values_of(row.a for row in eq.rows)) if tree else {}
    sums = [known[n] if n in known else symbols(eq.sum_of(row.name)) for n, row in enumerate(eq.rows)]
    rows += [total - f for total, f in zip(sums, loads, strict=True)]
    if form == "ggl":
        rows += [symbols(c.rate) for c in eq.constraints]
    if form in ("", "ggl"):
        return rows + [symbols(c.position) for c in eq.constraints]
    return rows + [acceleration_residual(c, context, symbols) for c in eq.constraints]


def stabilising_rows(context: Context, symbols: Symbols) -> list[ca.SX]:
    """G^T mu, which the stabilised form adds to qdot - v."""
    return _rates_of(context, symbols, reactions(context, symbols, _stabilising(context)))


def _rates_of(context: Context, symbols: Symbols, velocities: list[ca.SX]) -> list[ca.SX]:
    """The rates of the coordinates that belong to velocities; in the plane both are the same."""
    rates, rows = context.equations.rates, context.equations.rows
    if rates == tuple(row.v for row in rows):
        return velocities
    result = []
    for rate in rates:
        factors = ((rate.coeff(row.v), velocity) for row, velocity in zip(rows, velocities, strict=True))
        result.append(sum((symbols(factor) * velocity for factor, velocity in factors if factor != 0), ca.SX(0)))
    return result


def residual(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of F(t, y, ydot)."""
    form = function.variant
    y, ydot = states(context, form)
    symbols = context.symbols(context.t, y, ydot)
    rows = residual_rows(context, form, symbols)
    return context.kernel(
        function,
        {"F": OutputElements(y.elements)},
        symbols,
        Step("residual", "(15)", "kinematics, equations of motion, constraints", stores("F", rows)),
        inputs=(y, ydot),
    )


def jacobian(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the iteration matrix dF/dy + cj dF/dydot."""
    form = function.variant
    y, ydot = states(context, form)
    symbols = context.symbols(context.t, y, ydot, context.cj)
    rows = residual_rows(context, form, symbols)
    matrix = _by_casadi(symbols, rows, y, ydot, context)
    diagonal = {(i, i) for i in range(len(y.symbols))}
    size = len(y.symbols)
    shape = pattern(size, size, diagonal | set(zip(*matrix.sparsity().get_triplet(), strict=True)))
    values = [matrix[i, j] for i, j in shape.entries]
    if any(c.frames for c in context.equations.constraints):
        of_y, rates = (symbols.values_of(of) for of in (y.symbols, (*ydot.symbols, *context.cj.symbols)))
        eliminated = by_elimination(symbols, rows, of_y, rates)
        others = [eliminated.get(entry, ca.SX(0)) for entry in shape.entries]
        values = fewest_operations(symbols, [values, others])
    labels = tuple(f"d F[{y.elements[i]}] / d {y.elements[j]}" for i, j in shape.entries)
    return context.kernel(
        function,
        {"jac": OutputElements(labels, shape)},
        symbols,
        Step("jacobian", "(15)", "derivatives of the residual", stores("jac", values)),
        inputs=(y, ydot),
    )


def _by_casadi(symbols: Symbols, rows: list[ca.SX], y: Input, ydot: Input, context: Context) -> ca.SX:
    """dF/dy + cj dF/dydot from the derivatives of CasADi."""
    column = ca.vertcat(*rows)
    by_y, by_ydot = (ca.jacobian(column, ca.vertcat(*symbols.values_of(of.symbols))) for of in (y, ydot))
    (cj,) = symbols.values_of(context.cj.symbols)
    return by_y + cj * by_ydot
