"""The cost of a Kernel: the arithmetic operations of its statements."""

from __future__ import annotations

from fractions import Fraction
from typing import assert_never

from derive.ir.expressions import Expr, Number, Operation, walk
from derive.ir.statements import (
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
    TriangularSolve,
)


def operations(statement: Statement) -> int:
    """Arithmetic operations of a statement; a sine or a cosine counts as one, padding does not count."""
    match statement:
        case Let() | Store() | Require():
            return _operations_of(statement.expr)
        case Map():
            return statement.count * sum(_operations_of(item.expr) for item in statement.body)
        case Accumulate():
            once = sum(1 + _operations_of(s.base) for s in statement.sums if s.base != Number(Fraction(0)))
            term = sum(1 + _operations_of(s.term) for s in statement.sums)
            term += sum(_operations_of(let.expr) for let in statement.lets)
            return once + statement.count * term
        case MatVec():
            return 2 * statement.packing.count**2 * sum(len(term.sums) for term in statement.terms)
        case MatrixStore():
            n = statement.packing.count
            diagonal = n * (1 + _operations_of(statement.diagonal)) if statement.diagonal else 0
            return n**2 * _operations_of(statement.expr) + diagonal
        case Cholesky():
            return statement.count**3 // 3 + statement.count**2
        case TriangularSolve():
            return statement.count**2 * len(statement.arrays)
        case Pack() | Clear() | RequireFinite():
            return 0
        case _:
            assert_never(statement)


def _operations_of(expr: Expr) -> int:
    return sum(isinstance(part, Operation) for part in walk(expr))
