"""The context of a lowering to loops: arguments, data layout, expressions and the pattern of the mass matrix."""

from __future__ import annotations

from collections.abc import Mapping

from derive.algebra import sp
from derive.ir.expressions import Number, ScalarRef
from derive.ir.kernel import Argument, Section, View
from derive.ir.patterns import ColumnGroup, Pattern, RowSet, RowSetKind, block_pattern
from derive.ir.statements import Store, StoreStrided
from derive.lowering.loops import data_layout as store
from derive.lowering.loops.assignments import NOTHING, IndexedStore, Scalar
from derive.lowering.loops.gradient import Gradient, derivative
from derive.lowering.loops.program import Program
from derive.mechanics.fixed_symbols import t
from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.sums import ALPHADDOT
from derive.mechanics.symbols import Family, I, amplitude, local, quantity, state_rate
from derive.mechanics.tables import TableKind

ALPHAS = tuple(amplitude(I, derivative).identity.array for derivative in range(3))
"""The arrays of the amplitudes, their velocities and their accelerations."""
SHAPE = "alpha_i"
CJ = local("cj")
"""The factor of dF/dydot in the iteration matrix."""
RIGID = 6
"""The number of rows of the rigid motion; it has one coordinate more, because of the quaternion."""


class LoopContext:
    """The data that all kernels of one model share while it is lowered to loops."""

    def __init__(self, equations: IndexedEquations) -> None:
        self.equations = eq = equations
        self.n = eq.modes
        self.gradient = Gradient(eq)
        self.rigid_rows, self.rigid_rates = eq.rows[:RIGID], eq.rates[: RIGID + 1]
        self.rows = tuple(row.name for row in self.rigid_rows)
        q, v, a = (
            tuple(c.q for c in eq.coordinates[:7]),
            tuple(r.v for r in self.rigid_rows),
            tuple(r.a for r in self.rigid_rows),
        )
        self.elements = {"t": (t,), "q": q, "v": v, "cj": (CJ,), "y": q + v, "ydot": (*map(state_rate, q), *a)}
        positions, rates, accelerations = (tuple(s.name for s in symbols) for symbols in (q, v, a))
        n, coordinates = self.n, len(positions)
        self.t = Argument("t", (), "time (a free body does not depend on it)", scalar=True)
        self.q = Argument("q", positions, "generalised coordinates", arrays=(View(ALPHAS[0], coordinates, n),))
        self.v = Argument("v", rates, "generalised velocities", arrays=(View(ALPHAS[1], RIGID, n),))
        behind = tuple(range(coordinates)) + tuple(range(coordinates + n, coordinates + n + RIGID))
        self.y = Argument(
            "y",
            positions + rates,
            "first-order state [q; v]",
            arrays=(View(ALPHAS[0], coordinates, n), View(ALPHAS[1], coordinates + n + RIGID, n)),
            positions=behind,
        )
        self.ydot = Argument(
            "ydot",
            tuple(state_rate(symbol).name for symbol in q) + accelerations,
            "time derivative of y",
            arrays=(View("alpha_t", coordinates, n), View(ALPHAS[2], coordinates + n + RIGID, n)),
            positions=behind,
        )
        self.cj = Argument("cj", (), "factor of dF/dydot", scalar=True)
        self.layout = store.layout(eq)
        self.k = self.layout.argument
        every = (self.t, self.q, self.v, self.k, self.y, self.ydot, self.cj)
        self.inputs: Mapping[str, Argument] = {argument.name: argument for argument in every}
        self.left = {row: eq.sum_of(row) for row in self.rows}
        self.left[SHAPE] = eq.sum_of(SHAPE) if self.n else sp.S.Zero
        self.coupling = self._coupling()

    def program(self, *arguments: Argument) -> Program:
        """An empty kernel that reads these arguments."""
        known: dict[sp.Symbol, Number | ScalarRef] = dict(self.layout.scalars)
        for a in arguments:
            known |= {symbol: ScalarRef(symbol.name) for symbol in self.elements[a.name]}
        eq = self.equations
        return Program(self.layout.packing, known, eq.definitions, self.gradient.table_sums, eq.mode_sums)

    def at_rest(self, expr: sp.Expr) -> sp.Expr:
        """An expression in which all accelerations are zero."""
        gone = {row.a: sp.S.Zero for row in self.rigid_rows} | {amplitude(I, 2): sp.S.Zero}
        gone |= {s.symbol: sp.S.Zero for s in self.equations.mode_sums if s.term.has(amplitude(I, 2))}
        gone |= {c.symbol: sp.S.Zero for c in self.gradient.table_sums if c.sums and c.sums[0][0] == ALPHADDOT}
        return expr.xreplace(gone)

    def mass_entry(self, row: int, column: int) -> sp.Expr:
        """An entry of the rigid block of the mass matrix."""
        return sp.expand(derivative(self.left[self.rows[row]], self.rigid_rows[column].a))

    def _coupling(self) -> dict[int, sp.Expr]:
        """The rigid rows whose coupling with shape i does not vanish, and its entry of the mass matrix."""
        result = {r: self.gradient.of_scalar(self.left[name], ALPHADDOT) for r, name in enumerate(self.rows)}
        return {r: entry for r, entry in result.items() if entry != 0 and self.n}

    @property
    def c8(self) -> TableKind:
        """The kind of the mass matrix c8 of the shapes: full, diagonal or unit."""
        return self.equations.table(Family.C8).kind

    def mass_pattern(self) -> Pattern:
        """The lower triangle of the mass matrix."""
        groups = []
        for c in range(RIGID):
            rigid = tuple(RowSet(RowSetKind.ROW, r) for r in range(c, RIGID) if self.mass_entry(r, c) != 0)
            shapes = (RowSet(RowSetKind.RANGE, RIGID, self.n),) if c in self.coupling else ()
            groups.append(ColumnGroup(1, (*rigid, *shapes)))
        kind = (
            RowSet(RowSetKind.TRIANGLE, RIGID, self.n)
            if self.c8 is TableKind.FULL
            else RowSet(RowSetKind.DIAGONAL, RIGID)
        )
        groups += [ColumnGroup(self.n, (kind,))] if self.n else []
        return block_pattern(RIGID + self.n, tuple(groups), symmetric=True)

    # ---- what several kernels store ----

    def mass_wants(self) -> tuple[list[Scalar], list[IndexedStore]]:
        """The scalars and the loops over the shapes that store M, column by column."""
        scalars: list[Scalar] = []
        rows: list[IndexedStore] = []
        offset = 0
        for c in range(RIGID):
            for r in range(c, RIGID):
                if (entry := self.mass_entry(r, c)) != 0:
                    scalars.append((Store("M", offset, NOTHING), entry))
                    offset += 1
            if c in self.coupling:
                rows.append((StoreStrided("M", offset, 1, NOTHING), self.coupling[c]))
                offset += self.n
        if self.c8 is not TableKind.FULL:
            rows.append((StoreStrided("M", offset, 1, NOTHING), self._c8_diagonal()))
        return scalars, rows

    def _c8_diagonal(self) -> sp.Expr:
        return quantity(Family.C8, shapes=(I,)) if self.c8 is TableKind.DIAGONAL else sp.S.One

    def force_wants(self) -> tuple[list[Scalar], list[IndexedStore]]:
        """The scalars and the loop over the shapes that store h, row by row."""
        scalars: list[Scalar] = [
            (Store("h", r, NOTHING), self.at_rest(self.left[name])) for r, name in enumerate(self.rows)
        ]
        rows: list[IndexedStore] = [(StoreStrided("h", RIGID, 1, NOTHING), self.at_rest(self.left[SHAPE]))]
        return scalars, rows

    def shapes_of_mass(self) -> tuple[Section, ...]:
        """The section that copies a full c8 to M, where it has the same order; empty if c8 is not full."""
        if self.c8 is not TableKind.FULL or not self.n:
            return ()
        size = self.n * (self.n + 1) // 2
        return (store.copied("M", len(self.mass_pattern().rowidx) - size, self.layout.triangle, size),)


def row_labels(name: str, context: LoopContext) -> tuple[str, ...]:
    """The labels of the values of an output with one value for each row."""
    return (
        *(f"{name}[{row}]" for row in context.rows),
        *([f"{name}[alpha1 .. alpha{context.n}]"] if context.n else []),
    )
