"""What the kernels of one table model share: arguments, memory, expressions, the pattern of the mass matrix."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from derive.ir.expressions import Num, Ref
from derive.ir.kernel import Argument, Output, Section, Store, View
from derive.ir.loops import StoreAt
from derive.ir.patterns import Columns, Pattern, Piece, block_pattern
from derive.lowering.loops import data_layout as store
from derive.lowering.loops.program import NOTHING, Program, Row, Scalar
from derive.mechanics.gradient import Gradient
from derive.mechanics.indexed_equations import GenericEquations

ALPHA, ALPHADOT, ALPHADDOT = "alpha", "alphadot", "alphaddot"
SHAPE = "alpha_i"
RIGID = 6
"""Rows before those of the shapes; coordinates are one more, a quaternion."""


class Tables:
    """One model in the course of its lowering to loops."""

    def __init__(self, equations: GenericEquations) -> None:
        self.equations = eq = equations
        self.n = eq.modes
        self.gradient = Gradient(eq)
        self.rows = tuple(row.name for row in eq.rows)
        positions = tuple(str(c.q) for c in eq.coordinates[:7])
        rates, accelerations = tuple(str(r.v) for r in eq.rows), tuple(str(r.a) for r in eq.rows)
        n, coordinates = self.n, len(positions)
        self.t = Argument("t", (), "time (a free body does not depend on it)", scalar=True)
        self.q = Argument("q", positions, "generalized coordinates", arrays=(View(ALPHA, coordinates, n),))
        self.v = Argument("v", rates, "rates", arrays=(View(ALPHADOT, RIGID, n),))
        behind = tuple(range(coordinates)) + tuple(range(coordinates + n, coordinates + n + RIGID))
        self.y = Argument(
            "y",
            positions + rates,
            "first-order state [q; v]",
            arrays=(View(ALPHA, coordinates, n), View(ALPHADOT, coordinates + n + RIGID, n)),
            positions=behind,
        )
        self.ydot = Argument(
            "ydot",
            tuple(f"{name}_t" for name in positions) + accelerations,
            "time derivative of y",
            arrays=(View("alpha_t", coordinates, n), View(ALPHADDOT, coordinates + n + RIGID, n)),
            positions=behind,
        )
        self.cj = Argument("cj", (), "factor of dF/dydot", scalar=True)
        self.memory = store.memory(eq)
        self.k = self.memory.argument
        self.left = {row: eq.sum_of(row) for row in (*self.rows, SHAPE)}
        self.coupling = self._coupling()

    def program(self, *arguments: Argument) -> Program:
        """An empty kernel that reads these arguments."""
        known: dict[sp.Symbol, Num | Ref] = dict(self.memory.scalars)
        for a in arguments:
            names = (a.name,) if a.scalar else a.elements
            known |= {sp.Symbol(name): Ref(name) for name in names}
        eq = self.equations
        return Program(self.memory.packing, known, eq.definitions, self.gradient.contractions, eq.totals)

    def at_rest(self, expr: sp.Expr) -> sp.Expr:
        """An expression without what the accelerations do."""
        gone = {row.a: sp.S.Zero for row in self.equations.rows} | {sp.Symbol(f"{ALPHADDOT}_i"): sp.S.Zero}
        gone |= {sp.Symbol(t.name): sp.S.Zero for t in self.equations.totals if t.term.has(sp.Symbol("alphaddot_i"))}
        gone |= {
            sp.Symbol(c.name): sp.S.Zero for c in self.gradient.contractions if c.sums and c.sums[0][0] == ALPHADDOT
        }
        return expr.xreplace(gone)

    def mass_entry(self, row: int, column: int) -> sp.Expr:
        """An entry of the rigid block of the mass matrix."""
        return sp.expand(self.left[self.rows[row]].diff(self.equations.rows[column].a))

    def _coupling(self) -> dict[int, sp.Expr]:
        """The rigid rows whose coupling with shape i does not vanish, and its entry of the mass matrix."""
        found = {r: self.gradient.of_scalar(self.left[name], ALPHADDOT) for r, name in enumerate(self.rows)}
        return {r: entry for r, entry in found.items() if entry != 0 and self.n}

    @property
    def c8(self) -> str:
        """What the mass matrix of the shapes is: full, diagonal or unit."""
        return self.equations.table("c8").kind

    def mass_pattern(self) -> Pattern:
        """The lower triangle of the mass matrix."""
        groups = []
        for c in range(RIGID):
            rigid = tuple(Piece("row", r) for r in range(c, RIGID) if self.mass_entry(r, c) != 0)
            shapes = (Piece("range", RIGID, self.n),) if c in self.coupling else ()
            groups.append(Columns(1, (*rigid, *shapes)))
        kind = Piece("triangle", RIGID, self.n) if self.c8 == "full" else Piece("diagonal", RIGID)
        groups += [Columns(self.n, (kind,))] if self.n else []
        return block_pattern(RIGID + self.n, tuple(groups), symmetric=True)

    # ---- what several kernels store ----

    def mass_wants(self) -> tuple[list[Scalar], list[Row]]:
        """M, column by column."""
        scalars: list[Scalar] = []
        rows: list[Row] = []
        place = 0
        for c in range(RIGID):
            for r in range(c, RIGID):
                if (entry := self.mass_entry(r, c)) != 0:
                    scalars.append((Store("M", place, NOTHING), entry))
                    place += 1
            if c in self.coupling:
                rows.append((StoreAt("M", place, 1, NOTHING), self.coupling[c]))
                place += self.n
        if self.c8 != "full":
            rows.append((StoreAt("M", place, 1, NOTHING), self._c8_diagonal()))
        return scalars, rows

    def _c8_diagonal(self) -> sp.Expr:
        return sp.Symbol("c8_i") if self.c8 == "diagonal" else sp.S.One

    def force_wants(self, output: str = "h") -> tuple[list[Scalar], list[Row]]:
        """h, row by row."""
        scalars: list[Scalar] = [
            (Store(output, r, NOTHING), self.at_rest(self.left[name])) for r, name in enumerate(self.rows)
        ]
        rows: list[Row] = [(StoreAt(output, RIGID, 1, NOTHING), self.at_rest(self.left[SHAPE]))]
        return scalars, rows

    def shapes_of_mass(self) -> tuple[Section, ...]:
        """c8, which is full: copied, as it is stored in the same order."""
        if self.c8 != "full" or not self.n:
            return ()
        size = self.n * (self.n + 1) // 2
        return (store.copied("M", len(self.mass_pattern().rowidx) - size, self.memory.triangle, size),)


def output(name: str, doc: str, labels: Iterable[str], size: int, pattern: Pattern | None = None) -> Output:
    """An output whose values are too many for names; `labels` describe groups of them."""
    return Output(name, tuple(labels), doc, pattern, size)


def row_labels(name: str, tables: Tables) -> tuple[str, ...]:
    """What the values of an output are that has one for each row."""
    return (*(f"{name}[{row}]" for row in tables.rows), *([f"{name}[alpha1 .. alpha{tables.n}]"] if tables.n else []))
