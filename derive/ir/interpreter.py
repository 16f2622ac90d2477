"""Run a Kernel in Python on any numbers that know + - * /: floats, fractions, mpmath, SymPy or CasADi symbols."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any, assert_never

from derive.errors import TisserandError
from derive.ir.expressions import (
    ArrayAccess,
    Expr,
    MatrixEntry,
    Number,
    Operation,
    Operator,
    ScalarRef,
    TableValue,
)
from derive.ir.model import Kernel
from derive.ir.operator_functions import ARITHMETIC, LIBRARY
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
    Packing,
    Require,
    RequireFinite,
    Requirement,
    ReturnCode,
    Statement,
    Store,
    StoreLocal,
    StoreStrided,
    TriangularSolve,
)


class RequirementError(TisserandError, ArithmeticError):
    """A requirement of a kernel does not hold; `code` is what the generated C returns."""

    def __init__(self, code: ReturnCode, text: str) -> None:
        self.code = code
        super().__init__(text)


def interpret(
    kernel: Kernel,
    arguments: Mapping[str, Any],
    *,
    number: Callable[[Fraction], Any] = float,
    functions: Mapping[str, Callable[..., Any]] | None = None,
    check: bool = True,
    tables: Mapping[str, Callable[[Any, int], Any]] | None = None,
) -> dict[str, list[Any]]:
    """The outputs of a kernel: by their names, lists of the sizes of `kernel.outputs`.

    arguments: by their names, sequences of the sizes of the arguments, or numbers for scalars; number: converts exact
    constants into the type of number; functions: `sin`, `cos`, `sqrt` and the others of `LIBRARY` of that type; check:
    whether requirements are checked; tables: functions of an argument and the order of the derivative, by the names of
    the tables of the model, such as its splines. Raises RequirementError if a requirement does not hold, ValueError for
    a wrong length.
    """
    call = {**ARITHMETIC, **LIBRARY}
    call |= {Operator(name): function for name, function in (functions or {}).items()}
    run = _Run(kernel, arguments, number, call, check, tables or {})
    for statement in kernel.statements:
        run.step(statement)
    return run.outputs


class _Run:
    """Values and arrays by name while a kernel runs."""

    def __init__(
        self,
        kernel: Kernel,
        arguments: Mapping[str, Any],
        number: Callable[[Fraction], Any],
        call: Mapping[Operator, Callable[..., Any]],
        check: bool,
        tables: Mapping[str, Callable[[Any, int], Any]],
    ) -> None:
        self.number, self.call, self.check, self.tables = number, call, check, tables
        self.zero = number(Fraction(0))
        self.values: dict[str, Any] = {}
        self.arrays: dict[str, list[Any]] = {}
        for a in kernel.arguments:
            values: Any = arguments[a.name]
            if a.scalar:
                self.values[a.name] = values
                continue
            if len(values) != a.size:
                raise ValueError(f"{a.name} needs {a.size} elements, not {len(values)}")
            self.arrays[a.name] = list(values)
            self.values |= {name: values[index] for index, name in a.named_elements}
            self.arrays |= {v.name: list(values[v.offset : v.offset + v.size]) for v in a.arrays}
        self.outputs: dict[str, list[Any]] = {o.name: [None] * o.size for o in kernel.outputs}

    def value(self, expr: Expr, i: int = 0, j: int = 0, packing: Packing | None = None) -> Any:
        """An expression, in a loop at i (and j)."""
        match expr:
            case Number():
                return self.number(expr.value)
            case ScalarRef():
                return self.values[expr.name]
            case ArrayAccess():
                return self.arrays[expr.array][expr.offset + expr.stride * (i if expr.index == "i" else j)]
            case MatrixEntry():
                assert packing is not None
                return self.arrays[packing.array][packing.position(expr.table, i, j)]
            case Operation():
                return self.call[expr.kind](*(self.value(arg, i, j, packing) for arg in expr.args))
            case TableValue():
                return self.tables[expr.table](self.value(expr.argument, i, j, packing), expr.order)
            case _:
                assert_never(expr)

    def step(self, statement: Statement) -> None:
        """Run one statement."""
        match statement:
            case Let():
                self.values[statement.name] = self.value(statement.expr)
            case Store():
                self.outputs[statement.output][statement.index] = self.value(statement.expr)
            case Require():
                self._require(statement)
            case Map():
                self._map(statement)
            case Accumulate():
                self._accumulate(statement)
            case MatVec():
                self._matvec(statement)
            case MatrixStore():
                self._matrix_store(statement)
            case Pack():
                self._pack(statement)
            case Clear():
                self.outputs[statement.output] = [self.zero] * statement.count
            case RequireFinite():
                if self.check and not all(map(math.isfinite, self.arrays[statement.argument])):
                    raise RequirementError(statement.code, statement.text)
            case Cholesky():
                self._cholesky(statement)
            case TriangularSolve():
                self._triangular_solve(statement)
            case _:
                assert_never(statement)

    def _require(self, statement: Require) -> None:
        result = self.value(statement.expr)
        if self.check and not _meets(result, statement.kind):
            raise RequirementError(statement.code, statement.text)

    def _map(self, loop: Map) -> None:
        for item in loop.body:
            if isinstance(item, StoreLocal):
                self.arrays[item.array] = [self.zero] * loop.count
        for i in range(loop.count):
            for item in loop.body:
                value = self.value(item.expr, i)
                match item:
                    case Let():
                        self.values[item.name] = value
                    case StoreLocal():
                        self.arrays[item.array][i] = value
                    case StoreStrided():
                        self.outputs[item.output][item.offset + item.stride * i] = value
                    case _:
                        assert_never(item)

    def _accumulate(self, loop: Accumulate) -> None:
        lanes = [[self.zero] * LANES for _ in loop.sums]
        for i in range(loop.count):
            for let in loop.lets:
                self.values[let.name] = self.value(let.expr, i)
            for lane, total in zip(lanes, loop.sums, strict=True):
                lane[i % LANES] = lane[i % LANES] + self.value(total.term, i)
        for (a, b, c, d), total in zip(lanes, loop.sums, strict=True):
            self.values[total.name] = self.value(total.base) + ((a + b) + (c + d))

    def _matvec(self, loop: MatVec) -> None:
        packing = loop.packing
        tables, n = self.arrays[packing.array], packing.count
        for term in loop.terms:
            y = list(self.arrays[term.base][:n]) if term.base else [self.zero] * n
            for product in term.sums:
                x = self.arrays[product.vector]
                for i in range(n):
                    for j in range(n):
                        part = tables[packing.position(product.table, i, j)] * x[j]
                        y[i] = y[i] + part if product.sign > 0 else y[i] - part
            self.arrays[term.name] = y

    def _matrix_store(self, loop: MatrixStore) -> None:
        for j in range(loop.packing.count):
            for i in range(loop.packing.count):
                value = self.value(loop.expr, i, j, loop.packing)
                if i == j and loop.diagonal is not None:
                    value = value + self.value(loop.diagonal, i, j, loop.packing)
                self.outputs[loop.output][loop.offset + loop.stride * j + i] = value

    def _pack(self, loop: Pack) -> None:
        n = loop.packing.count
        for source in loop.sources:
            for i in range(n):
                for j in range(n):
                    index = triangle(n, min(i, j), max(i, j), source.parity)
                    value = self.zero
                    if index is not None:
                        value = self.arrays[source.array][index * source.components + source.component]
                        value = -value if i > j and source.parity < 0 else value
                    self.outputs[loop.output][loop.packing.position(source.table, i, j)] = value

    def _cholesky(self, s: Cholesky) -> None:
        n, source = s.count, self.arrays[s.source]
        low = [[self.zero] * n for _ in range(n)]
        for i in range(n):
            for j in range(i + 1):
                index = triangle(n, j, i, 1)
                assert index is not None
                low[i][j] = source[index]
        for j in range(n):
            for i in range(j, n):
                for m in range(j):
                    low[i][j] = low[i][j] - low[i][m] * low[j][m]
            if self.check and not low[j][j] > 0:
                raise RequirementError(s.code, s.text)
            inverse = self.number(Fraction(1)) / self.call[Operator.SQRT](low[j][j])
            for i in range(j + 1, n):
                low[i][j] = low[i][j] * inverse
            low[j][j] = inverse
        for j in range(n):
            for i in range(n):
                self.outputs[s.output][s.offset + j * n + i] = low[i][j]

    def _triangular_solve(self, s: TriangularSolve) -> None:
        n, low = s.count, self.arrays[s.factor]
        for name in s.arrays:
            y = self.arrays[name]
            for j in reversed(range(n)) if s.transposed else range(n):
                if s.transposed:
                    for i in range(j + 1, n):
                        y[j] = y[j] - low[j * n + i] * y[i]
                y[j] = y[j] * low[j * n + j]
                if not s.transposed:
                    for i in range(j + 1, n):
                        y[i] = y[i] - low[j * n + i] * y[j]


def _meets(value: Any, requirement: Requirement) -> bool:
    match requirement:
        case Requirement.POSITIVE:
            return bool(value > 0)
        case Requirement.FINITE:
            return math.isfinite(value)
        case _:
            assert_never(requirement)


def triangle(n: int, i: int, j: int, parity: int) -> int | None:
    """The index of the pair i <= j in the upper triangle by rows; an odd matrix (parity -1) has no diagonal."""
    if parity > 0:
        return i * n - i * (i - 1) // 2 + j - i
    return None if i == j else i * (n - 1) - i * (i - 1) // 2 + j - i - 1
