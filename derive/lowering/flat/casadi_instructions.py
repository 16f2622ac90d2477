"""Conversion of CasADi functions to the expression graph: their instructions as exact operations.

CasADi finds the common sub-expressions; numbers, which it holds as doubles, become exact again.
"""

from __future__ import annotations

import math

import casadi as ca

from derive.ir.expressions import Operator
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.graph import ZERO_DIVISOR, Graph, LoweringError

BINARY = {
    ca.OP_ADD: Operator.ADD,
    ca.OP_SUB: Operator.SUB,
    ca.OP_MUL: Operator.MUL,
    ca.OP_DIV: Operator.DIV,
    ca.OP_ATAN2: Operator.ATAN2,
    ca.OP_FMIN: Operator.MIN,
    ca.OP_FMAX: Operator.MAX,
    ca.OP_LT: Operator.LESS,
    ca.OP_LE: Operator.NOT_GREATER,
    ca.OP_IF_ELSE_ZERO: Operator.WHEN,
}
UNARY = {
    ca.OP_NEG: Operator.NEG,
    ca.OP_SIN: Operator.SIN,
    ca.OP_COS: Operator.COS,
    ca.OP_SQRT: Operator.SQRT,
    ca.OP_EXP: Operator.EXP,
    ca.OP_LOG: Operator.LOG,
    ca.OP_TANH: Operator.TANH,
    ca.OP_SIGN: Operator.SIGN,
    ca.OP_NOT: Operator.NOT,
}


def read_expressions(graph: Graph, symbols: Symbols, outputs: list[ca.SX]) -> list[int]:
    """The nodes of CasADi scalars, which are added to the graph and share sub-expressions. Raises LoweringError."""
    column = ca.vertcat(*outputs) if outputs else ca.SX(0, 1)
    options = {"cse": True, "live_variables": False}
    function = ca.Function("kernel", [ca.vertcat(*symbols.inputs)], [ca.densify(column)], options)
    work: list[int] = []  # without live variables, each value has a place of its own, in the order of the instructions
    result = [0] * len(outputs)
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        if operation == ca.OP_OUTPUT:
            (value,) = function.instruction_input(k)
            result[function.instruction_output(k)[1]] = graph.settled(work[value])
        elif operation == ca.OP_INPUT:
            work.append(graph.leaf(symbols.leaves[function.instruction_input(k)[1]]))
        elif operation == ca.OP_CONST:
            work.append(graph.number(_integer(function.instruction_constant(k))))
        else:
            work.append(_operation(graph, operation, [work[i] for i in function.instruction_input(k)]))
    return result


def _operation(graph: Graph, operation: int, args: list[int]) -> int:
    """The node of a CasADi operation. Raises LoweringError, NotImplementedError."""
    if operation in BINARY:
        return graph.apply(BINARY[operation], *args)
    if operation in UNARY:
        return graph.apply(UNARY[operation], args[0])
    if operation == ca.OP_SQ:
        return graph.apply(Operator.MUL, args[0], args[0])
    if operation == ca.OP_TWICE:
        return graph.apply(Operator.MUL, graph.number(2), args[0])
    if operation == ca.OP_INV:
        return graph.apply(Operator.DIV, graph.number(1), args[0])
    if operation == ca.OP_FABS:
        raise LoweringError("the root of a square, such as sqrt(t^2), has a kink; write abs(t)")
    raise NotImplementedError(f"CasADi operation {operation} has no counterpart in a kernel")


def _integer(value: float) -> int:
    """A CasADi constant as an integer.

    Raises LoweringError if it is infinite, the inverse of a pivot that is zero; ArithmeticError if it is a fraction,
    which would be a rounded number.
    """
    if not math.isfinite(value):
        raise LoweringError(ZERO_DIVISOR)
    if value != int(value):
        raise ArithmeticError(f"CasADi has rounded a number to {value}")
    return int(value)
