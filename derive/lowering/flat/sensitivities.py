"""Kernels for sensitivities besides iteration matrices: derivatives by parameters and inputs, and KKT solutions.

With y = [q; v; lambda] and its rate fixed, a parameter p acts through the constants c of the model, which depend on
parameters alone: dF/dp = (dF/dc) (dc/dp). CasADi has the first factor, SymPy the second, which setup computes. The rows
are those from which all forms of a scene are made, M vdot + h - G^T lambda, g, gdot and G vdot - gamma, and then the
outputs; a single body has only M vdot + h. Kinematics, qdot = v, has no parameters. Where M vdot + h - G^T lambda and
G vdot - gamma change by dF and dg while vdot and lambda are fixed, the changes of these are the solution of
M dvdot - G^T dlambda = -dF, G dvdot = -dg.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import casadi as ca

from derive.algebra import sp
from derive.ir.kernel import Kernel
from derive.ir.patterns import pattern
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context, array_input, stores
from derive.lowering.flat.frame_loads import acceleration_residual, reactions
from derive.lowering.flat.kkt_matrix import by_factors
from derive.lowering.flat.schedule import Step
from derive.lowering.model_functions import ModelFunction, OutputElements
from derive.mechanics.equations import Equations
from derive.mechanics.symbols import local, state_rate
from derive.mechanics.terms import ModelConstant


def with_derivatives(equations: Equations) -> Equations:
    """The equations with the derivatives of their constants with respect to the parameters as further constants."""
    return replace(equations, coefficients=(*equations.coefficients, *derivatives(equations)))


def parameter_jacobian(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the derivatives with respect to the parameters and the inputs, of equations `with_derivatives`."""
    eq, multipliers = context.equations, context.forces
    y = array_input("y", context.state + multipliers, "state [q; v; lambda]" if multipliers else context.y.argument.doc)
    ydot = array_input("ydot", (*context.state_rates, *map(state_rate, multipliers)), "time derivative of y")
    symbols = context.symbols(context.t, y, ydot)
    rows = dynamic_rows(context, symbols) | {out.name: symbols(out.expr) for out in eq.outputs}
    matrix = by_parameters_and_inputs(context, symbols, list(rows.values()))
    names = (*(str(p.symbol) for p in eq.parameters), *context.u.elements)
    entries = set(zip(*matrix.sparsity().get_triplet(), strict=True))
    shape = pattern(len(rows), len(names), entries)
    residuals = tuple(rows)
    labels = tuple(f"d {residuals[i]} / d {names[j]}" for i, j in shape.entries)
    return context.kernel(
        function,
        {"jac": OutputElements(labels, shape)},
        symbols,
        Step(
            "parameter_jacobian",
            "(15)",
            "derivatives of the rows by parameters and inputs",
            stores("jac", [matrix[i, j] for i, j in shape.entries]),
        ),
        inputs=(y, ydot),
    )


def solve_kkt(context: Context, function: ModelFunction) -> Kernel:
    """The kernel that solves M x - G^T lambda = a, G x = b."""
    a = array_input("a", (local(f"a_{name}") for name in context.rows), "right-hand side of the equations of motion")
    b = array_input("b", (local(f"b_{name}") for name in context.multipliers), "right-hand side of the constraints")
    symbols = context.symbols(context.t, context.q, a, b)
    right = [*symbols.values_of(a.symbols), *(-value for value in symbols.values_of(b.symbols))]
    outputs = {"x": OutputElements(context.accelerations), "lam": OutputElements(context.multipliers)}
    return by_factors(context, function, outputs, symbols, right, (a, b))


def dynamic_rows(context: Context, symbols: Symbols) -> dict[str, ca.SX]:
    """The rows that depend on parameters, besides outputs, by their names."""
    eq = context.equations
    loads = reactions(context, symbols, context.forces)
    rows = {f"F[{row.name}]": symbols(eq.sum_of(row.name)) - load for row, load in zip(eq.rows, loads, strict=True)}
    rows |= {f"g[{c.name}]": symbols(c.position) for c in eq.constraints}
    rows |= {f"gdot[{c.name}]": symbols(c.rate) for c in eq.constraints}
    return rows | {f"gddot[{c.name}]": acceleration_residual(c, context, symbols) for c in eq.constraints}


def by_parameters_and_inputs(context: Context, symbols: Symbols, rows: list[ca.SX]) -> ca.SX:
    """The derivatives of rows with respect to the parameters and the inputs (rows, parameters and inputs)."""
    values = ca.vertcat(*rows)
    by_inputs = ca.jacobian(values, ca.vertcat(*symbols.values_of(context.u.symbols)))
    return ca.horzcat(_by_parameters(context, symbols, values), by_inputs)


def derivatives(equations: Equations) -> Iterator[ModelConstant]:
    """The derivatives of constants with respect to parameters that are not zero."""
    for c in equations.coefficients:
        for p in equations.parameters:
            value = sp.S.Zero if c.zero else sp.diff(c.value, p.symbol)
            if value != 0:
                doc = f"derivative of {c.symbol} by {p.symbol}"
                yield ModelConstant(_derivative(c.symbol, p.symbol), value, c.equation, doc, f"({c.unit})/({p.unit})")


def _derivative(constant: sp.Symbol, parameter: sp.Symbol) -> sp.Symbol:
    return local(f"{constant}_by_{parameter}")


def _by_parameters(context: Context, symbols: Symbols, rows: ca.SX) -> ca.SX:
    """The derivatives of rows with respect to the parameters (rows, parameters)."""
    eq = context.equations
    known = {c.symbol for c in context.coefficients}
    constants = list(dict.fromkeys(c.symbol for c in context.coefficients if not c.value.is_Rational))
    by_constants = ca.jacobian(rows, ca.vertcat(*symbols.values_of(constants)))
    for lookup, value in symbols.lookups.items():  # symbols to CasADi, which does not see what is in their arguments
        for i, c in enumerate(constants):
            if slope := sp.diff(lookup, c):
                by_constants[:, i] += ca.jacobian(rows, value) * symbols(slope)
    of_constants = ca.SX(len(constants), len(eq.parameters))
    for i, c in enumerate(constants):
        for j, p in enumerate(eq.parameters):
            derivative = _derivative(c, p.symbol)
            if derivative in known:
                of_constants[i, j] = symbols.values[derivative]
    return ca.mtimes(by_constants, of_constants)
