"""Analysis of statements: their expressions, the names that they read, and their arithmetic operations."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import assert_never

from derive.ir.expressions import ArrayAccess, Expr, Number, Operation, ScalarRef, TableValue, walk
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


def expressions(statement: Statement) -> tuple[Expr, ...]:
    """The expressions in a statement."""
    match statement:
        case Let() | Store() | Require():
            return (statement.expr,)
        case Map():
            return tuple(item.expr for item in statement.body)
        case Accumulate():
            return (*(let.expr for let in statement.lets), *(e for s in statement.sums for e in (s.base, s.term)))
        case MatrixStore():
            return (statement.expr,) if statement.diagonal is None else (statement.expr, statement.diagonal)
        case MatVec() | Pack() | Clear() | RequireFinite() | Cholesky() | TriangularSolve():
            return ()
        case _:
            assert_never(statement)


def reads(statement: Statement) -> Iterator[str]:
    """The names that a statement reads: scalars and arrays, but not the argument of a `RequireFinite` as a whole."""
    for part in (part for expr in expressions(statement) for part in walk(expr)):
        if isinstance(part, ScalarRef):
            yield part.name
        elif isinstance(part, ArrayAccess):
            yield part.array
    match statement:
        case MatVec():
            yield statement.packing.array
            for term in statement.terms:
                yield from (product.vector for product in term.sums)
                yield from (term.base,) if term.base else ()
        case MatrixStore():
            yield statement.packing.array
        case Pack():
            yield from (source.array for source in statement.sources)
        case Cholesky():
            yield statement.source
        case TriangularSolve():
            yield statement.factor
        case Let() | Store() | Require() | Map() | Accumulate() | Clear() | RequireFinite():
            pass
        case _:
            assert_never(statement)


def operations(statement: Statement) -> int:
    """Arithmetic operations of a statement; a sine or a look-up counts as one, padding does not count."""
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
    return sum(isinstance(part, Operation | TableValue) for part in walk(expr))
