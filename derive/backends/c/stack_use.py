"""The stack that a function of the generated C takes at most, from the values that its kernel names."""

from __future__ import annotations

from typing import assert_never

from derive.ir.analysis import expressions
from derive.ir.expressions import Operation, Operator, walk
from derive.ir.model import Kernel
from derive.ir.statements import (
    LANES,
    Accumulate,
    Cholesky,
    Clear,
    Let,
    Map,
    MatrixStore,
    MatVec,
    Pack,
    Require,
    RequireFinite,
    Statement,
    Store,
    StoreLocal,
    TriangularSolve,
    padded,
)

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
    processors with 32 and 64 bits, for all levels of optimisation.
    """
    used = kernel.used
    read = sum(name in used for argument in kernel.arguments for _, name in argument.named_elements)
    arrays: dict[str, int] = {}
    numbers = read + sum(_numbers(statement, arrays) + SINE * _sines(statement) for statement in kernel.statements)
    return DOUBLE * (COPIES * numbers + sum(arrays.values())) + FRAME


def _sines(statement: Statement) -> int:
    parts = (part for expr in expressions(statement) for part in walk(expr) if isinstance(part, Operation))
    return sum(part.kind in (Operator.SIN, Operator.COS) for part in parts)


def _numbers(statement: Statement, arrays: dict[str, int]) -> int:
    """The numbers that a statement names; the sizes of its local arrays are added to `arrays`."""
    match statement:
        case Let():
            return 1
        case Map():
            for item in statement.body:
                if isinstance(item, StoreLocal):
                    arrays[item.array] = padded(statement.count)
            return sum(isinstance(item, Let) for item in statement.body)
        case Accumulate():
            return len(statement.lets) + (1 + LANES) * len(statement.sums)
        case MatVec():
            size = statement.packing.padded
            for term in statement.terms:
                arrays[term.name] = size
            return LANES * len(statement.terms)
        case TriangularSolve():
            return len(statement.arrays)
        case MatrixStore() | Pack() | Cholesky():
            return LANES
        case Store() | Require() | Clear() | RequireFinite():
            return 0
        case _:
            assert_never(statement)
