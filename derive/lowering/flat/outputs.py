"""The outputs of a mechanism and their derivatives in straight-line code."""

from __future__ import annotations

import casadi as ca

from derive.ir.kernel import Kernel
from derive.ir.patterns import pattern
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context, Input, stores
from derive.lowering.flat.schedule import Step
from derive.lowering.model_functions import ModelFunction, OutputElements


def outputs(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the outputs."""
    symbols, values = _values(context)
    return context.kernel(
        function,
        {"out": OutputElements(tuple(output.name for output in context.equations.outputs))},
        symbols,
        Step("outputs", "", "outputs in the order of the specification", stores("out", values)),
    )


def outputs_jacobian(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the derivatives of the outputs with respect to q, v, vdot, lambda and u."""
    symbols, values = _values(context)
    arguments = _arguments(context)
    columns = [symbol for argument in arguments for symbol in argument.symbols]
    matrix = ca.jacobian(ca.vertcat(*values), ca.vertcat(*symbols.values_of(columns)))
    shape = pattern(len(values), len(columns), set(zip(*matrix.sparsity().get_triplet(), strict=True)))
    rows = [output.name for output in context.equations.outputs]
    labels = tuple(f"d {rows[i]} / d {columns[j].name}" for i, j in shape.entries)
    return context.kernel(
        function,
        {"jac": OutputElements(labels, shape)},
        symbols,
        Step("jacobian", "", "derivatives of the outputs", stores("jac", [matrix[i, j] for i, j in shape.entries])),
    )


def _arguments(context: Context) -> tuple[Input, ...]:
    """The arguments with respect to which outputs are differentiated."""
    return context.q, context.v, context.vdot, context.lam, context.u


def _values(context: Context) -> tuple[Symbols, list[ca.SX]]:
    """The outputs, and the symbols in terms of which CasADi differentiates them."""
    symbols = context.symbols(context.t, context.q, context.v, context.vdot, context.lam)
    return symbols, [symbols(output.expr) for output in context.equations.outputs]
