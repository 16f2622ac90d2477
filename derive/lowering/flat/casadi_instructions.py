"""Conversion of CasADi functions to the expression graph: their instructions as exact operations.

CasADi finds the common sub-expressions; numbers, which it holds as doubles, become exact again.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

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


def read_expressions(
    graph: Graph, symbols: Symbols, outputs: list[ca.SX], also: Mapping[int, Sequence[int]] | None = None
) -> list[int | None]:
    """The nodes of CasADi scalars, which are added to the graph and share sub-expressions. Raises LoweringError.

    also: the outputs that are read only if others need them, each with the outputs that are needed with it; None is the
    node of those that are not.
    """
    also = also or {}
    column = ca.vertcat(*outputs) if outputs else ca.SX(0, 1)
    options = {"cse": True, "live_variables": False}
    function = ca.Function("kernel", [ca.vertcat(*symbols.inputs)], [ca.densify(column)], options)
    # Without live variables, each value has a place of its own, in the order of the instructions.
    read: list[tuple[int, int, Sequence[int]]] = []
    places: dict[int, int] = {}
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        inputs: Sequence[int] = () if operation == ca.OP_CONST else function.instruction_input(k)
        if operation == ca.OP_OUTPUT:
            places[function.instruction_output(k)[1]] = inputs[0]
        else:
            read.append((k, operation, inputs))
    needed = _needed(read, places, also)
    work = [0] * len(read)
    for place, (k, operation, inputs) in enumerate(read):
        if not needed[place]:
            continue
        if operation == ca.OP_INPUT:
            work[place] = graph.leaf(symbols.leaves[inputs[1]])
        elif operation == ca.OP_CONST:
            work[place] = graph.number(_integer(function.instruction_constant(k)))
        else:
            work[place] = _operation(graph, operation, [work[i] for i in inputs])
    return [graph.settled(work[p]) if needed[p] else None for _, p in sorted(places.items())]


def _needed(
    read: Sequence[tuple[int, int, Sequence[int]]], places: Mapping[int, int], also: Mapping[int, Sequence[int]]
) -> list[bool]:
    """Whether each value of a function is needed; `also` as for `read_expressions`."""
    needed = [False] * len(read)

    def need(outputs: Iterable[int]) -> None:
        waiting = [places[output] for output in outputs]
        while waiting:
            place = waiting.pop()
            if not needed[place]:
                needed[place] = True
                _, operation, inputs = read[place]
                waiting += () if operation == ca.OP_INPUT else inputs

    need(output for output in places if output not in also)
    need(other for output, others in also.items() if needed[places[output]] for other in others)
    return needed


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
