"""Generic equations to kernels with loops over tables: the second way of lowering, beside the flat one.

The size of what comes out does not depend on the number of shapes. Tables are dense; what vanishes as a whole (c2 in
the mean frame), or is a unit or diagonal matrix, is known here and costs nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import casadi as ca
import sympy as sp

from derive.kernel import store
from derive.kernel.factor import elimination_order, factorise, solve
from derive.kernel.functions import NOT_FINITE, PIVOT, VANISHING
from derive.kernel.ir import (
    Argument,
    Columns,
    Kernel,
    Let,
    Num,
    Output,
    Pairs,
    Pattern,
    Piece,
    Put,
    Ref,
    Require,
    Section,
    Store,
    StoreAt,
    Substitute,
    View,
    block_pattern,
    pattern,
)
from derive.kernel.model import Model, Zero
from derive.kernel.program import NOTHING, Program, Row, Scalar
from derive.kernel.symbols import Symbols
from derive.mechanics.body import TRANSLATIONS
from derive.mechanics.generic import GenericEquations, GenericPoint, Total
from derive.mechanics.gradient import Gradient
from derive.mechanics.spatial import AXES

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
        self.quaternion = tuple(str(c.q) for c in eq.coordinates[3:7])
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

    def _shapes_of_mass(self) -> tuple[Section, ...]:
        """c8, which is full: copied, as it is stored in the same order."""
        if self.c8 != "full" or not self.n:
            return ()
        size = self.n * (self.n + 1) // 2
        return (store.copied("M", len(self.mass_pattern().rowidx) - size, self.memory.triangle, size),)


def _output(name: str, doc: str, labels: Iterable[str], size: int, pattern: Pattern | None = None) -> Output:
    return Output(name, tuple(labels), doc, pattern, size)


def lower_tables(equations: GenericEquations) -> Model:
    """The kernels of a model with loops over the shapes, with names, units, patterns and the reasons of its zeros."""
    tables = Tables(equations)
    kernels = (
        _mass(tables),
        _force(tables),
        _mass_force(tables),
        _accel(tables),
        _energy(tables),
        _momentum(tables),
        _rates(tables),
        *(_marker(tables, point) for point in equations.points),
        *(_load(tables, point) for point in equations.points),
        _residual(tables),
        _jacobian(tables),
    )
    return store.model(equations, tables.memory, kernels, _zeros(tables))


def _mass(tables: Tables) -> Kernel:
    program = tables.program(tables.q)
    program.phase("M", "(15)", "factors of the accelerations", *tables.mass_wants())
    doc = "Mass matrix M(q): values of the lower triangle by columns."
    outputs = (_mass_output(tables),)
    return program.kernel("mass", doc, (tables.q, tables.k), outputs, *tables._shapes_of_mass())


def _force(tables: Tables) -> Kernel:
    program = tables.program(tables.q, tables.v)
    program.phase("h", "(15)", "centrifugal, Coriolis, elastic and other forces", *tables.force_wants())
    doc = "Forces h of M vdot + h = 0: centrifugal, Coriolis, elastic, damping and gravity."
    arguments = (tables.t, tables.q, tables.v, tables.k)
    return program.kernel("force", doc, arguments, (_force_output(tables),))


def _mass_force(tables: Tables) -> Kernel:
    program = tables.program(tables.q, tables.v)
    of_mass, of_force = tables.mass_wants(), tables.force_wants()
    scalars, rows = [*of_mass[0], *of_force[0]], [*of_mass[1], *of_force[1]]
    program.phase("M and h", "(15)", "factors of the accelerations, and forces", scalars, rows)
    doc = "Mass matrix and forces together; what they share is computed once."
    outputs = (_mass_output(tables), _force_output(tables))
    arguments = (tables.t, tables.q, tables.v, tables.k)
    return program.kernel("mass_force", doc, arguments, outputs, *tables._shapes_of_mass())


def _mass_output(tables: Tables) -> Output:
    shape = tables.mass_pattern()
    text = "values of the mass matrix, lower triangle by columns"
    return _output("M", text, ("see its pattern",), len(shape.rowidx), shape)


def _force_output(tables: Tables) -> Output:
    return _output("h", "forces, one row a coordinate", _row_labels("h", tables), RIGID + tables.n)


def _row_labels(name: str, tables: Tables) -> tuple[str, ...]:
    return (*(f"{name}[{row}]" for row in tables.rows), *([f"{name}[alpha1 .. alpha{tables.n}]"] if tables.n else []))


def _accel(tables: Tables) -> Kernel:
    """M vdot = -h by the Schur complement of the shapes, whose mass matrix c8 is constant: factorised in setup."""
    program = tables.program(tables.q, tables.v)
    coupled = tuple(tables.coupling)
    b = {r: sp.Symbol(f"B_i_{r + 1}") for r in coupled}
    h = sp.Symbol("h_i")
    scalars: list[Scalar] = [(Let(f"h_{name}", NOTHING), tables.at_rest(tables.left[name])) for name in tables.rows]
    places = [(r, c) for c in range(RIGID) for r in range(c, RIGID) if tables.mass_entry(r, c) != 0]
    scalars += [(Let(f"M_{r + 1}{c + 1}", NOTHING), tables.mass_entry(r, c)) for r, c in places]
    rows: list[Row] = [(Put("h", NOTHING), tables.at_rest(tables.left[SHAPE]))] if tables.n else []
    rows += [(Put(f"B_{r + 1}", NOTHING), tables.coupling[r]) for r in coupled]
    program.phase("h and B", "(15)", "forces, and coupling of rigid motion and shapes", scalars, rows)
    arrays = ("h", *(f"B_{r + 1}" for r in coupled))
    weight = sp.S.One
    if tables.c8 == "full" and tables.n:
        program.sections.append(_substituted(tables, arrays, transposed=False))
    elif tables.c8 == "diagonal":
        weight = 1 / sp.Symbol("c8_i")
    totals = [
        Total(f"BB_{r + 1}{c + 1}", sp.S.Zero, weight * b[r] * b[c], "B^T c8^-1 B")
        for c in coupled
        for r in coupled
        if r >= c
    ]
    totals += [Total(f"Bh_{r + 1}", sp.S.Zero, weight * b[r] * h, "B^T c8^-1 h") for r in coupled]
    program.reduce(totals if tables.n else [])
    _rigid_accelerations(tables, program, places, coupled)
    rest = h + sum((b[r] * sp.Symbol(str(tables.equations.rows[r].a)) for r in coupled), sp.S.Zero)
    if tables.n:
        x = sp.Symbol("x_i")
        program.phase("alphaddot", "(15)", "accelerations of the shapes", (), [(Put("x", NOTHING), -weight * rest)])
        if tables.c8 == "full":
            program.sections.append(_substituted(tables, ("x",), transposed=True))
        program.phase("vdot", "", "accelerations of the shapes", (), [(StoreAt("vdot", RIGID, 1, NOTHING), x)])
        program.reduce([Total("shapes", sp.S.Zero, x, "what shows that all are finite")])
    every = sp.Add(*(row.a for row in tables.equations.rows), *([sp.Symbol("shapes")] if tables.n else []))
    finite = Require("finite", NOTHING, NOT_FINITE, "an acceleration is not finite")
    program.scalars("check", "", "refuse what is not finite", [(finite, every)])
    names = tuple(str(row.a) for row in tables.equations.rows)
    labels = (*names, *([f"alpha1ddot .. alpha{tables.n}ddot"] if tables.n else []))
    return program.kernel(
        "accel",
        "Accelerations vdot of M vdot + h = 0, by the Schur complement of the shapes and a sparse LDL^T of the rest.",
        (tables.t, tables.q, tables.v, tables.k),
        (_output("vdot", "accelerations", labels, RIGID + tables.n),),
    )


def _substituted(tables: Tables, arrays: tuple[str, ...], transposed: bool) -> Section:
    doc = "back substitution with the Cholesky factor of c8" if transposed else "forward substitution with it"
    return Section("c8", "appendix", doc, (Substitute("root", tables.n, arrays, transposed),))


def _rigid_accelerations(
    tables: Tables, program: Program, places: list[tuple[int, int]], coupled: tuple[int, ...]
) -> None:
    """Solve the Schur complement for the six rigid accelerations."""
    schur = {(r, c) for r in coupled for c in coupled if r >= c}
    shape = pattern(RIGID, RIGID, schur | set(places), symmetric=True)

    def make(symbols: Symbols) -> list[tuple[Let | Store | Require, ca.SX]]:
        def known(name: str) -> ca.SX:
            return symbols.values[sp.Symbol(name)]

        whole = {(r, c): known(f"M_{r + 1}{c + 1}") for r, c in places}
        entries = dict(whole)
        for r, c in schur:
            inner = known(f"BB_{r + 1}{c + 1}")
            entries[r, c] = whole[r, c] - inner if (r, c) in whole else -inner
        right = [
            -known(f"h_{name}") + (known(f"Bh_{r + 1}") if r in coupled else 0) for r, name in enumerate(tables.rows)
        ]
        factors = factorise(shape, {entry: entries[entry] for entry in shape.entries})
        solution = solve(factors, right)
        margin = symbols.number(VANISHING)
        wants: list[tuple[Let | Store | Require, ca.SX]] = [
            (
                Require("positive", NOTHING, PIVOT, f"the pivot of {tables.rows[j]} vanished"),
                pivot - margin * whole[j, j],
            )
            for pivot, j in zip(factors.pivots, factors.order, strict=True)
        ]
        for r, x in enumerate(solution):
            wants.append((Let(str(tables.equations.rows[r].a), NOTHING), x))
            wants.append((Store("vdot", r, NOTHING), x))
        return wants

    order = ", ".join(tables.rows[j] for j in elimination_order(shape))
    program.straight("vdot", "LDL^T", f"accelerations of the rigid motion: eliminate {order}", make)


def _energy(tables: Tables) -> Kernel:
    eq = tables.equations
    program = tables.program(tables.q, tables.v)
    values = [eq.kinetic_energy, eq.strain_energy, *([eq.weight_energy] if eq.weight_energy is not None else [])]
    labels = ("kinetic", "strain", "gravity")[: len(values)]
    wants: list[Scalar] = [(Store("energy", k, NOTHING), value) for k, value in enumerate(values)]
    program.phase("energy", "(22)", "1/2 int rho xdot . xdot, the strain energy, and gravity", wants)
    doc = "Kinetic and strain energy" + (", and the potential of gravity." if len(values) > 2 else ".")
    output = Output("energy", labels, "energies [J]")
    return program.kernel("energy", doc, (tables.q, tables.v, tables.k), (output,))


def _momentum(tables: Tables) -> Kernel:
    eq = tables.equations
    program = tables.program(tables.q, tables.v)
    values = (*eq.linear_momentum, *eq.angular_momentum)
    wants: list[Scalar] = [(Store("momentum", k, NOTHING), value) for k, value in enumerate(values)]
    program.phase("momentum", "(1)", "int rho xdot and int rho x x xdot", wants)
    labels = tuple(f"{kind}_{k}" for kind in ("linear", "angular") for k in AXES)
    doc = "Linear momentum, and angular momentum about the inertial origin."
    output = Output("momentum", labels, "linear [N s] and angular [N m s]")
    return program.kernel("momentum", doc, (tables.q, tables.v, tables.k), (output,))


def _rates(tables: Tables) -> Kernel:
    program = tables.program(tables.q, tables.v)
    wants: list[Scalar] = [(Store("qdot", k, NOTHING), rate) for k, rate in enumerate(tables.equations.rates)]
    rows: list[Row] = [(StoreAt("qdot", RIGID + 1, 1, NOTHING), sp.Symbol(f"{ALPHADOT}_i"))]
    program.phase("rates", "(1)", "from Qdot = Q (omega x)", wants, rows)
    labels = (*(f"{name}_t" for name in tables.q.elements), *([f"alpha1_t .. alpha{tables.n}_t"] if tables.n else []))
    output = _output("qdot", "time derivative of q", labels, RIGID + 1 + tables.n)
    doc = "Time derivative of the coordinates from the rates."
    return program.kernel("rates", doc, (tables.q, tables.v, tables.k), (output,))


def _marker(tables: Tables, point: GenericPoint) -> Kernel:
    """Position, velocity and Jacobian of a material point, full columns of three."""
    program = tables.program(tables.q, tables.v)
    program.totals |= {sp.Symbol(t.name): t for t in point.totals}
    scalars: list[Scalar] = [(Store("x", k, NOTHING), e) for k, e in enumerate(point.position)]
    scalars += [(Store("xdot", k, NOTHING), e) for k, e in enumerate(point.velocity)]
    groups, place = [], 0
    for column in point.columns:
        kept = [(r, e) for r, e in enumerate(column) if e != 0]
        scalars += [(Store("jacobian", place + k, NOTHING), e) for k, (_, e) in enumerate(kept)]
        place += len(kept)
        groups.append(Columns(1, tuple(Piece("row", r) for r, _ in kept)))
    rows: list[Row] = [(StoreAt("jacobian", place + r, 3, NOTHING), e) for r, e in enumerate(point.shape)]
    groups += [Columns(tables.n, (Piece("range", 0, 3),))] if tables.n else []
    program.phase("marker", "(1)", "x = c + Q r, its rate and its derivatives", scalars, rows)
    shape = block_pattern(3, tuple(groups))
    return program.kernel(
        f"marker_{point.name}",
        f"Marker {point.name}, {point.doc}: position, velocity and its Jacobian d(velocity)/dv.",
        (tables.q, tables.v, tables.k),
        (
            Output("x", ("x1", "x2", "x3"), "position in the inertial base [m]"),
            Output("xdot", ("x1dot", "x2dot", "x3dot"), "velocity in the inertial base [m/s]"),
            _output("jacobian", "values of d(velocity)/dv by columns", ("see its pattern",), len(shape.rowidx), shape),
        ),
    )


def _load(tables: Tables, point: GenericPoint) -> Kernel:
    force = Argument("F", tuple(f"F_{k}" for k in AXES), "force at the marker, in the inertial base [N]")
    program = tables.program(tables.q, force)
    program.totals |= {sp.Symbol(t.name): t for t in point.totals}
    program.definitions += point.force
    wants: list[Scalar] = [(Store("f", r, NOTHING), e) for r, e in enumerate(point.load)]
    rows: list[Row] = [(StoreAt("f", RIGID, 1, NOTHING), point.shape_load)]
    program.phase("f", "(10)", "virtual work of the force", wants, rows)
    return program.kernel(
        f"load_{point.name}",
        f"Generalized forces f of a force at marker {point.name}: then M vdot + h = f.",
        (tables.q, force, tables.k),
        (_output("f", "generalized forces, one row a coordinate", _row_labels("f", tables), RIGID + tables.n),),
    )


def _residual(tables: Tables) -> Kernel:
    eq, n = tables.equations, tables.n
    program = tables.program(tables.y, tables.ydot)
    first = RIGID + 1 + n
    scalars: list[Scalar] = [
        (Store("F", k, NOTHING), sp.Symbol(f"{name}_t") - rate)
        for k, (name, rate) in enumerate(zip(tables.q.elements, eq.rates, strict=True))
    ]
    scalars += [(Store("F", first + r, NOTHING), tables.left[name]) for r, name in enumerate(tables.rows)]
    rows: list[Row] = [
        (StoreAt("F", RIGID + 1, 1, NOTHING), sp.Symbol("alpha_t_i") - sp.Symbol(f"{ALPHADOT}_i")),
        (StoreAt("F", first + RIGID, 1, NOTHING), tables.left[SHAPE]),
    ]
    program.phase("F", "(15)", "qdot less its value from v, then M vdot + h", scalars, rows)
    labels = (*(f"{name}_t - ..." for name in tables.q.elements), "...", *_row_labels("M vdot + h", tables))
    output = _output("F", "residual", labels, first + RIGID + n)
    doc = "Residual F(t, y, ydot) of the first-order form: [qdot - rates; M vdot + h]."
    return program.kernel("residual", doc, (tables.t, tables.y, tables.ydot, tables.k), (output,))


def _jacobian(tables: Tables) -> Kernel:
    """dF/dy + cj dF/dydot in closed form: derivatives of sums are sums again."""
    columns = _Columns(tables)
    for k, name in enumerate(tables.q.elements):
        columns.coordinate(k, name)
    columns.shapes(ALPHA, None, sp.Symbol("cj"))
    for r, row in enumerate(tables.equations.rows):
        columns.rate(r, str(row.v), row.a)
    columns.shapes(ALPHADOT, ALPHADDOT, -sp.S.One)
    program = tables.program(tables.y, tables.ydot, tables.cj)
    doc = "derivatives of the residual"
    program.phase("jacobian", "(15)", doc, columns.scalars, columns.rows, columns.pairs)
    size = 2 * tables.n + 2 * RIGID + 1
    shape = block_pattern(size, tuple(columns.groups))
    return program.kernel(
        "jacobian",
        "Iteration matrix dF/dy + cj dF/dydot of the first-order form, values by columns, diagonal included.",
        (tables.t, tables.y, tables.ydot, tables.cj, tables.k),
        (_output("jac", "values of the iteration matrix by columns", ("see its pattern",), len(shape.rowidx), shape),),
    )


class _Columns:
    """The columns of the iteration matrix, one after the other."""

    def __init__(self, tables: Tables) -> None:
        self.tables = tables
        self.scalars: list[Scalar] = []
        self.rows: list[Row] = []
        self.pairs: list[tuple[Pairs, sp.Expr, sp.Expr]] = []
        self.groups: list[Columns] = []
        self.place = 0
        self.first = RIGID + 1 + tables.n

    def coordinate(self, k: int, name: str) -> None:
        """The column of c1 .. c3, e0 .. e3."""
        symbol, cj = sp.Symbol(name), sp.Symbol("cj")
        kinematic = [
            (r, -rate.diff(symbol) + (cj if r == k else 0)) for r, rate in enumerate(self.tables.equations.rates)
        ]
        self._single(kinematic, lambda e: self._total(e, symbol))

    def rate(self, r: int, name: str, acceleration: sp.Symbol) -> None:
        """The column of a rigid rate."""
        symbol, cj = sp.Symbol(name), sp.Symbol("cj")
        kinematic = [(k, -rate.diff(symbol)) for k, rate in enumerate(self.tables.equations.rates)]
        self._single(kinematic, lambda e: self._total(e, symbol) + cj * e.diff(acceleration))

    def _total(self, expr: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
        """A derivative, through the definitions as well."""
        found = expr.diff(symbol)
        for d in self.tables.equations.definitions:
            if not d.zero and expr.has(d.symbol):
                found += expr.diff(d.symbol) * self._total(d.expr, symbol)
        return sp.expand(found)

    def _single(self, kinematic: list[tuple[int, sp.Expr]], derivative: Callable[[sp.Expr], sp.Expr]) -> None:
        left = self.tables.left
        dynamic = [(self.first + r, derivative(left[name])) for r, name in enumerate(self.tables.rows)]
        entries = [(row, e) for row, e in (*kinematic, *dynamic) if e != 0]
        self.scalars += [(Store("jac", self.place + k, NOTHING), e) for k, (_, e) in enumerate(entries)]
        self.place += len(entries)
        pieces = [Piece("row", row) for row, _ in entries]
        shape = derivative(left[SHAPE]) if self.tables.n else sp.S.Zero
        if shape != 0:
            self.rows.append((StoreAt("jac", self.place, 1, NOTHING), shape))
            self.place += self.tables.n
            pieces.append(Piece("range", self.first + RIGID, self.tables.n))
        self.groups.append(Columns(1, tuple(pieces)))

    def shapes(self, vector: str, acceleration: str | None, kinematic: sp.Expr) -> None:
        """The columns of alpha or alphadot."""
        tables, n, cj = self.tables, self.tables.n, sp.Symbol("cj")
        if not n:
            return
        gradient = tables.gradient

        def of(expr: sp.Expr) -> sp.Expr:
            accelerated = cj * gradient.of_scalar(expr, acceleration) if acceleration else 0
            return sp.expand(gradient.of_scalar(expr, vector) + accelerated)

        rigid = [(self.first + r, of(tables.left[name])) for r, name in enumerate(tables.rows)]
        entries = [(row, e) for row, e in rigid if e != 0]
        full, diagonal = gradient.of_row(tables.left[SHAPE], vector)
        if acceleration:
            more, below = gradient.of_row(tables.left[SHAPE], acceleration)
            full, diagonal = sp.expand(full + cj * more), sp.expand(diagonal + cj * below)
        block = Piece("range", self.first + RIGID, n) if full != 0 else Piece("diagonal", self.first + RIGID)
        stride = 1 + len(entries) + (n if full != 0 else 1)
        self.rows.append((StoreAt("jac", self.place, stride, NOTHING), kinematic))
        for k, (_, e) in enumerate(entries, 1):
            self.rows.append((StoreAt("jac", self.place + k, stride, NOTHING), e))
        offset = self.place + 1 + len(entries)
        if full != 0:
            self.pairs.append((Pairs(tables.memory.packing, "jac", offset, stride, NOTHING, None), full, diagonal))
        else:
            self.rows.append((StoreAt("jac", offset, stride, NOTHING), diagonal))
        pieces = (Piece("diagonal", RIGID + 1), *(Piece("row", r) for r, _ in entries))
        self.groups.append(Columns(n, (*pieces, block)))
        self.place += n * stride


def _zeros(tables: Tables) -> tuple[Zero, ...]:
    """The blocks of the mass matrix that vanish, with the reasons."""
    eq = tables.equations
    found = [Zero("M[c, c] off the diagonal", TRANSLATIONS)]
    if all(tables.mass_entry(r, c) == 0 for r in (3, 4, 5) for c in (0, 1, 2)):
        found.append(Zero("M[pi, c]", "; ".join(f"{t.name} = 0 by {t.zero}" for t in map(eq.table, ("c1", "c2")))))
    if tables.n and not any(r in tables.coupling for r in (0, 1, 2)):
        found.append(Zero("M[alpha, c]", f"c2 = 0 by {eq.table('c2').zero}"))
    if tables.n and not any(r in tables.coupling for r in (3, 4, 5)):
        found.append(Zero("M[alpha, pi]", "; ".join(f"{t.name} = 0 by {t.zero}" for t in map(eq.table, ("c6", "c7")))))
    if tables.n > 1 and tables.c8 != "full":
        found.append(Zero("M[alpha, alpha] off the diagonal", eq.table("c8").zero))
    return tuple(found)
