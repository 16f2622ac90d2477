"""The derivatives of the equations of motion with respect to the parameters, for sensitivities and gradients.

With y = [q; v; lambda] and its rate fixed, a parameter p acts through the constants c of the model, which depend on
parameters alone: dF/dp = (dF/dc) (dc/dp). CasADi has the first factor, SymPy the second, which setup computes. The rows
are those from which all forms of a scene are made: of M vdot + h - G^T lambda, of g, of gdot, and of G vdot - gamma; a
body has the first alone. Kinematics, qdot = v, has no parameters.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import casadi as ca
import sympy as sp

from derive.ir.model import Kernel
from derive.ir.patterns import pattern
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.constraints import acceleration_residual, jacobian_entries
from derive.lowering.flat.context import Context, array_input, stores
from derive.lowering.flat.schedule import Step
from derive.lowering.functions import ModelFunction, OutputElements
from derive.mechanics.equations import Equations
from derive.mechanics.symbols import local, state_rate
from derive.mechanics.terms import ModelConstant


def with_derivatives(equations: Equations) -> Equations:
    """The equations with the derivatives of their constants with respect to the parameters as further constants."""
    return replace(equations, coefficients=(*equations.coefficients, *_derivatives(equations)))


def parameter_jacobian(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the derivatives with respect to the parameters, of equations `with_derivatives`."""
    eq, multipliers = context.equations, context.forces
    y = array_input("y", context.state + multipliers, "state [q; v; lambda]" if multipliers else context.y.argument.doc)
    ydot = array_input("ydot", (*context.state_rates, *map(state_rate, multipliers)), "time derivative of y")
    symbols = context.symbols(context.t, y, ydot)
    rows = _rows(context, symbols)
    by_parameters = _by_parameters(context, symbols, ca.vertcat(*rows.values()))
    names = tuple(str(p.symbol) for p in eq.parameters)
    entries = set(zip(*by_parameters.sparsity().get_triplet(), strict=True))
    shape = pattern(len(rows), len(names), entries)
    residuals = tuple(rows)
    labels = tuple(f"d {residuals[i]} / d {names[j]}" for i, j in shape.entries)
    values = [by_parameters[i, j] for i, j in shape.entries]
    return context.kernel(
        function,
        {"jac": OutputElements(labels, shape)},
        symbols,
        Step("parameter_jacobian", "(15)", "derivatives of the rows by the parameters", stores("jac", values)),
        inputs=(y, ydot),
    )


def _rows(context: Context, symbols: Symbols) -> dict[str, ca.SX]:
    """The rows that depend on parameters, by their names."""
    eq = context.equations
    reactions = {row.name: ca.SX(0) for row in eq.rows}
    if eq.constraints:
        for (i, j), value in jacobian_entries(context, symbols).items():
            reactions[context.rows[j]] += value * symbols.values[context.forces[i]]
    rows = {f"F[{row.name}]": symbols(eq.sum_of(row.name)) - reactions[row.name] for row in eq.rows}
    rows |= {f"g[{c.name}]": symbols(c.position) for c in eq.constraints}
    rows |= {f"gdot[{c.name}]": symbols(c.rate) for c in eq.constraints}
    return rows | {f"gddot[{c.name}]": acceleration_residual(c, context, symbols) for c in eq.constraints}


def _derivatives(equations: Equations) -> Iterator[ModelConstant]:
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
    constants = [c.symbol for c in context.coefficients if not c.value.is_Rational]
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
