"""Run a Kernel in Python on any numbers that know + - * /: floats, fractions, mpmath, SymPy or CasADi symbols."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

from derive.errors import TisserandError
from derive.ir.expressions import At, Entry, Expr, Let, Num, Ref
from derive.ir.kernel import Kernel, Require, Statement, Store
from derive.ir.loops import (
    LANES,
    Clear,
    Contract,
    Each,
    Pack,
    Packing,
    Pairs,
    Put,
    Reduce,
    RequireAll,
    Root,
    Substitute,
)

BINARY: dict[str, Callable[[Any, Any], Any]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
}


class RequirementError(TisserandError):
    """A requirement of a kernel does not hold; `code` is what the generated C returns."""

    def __init__(self, code: int, text: str) -> None:
        self.code = code
        super().__init__(text)


def interpret(
    kernel: Kernel,
    arguments: Mapping[str, Any],
    *,
    number: Callable[[Fraction], Any] = float,
    functions: Mapping[str, Callable[[Any], Any]] | None = None,
    check: bool = True,
) -> dict[str, list[Any]]:
    """The outputs of a kernel: lists of the sizes of `kernel.outputs`.

    `arguments` maps each argument to a sequence (to a number, if scalar); `number` turns exact constants into the
    numbers wanted, `functions` gives their `sin`, `cos` and, for `Root`, `sqrt`. Raises RequirementError (with
    `check`).
    """
    call = {"sin": math.sin, "cos": math.cos, "sqrt": math.sqrt, **(functions or {})}
    run = _Run(kernel, arguments, number, call, check)
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
        call: Mapping[str, Callable[[Any], Any]],
        check: bool,
    ) -> None:
        self.number, self.call, self.check = number, call, check
        self.zero = number(Fraction(0))
        self.values: dict[str, Any] = {}
        self.arrays: dict[str, list[Any]] = {}
        for a in kernel.arguments:
            given: Any = arguments[a.name]
            if a.scalar:
                self.values[a.name] = given
                continue
            if len(given) != a.size:
                raise ValueError(f"{a.name} needs {a.size} elements, not {len(given)}")
            self.arrays[a.name] = list(given)
            self.values |= {name: given[place] for place, name in a.places}
            self.arrays |= {v.name: list(given[v.offset : v.offset + v.size]) for v in a.arrays}
        self.outputs: dict[str, list[Any]] = {o.name: [None] * o.size for o in kernel.outputs}

    def value(self, expr: Expr, i: int = 0, j: int = 0, packing: Packing | None = None) -> Any:
        """An expression, in a loop at i (and j)."""
        match expr:
            case Num():
                return self.number(expr.value)
            case Ref():
                return self.values[expr.name]
            case At():
                place = expr.offset + expr.stride * (i if expr.index == "i" else j)
                return self.arrays[expr.array][place]
            case Entry():
                assert packing is not None
                return self.arrays[packing.array][packing.place(expr.table, i, j)]
        operands = [self.value(arg, i, j, packing) for arg in expr.args]
        if expr.kind == "neg":
            return -operands[0]
        return BINARY[expr.kind](*operands) if expr.kind in BINARY else self.call[expr.kind](*operands)

    def step(self, statement: Statement) -> None:
        """Run one statement."""
        match statement:
            case Let():
                self.values[statement.name] = self.value(statement.expr)
            case Store():
                self.outputs[statement.output][statement.index] = self.value(statement.expr)
            case Require():
                self._require(statement)
            case Each():
                self._each(statement)
            case Reduce():
                self._reduce(statement)
            case Contract():
                self._contract(statement)
            case Pairs():
                self._pairs(statement)
            case Pack():
                self._pack(statement)
            case Clear():
                self.outputs[statement.output] = [self.zero] * statement.count
            case RequireAll():
                if self.check and not all(map(math.isfinite, self.arrays[statement.argument])):
                    raise RequirementError(statement.code, statement.text)
            case Root():
                self._root(statement)
            case Substitute():
                self._substitute(statement)

    def _require(self, statement: Require) -> None:
        result = self.value(statement.expr)
        if self.check and not (result > 0 if statement.kind == "positive" else math.isfinite(result)):
            raise RequirementError(statement.code, statement.text)

    def _each(self, loop: Each) -> None:
        for item in loop.body:
            if isinstance(item, Put):
                self.arrays[item.array] = [self.zero] * loop.count
        for i in range(loop.count):
            for item in loop.body:
                value = self.value(item.expr, i)
                if isinstance(item, Let):
                    self.values[item.name] = value
                elif isinstance(item, Put):
                    self.arrays[item.array][i] = value
                else:
                    self.outputs[item.output][item.offset + item.stride * i] = value

    def _reduce(self, loop: Reduce) -> None:
        lanes = [[self.zero] * LANES for _ in loop.sums]
        for i in range(loop.count):
            for let in loop.lets:
                self.values[let.name] = self.value(let.expr, i)
            for lane, one in zip(lanes, loop.sums, strict=True):
                lane[i % LANES] = lane[i % LANES] + self.value(one.term, i)
        for (a, b, c, d), one in zip(lanes, loop.sums, strict=True):
            self.values[one.name] = self.value(one.base) + ((a + b) + (c + d))

    def _contract(self, loop: Contract) -> None:
        packing = loop.packing
        tables, n = self.arrays[packing.array], packing.count
        for lane in loop.lanes:
            y = list(self.arrays[lane.base][:n]) if lane.base else [self.zero] * n
            for first in range(0, n, LANES):
                for vector, table in lane.sums:
                    x = self.arrays[vector]
                    for i in range(n):
                        for j in range(first, min(first + LANES, n)):
                            y[i] = y[i] + tables[packing.place(table, i, j)] * x[j]
            self.arrays[lane.name] = y

    def _pairs(self, loop: Pairs) -> None:
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
                    place = triangle(n, min(i, j), max(i, j), source.parity)
                    value = self.zero
                    if place is not None:
                        value = self.arrays[source.array][place * source.components + source.component]
                        value = -value if i > j and source.parity < 0 else value
                    self.outputs[loop.output][loop.packing.place(source.table, i, j)] = value

    def _root(self, s: Root) -> None:
        n, source = s.count, self.arrays[s.source]
        low = [[self.zero] * n for _ in range(n)]
        for i in range(n):
            for j in range(i + 1):
                place = triangle(n, j, i, 1)
                assert place is not None
                low[i][j] = source[place]
        for j in range(n):
            for i in range(j, n):
                for m in range(j):
                    low[i][j] = low[i][j] - low[i][m] * low[j][m]
            if self.check and not low[j][j] > 0:
                raise RequirementError(s.code, s.text)
            inverse = self.number(Fraction(1)) / self.call["sqrt"](low[j][j])
            for i in range(j + 1, n):
                low[i][j] = low[i][j] * inverse
            low[j][j] = inverse
        for j in range(n):
            for i in range(n):
                self.outputs[s.output][s.offset + j * n + i] = low[i][j]

    def _substitute(self, s: Substitute) -> None:
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


def triangle(n: int, i: int, j: int, parity: int) -> int | None:
    """Where the pair i <= j lies among those of the upper triangle by rows; an odd table has no diagonal."""
    if parity > 0:
        return i * n - i * (i - 1) // 2 + j - i
    return None if i == j else i * (n - 1) - i * (i - 1) // 2 + j - i - 1
