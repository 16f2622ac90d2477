"""The iteration matrix of a model with loops in closed form, column by column: derivatives of sums are sums again."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.ir.kernel import Kernel
from derive.ir.patterns import ColumnGroup, RowSet, RowSetKind, block_pattern
from derive.ir.statements import MatrixStore, Store, StoreStrided
from derive.lowering.loops.assignments import NOTHING, IndexedStore, Scalar
from derive.lowering.loops.context import CJ, RIGID, SHAPE, LoopContext
from derive.lowering.loops.gradient import derivative
from derive.lowering.model_functions import ModelFunction, OutputElements
from derive.mechanics.sums import ALPHA, ALPHADDOT, ALPHADOT

if TYPE_CHECKING:
    from derive.mechanics.typed_symbol import Symbol


def jacobian(context: LoopContext, function: ModelFunction) -> Kernel:
    """dF/dy + cj dF/dydot in closed form: derivatives of sums are sums again."""
    columns = _Columns(context)
    for k, q in enumerate(context.elements["q"]):
        columns.coordinate(k, q)
    columns.shapes(ALPHA, None, CJ)
    for r, row in enumerate(context.rigid_rows):
        columns.rate(r, row.v, row.a)
    columns.shapes(ALPHADOT, ALPHADDOT, -sp.S.One)
    program = context.program(context.y, context.ydot, context.cj)
    doc = "derivatives of the residual"
    program.phase("jacobian", "(15)", doc, columns.scalars, columns.rows, columns.pairs)
    size = 2 * context.n + 2 * RIGID + 1
    shape = block_pattern(size, tuple(columns.groups))
    return program.kernel(
        function,
        context.inputs,
        {"jac": OutputElements(("see its pattern",), shape, len(shape.rowidx))},
    )


class _Columns:
    """The stores of the columns of the iteration matrix, added one after the other."""

    def __init__(self, context: LoopContext) -> None:
        self.context = context
        self.scalars: list[Scalar] = []
        self.rows: list[IndexedStore] = []
        self.pairs: list[tuple[MatrixStore, sp.Expr, sp.Expr]] = []
        self.groups: list[ColumnGroup] = []
        self.offset = 0
        self.first = RIGID + 1 + context.n
        self._totals: dict[tuple[sp.Expr, sp.Symbol], sp.Expr] = {}

    def coordinate(self, k: int, symbol: sp.Symbol) -> None:
        """Add the column of a rigid coordinate, one of c1 .. c3 and e0 .. e3."""
        kinematic = [
            (r, -derivative(rate, symbol) + (CJ if r == k else 0)) for r, rate in enumerate(self.context.rigid_rates)
        ]
        self._single(kinematic, lambda e: self._factored(e, symbol))

    def rate(self, r: int, symbol: sp.Symbol, acceleration: sp.Symbol) -> None:
        """Add the column of a rigid generalised velocity."""
        kinematic = [(k, -derivative(rate, symbol)) for k, rate in enumerate(self.context.rigid_rates)]
        self._single(kinematic, lambda e: self._total(e, symbol) + CJ * derivative(e, acceleration))

    def _factored(self, expr: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
        """A derivative, through the definitions as well, with common factors: in the form with fewer operations.

        Columns of the attitude share either the factors of the entries of Q or those of the mode sums.
        """
        expanded = self._total(expr, symbol)
        if expanded == 0:
            return expanded
        inner = {d.symbol: self._total(d.expr, symbol) for d in self.context.equations.definitions if not d.zero}
        chain = sp.Add(
            derivative(expr, symbol), *(derivative(expr, s) * change for s, change in inner.items() if change != 0)
        )
        present = expanded.free_symbols
        collected = sp.collect(expanded, [s for s in self.context.gradient.mode_sums if s in present])
        return min(chain, collected, key=sp.count_ops)

    def _total(self, expr: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
        """The total derivative of an expression, through the definitions as well; those of definitions recur."""
        if (expr, symbol) not in self._totals:
            parts, symbols = [derivative(expr, symbol)], expr.free_symbols
            for d in self.context.equations.definitions:
                if not d.zero and d.symbol in symbols:
                    parts.append(derivative(expr, d.symbol) * self._total(d.expr, symbol))
            self._totals[expr, symbol] = sp.expand(sp.Add(*parts))
        return self._totals[expr, symbol]

    def _single(self, kinematic: list[tuple[int, sp.Expr]], derivative: Callable[[sp.Expr], sp.Expr]) -> None:
        left = self.context.left
        dynamic = [(self.first + r, derivative(left[name])) for r, name in enumerate(self.context.rows)]
        entries = [(row, e) for row, e in (*kinematic, *dynamic) if e != 0]
        self.scalars += [(Store("jac", self.offset + k, NOTHING), e) for k, (_, e) in enumerate(entries)]
        self.offset += len(entries)
        pieces = [RowSet(RowSetKind.ROW, row) for row, _ in entries]
        shape = derivative(left[SHAPE]) if self.context.n else sp.S.Zero
        if shape != 0:
            self.rows.append((StoreStrided("jac", self.offset, 1, NOTHING), shape))
            self.offset += self.context.n
            pieces.append(RowSet(RowSetKind.RANGE, self.first + RIGID, self.context.n))
        self.groups.append(ColumnGroup(1, tuple(pieces)))

    def shapes(self, factor: Symbol, acceleration: Symbol | None, kinematic: sp.Expr) -> None:
        """Add the columns of alpha or alphadot."""
        context, n = self.context, self.context.n
        if not n:
            return
        gradient = context.gradient

        def of(expr: sp.Expr) -> sp.Expr:
            accelerated = CJ * gradient.of_scalar(expr, acceleration) if acceleration else 0
            return sp.expand(gradient.of_scalar(expr, factor) + accelerated)

        rigid = [(self.first + r, of(context.left[name])) for r, name in enumerate(context.rows)]
        entries = [(row, e) for row, e in rigid if e != 0]
        full, diagonal = gradient.of_row(context.left[SHAPE], factor)
        if acceleration:
            more, below = gradient.of_row(context.left[SHAPE], acceleration)
            full, diagonal = sp.expand(full + CJ * more), sp.expand(diagonal + CJ * below)
        block = (
            RowSet(RowSetKind.RANGE, self.first + RIGID, n)
            if full != 0
            else RowSet(RowSetKind.DIAGONAL, self.first + RIGID)
        )
        stride = 1 + len(entries) + (n if full != 0 else 1)
        self.rows.append((StoreStrided("jac", self.offset, stride, NOTHING), kinematic))
        for k, (_, e) in enumerate(entries, 1):
            self.rows.append((StoreStrided("jac", self.offset + k, stride, NOTHING), e))
        offset = self.offset + 1 + len(entries)
        if full != 0:
            self.pairs.append(
                (MatrixStore(context.layout.packing, "jac", offset, stride, NOTHING, None), full, diagonal)
            )
        else:
            self.rows.append((StoreStrided("jac", offset, stride, NOTHING), diagonal))
        pieces = (RowSet(RowSetKind.DIAGONAL, RIGID + 1), *(RowSet(RowSetKind.ROW, r) for r, _ in entries))
        self.groups.append(ColumnGroup(n, (*pieces, block)))
        self.offset += n * stride
