"""The stack that a function of the generated C takes at most, from the values that its kernel names."""

from __future__ import annotations

from collections.abc import Iterable

from derive.ir.analysis import expressions
from derive.ir.expressions import Operation, Operator, walk
from derive.ir.indices import LANES
from derive.ir.kernel import Kernel
from derive.ir.lanes import section_in_lanes
from derive.ir.loop_nests import Accumulator, For, Local, LoopKind, Node, every
from derive.ir.statements import Let, Statement

DOUBLE = 8
"""The size of a double, in bytes."""
COPIES = 2
"""Places on the stack for each named number: compilers keep sub-expressions beside them, or the lanes of vectors."""
SINE = 24
"""Numbers that the computation of a sine or a cosine names; without optimisation each has its own place."""
FRAME = 256
"""Bytes for saved registers, the addresses of the arguments and the counters of loops."""


def stack_bytes(kernel: Kernel) -> int:
    """The bytes of stack that the C function of a kernel takes at most; functions of <math.h> come on top.

    It is a bound by experience: `tests/emit/test_stack_use.py` compares it with what gcc and clang state for
    processors with 32 and 64 bits, for all levels of optimisation. The arrays of the lanes of sums are the copies of
    the numbers in which these are computed.
    """
    used = kernel.used
    nodes = [node for s in kernel.sections for _, part in section_in_lanes(s.body) for node in every(part)]
    read = sum(name in used for argument in kernel.arguments for _, name in argument.named_elements)
    arrays = {node.array: node.size for node in nodes if isinstance(node, Local) and not node.totals}
    sums = {node.name for node in nodes if isinstance(node, Accumulator)}
    named = sum(isinstance(node, Let | For) for node in nodes) + (LANES - 1) * _vectors(nodes)
    numbers = read + named + LANES * len(sums) + SINE * sum(map(_sines, kernel.statements))
    return DOUBLE * (COPIES * numbers + sum(arrays.values())) + FRAME


def _vectors(nodes: Iterable[Node]) -> int:
    """The values that loops over bodies name for all lanes at once."""
    loops = [node for node in nodes if isinstance(node, For) and (node.overlaps or node.kind is LoopKind.ENDS)]
    return sum(isinstance(node, Let) for loop in loops for node in every(loop.body))


def _sines(statement: Statement) -> int:
    parts = (part for expr in expressions(statement) for part in walk(expr) if isinstance(part, Operation))
    return sum(part.kind in (Operator.SIN, Operator.COS) for part in parts)
