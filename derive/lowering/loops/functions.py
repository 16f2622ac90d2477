"""Generic equations to kernels with loops over tables: the second way of lowering, beside the flat one.

The size of what comes out does not depend on the number of shapes. Tables are dense; what vanishes as a whole (c2 in
the mean frame), or is a unit or diagonal matrix, is known here and costs nothing.
"""

from __future__ import annotations

from derive.ir.expressions import ScalarRef
from derive.ir.model import Argument, Kernel, Model, Output, Zero
from derive.ir.patterns import ColumnGroup, RowSet, RowSetKind, block_pattern
from derive.ir.statements import Store, StoreStrided
from derive.lowering.loops import data_layout as store
from derive.lowering.loops.accelerations import accel
from derive.lowering.loops.iteration_matrix import jacobian
from derive.lowering.loops.program import NOTHING, Row, Scalar
from derive.lowering.loops.tables import RIGID, SHAPE, Tables, output, row_labels
from derive.mechanics.equations import Equations
from derive.mechanics.expansion import TRANSLATIONS
from derive.mechanics.symbols import Family, I, amplitude, state_rate
from derive.mechanics.tables import AXES, TableKind
from derive.mechanics.terms import MarkerEquations


def lower_tables(equations: Equations, choice: str = "") -> Model:
    """The kernels of a model with loops over the shapes, with names, units, patterns and the reasons of its zeros."""
    tables = Tables(equations)
    kernels = (
        _mass(tables),
        _force(tables),
        _mass_force(tables),
        accel(tables),
        _energy(tables),
        _momentum(tables),
        _rates(tables),
        *(_marker(tables, point) for point in equations.markers),
        *(_load(tables, point) for point in equations.markers),
        _residual(tables),
        jacobian(tables),
    )
    return store.model(equations, tables.memory, kernels, _zeros(tables), choice)


def _mass(tables: Tables) -> Kernel:
    program = tables.program(tables.q)
    program.phase("M", "(15)", "factors of the accelerations", *tables.mass_wants())
    doc = "Mass matrix M(q): values of the lower triangle by columns."
    outputs = (_mass_output(tables),)
    return program.kernel("mass", doc, (tables.q, tables.k), outputs, *tables.shapes_of_mass())


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
    return program.kernel("mass_force", doc, arguments, outputs, *tables.shapes_of_mass())


def _mass_output(tables: Tables) -> Output:
    shape = tables.mass_pattern()
    text = "values of the mass matrix, lower triangle by columns"
    return output("M", text, ("see its pattern",), len(shape.rowidx), shape)


def _force_output(tables: Tables) -> Output:
    return output("h", "forces, one for each equation of motion", row_labels("h", tables), RIGID + tables.n)


def _energy(tables: Tables) -> Kernel:
    eq = tables.equations
    program = tables.program(tables.q, tables.v)
    values = [eq.kinetic_energy, eq.strain_energy, *([eq.weight_energy] if eq.weight_energy is not None else [])]
    labels = ("kinetic", "strain", "gravity")[: len(values)]
    wants: list[Scalar] = [(Store("energy", k, NOTHING), value) for k, value in enumerate(values)]
    program.phase("energy", "(22)", "1/2 int rho xdot . xdot, the strain energy, and gravity", wants)
    doc = "Kinetic and strain energy" + (", and the potential of gravity." if len(values) > 2 else ".")
    given = Output("energy", labels, "energies [J]")
    return program.kernel("energy", doc, (tables.q, tables.v, tables.k), (given,))


def _momentum(tables: Tables) -> Kernel:
    eq = tables.equations
    program = tables.program(tables.q, tables.v)
    values = (*eq.linear_momentum, *eq.angular_momentum)
    wants: list[Scalar] = [(Store("momentum", k, NOTHING), value) for k, value in enumerate(values)]
    program.phase("momentum", "(1)", "int rho xdot and int rho x x xdot", wants)
    labels = tuple(f"{kind}_{k}" for kind in ("linear", "angular") for k in AXES)
    doc = "Linear momentum, and angular momentum about the inertial origin."
    given = Output("momentum", labels, "linear [N s] and angular [N m s]")
    return program.kernel("momentum", doc, (tables.q, tables.v, tables.k), (given,))


def _rates(tables: Tables) -> Kernel:
    program = tables.program(tables.q, tables.v)
    wants: list[Scalar] = [(Store("qdot", k, NOTHING), rate) for k, rate in enumerate(tables.rigid_rates)]
    rows: list[Row] = [(StoreStrided("qdot", RIGID + 1, 1, NOTHING), amplitude(I, 1))]
    program.phase("rates", "(1)", "from Qdot = Q (omega x)", wants, rows)
    labels = (*(f"{name}_t" for name in tables.q.elements), *([f"alpha1_t .. alpha{tables.n}_t"] if tables.n else []))
    values = output("qdot", "time derivative of q", labels, RIGID + 1 + tables.n)
    doc = "Time derivatives of the generalised coordinates from the generalised velocities."
    return program.kernel("rates", doc, (tables.q, tables.v, tables.k), (values,))


def _marker(tables: Tables, point: MarkerEquations) -> Kernel:
    """Position, velocity and Jacobian of a material point, full columns of three."""
    program = tables.program(tables.q, tables.v)
    program.totals |= {t.symbol: t for t in point.totals}
    scalars: list[Scalar] = [(Store("x", k, NOTHING), e) for k, e in enumerate(point.position)]
    scalars += [(Store("xdot", k, NOTHING), e) for k, e in enumerate(point.velocity)]
    groups, place = [], 0
    for column in range(RIGID):
        kept = [(r, e) for r, e in enumerate(point.jacobian[:, column]) if e != 0]
        scalars += [(Store("jacobian", place + k, NOTHING), e) for k, (_, e) in enumerate(kept)]
        place += len(kept)
        groups.append(ColumnGroup(1, tuple(RowSet(RowSetKind.ROW, r) for r, _ in kept)))
    rows: list[Row] = [
        (StoreStrided("jacobian", place + r, 3, NOTHING), e) for r, e in enumerate(point.jacobian[:, RIGID])
    ]
    groups += [ColumnGroup(tables.n, (RowSet(RowSetKind.RANGE, 0, 3),))] if tables.n else []
    program.phase("marker", "(1)", "x = c + Q r, its time derivative and its Jacobian", scalars, rows)
    shape = block_pattern(3, tuple(groups))
    return program.kernel(
        f"marker_{point.name}",
        f"Marker {point.name}, {point.doc}: position, velocity and its Jacobian d(velocity)/dv.",
        (tables.q, tables.v, tables.k),
        (
            Output("x", ("x1", "x2", "x3"), "position in the inertial frame [m]"),
            Output("xdot", ("x1dot", "x2dot", "x3dot"), "velocity in the inertial frame [m/s]"),
            output("jacobian", "values of d(velocity)/dv by columns", ("see its pattern",), len(shape.rowidx), shape),
        ),
    )


def _load(tables: Tables, point: MarkerEquations) -> Kernel:
    force = Argument("F", tuple(f"F_{k}" for k in AXES), "force at the marker, in the inertial frame [N]")
    components = tuple(point.force)
    program = tables.program(tables.q)
    program.known |= {symbol: ScalarRef(symbol.name) for symbol in components}
    program.totals |= {t.symbol: t for t in point.totals}
    program.definitions += point.force_definitions
    wants: list[Scalar] = [(Store("f", r, NOTHING), e) for r, e in enumerate(point.load[:RIGID])]
    rows: list[Row] = [(StoreStrided("f", RIGID, 1, NOTHING), point.load[RIGID])]
    program.phase("f", "(10)", "virtual work of the force", wants, rows)
    return program.kernel(
        f"load_{point.name}",
        f"Generalised forces f of a force at marker {point.name}: then M vdot + h = f.",
        (tables.q, force, tables.k),
        (
            output(
                "f", "generalised forces, one for each equation of motion", row_labels("f", tables), RIGID + tables.n
            ),
        ),
    )


def _residual(tables: Tables) -> Kernel:
    n = tables.n
    program = tables.program(tables.y, tables.ydot)
    first = RIGID + 1 + n
    scalars: list[Scalar] = [
        (Store("F", k, NOTHING), state_rate(q) - rate)
        for k, (q, rate) in enumerate(zip(tables.elements["q"], tables.rigid_rates, strict=True))
    ]
    scalars += [(Store("F", first + r, NOTHING), tables.left[name]) for r, name in enumerate(tables.rows)]
    rows: list[Row] = [
        (StoreStrided("F", RIGID + 1, 1, NOTHING), state_rate(amplitude(I)) - amplitude(I, 1)),
        (StoreStrided("F", first + RIGID, 1, NOTHING), tables.left[SHAPE]),
    ]
    program.phase("F", "(15)", "qdot less its value from v, then M vdot + h", scalars, rows)
    labels = (*(f"{name}_t - ..." for name in tables.q.elements), "...", *row_labels("M vdot + h", tables))
    values = output("F", "residual", labels, first + RIGID + n)
    doc = "First-order form F(t, y, ydot) = [qdot - v; M vdot + h] = 0 with y = [q; v]."
    return program.kernel("residual", doc, (tables.t, tables.y, tables.ydot, tables.k), (values,))


def _zeros(tables: Tables) -> tuple[Zero, ...]:
    """The blocks of the mass matrix that vanish, with the reasons."""
    eq = tables.equations
    found = [Zero("M[c, c] off the diagonal", TRANSLATIONS)]
    if all(tables.mass_entry(r, c) == 0 for r in (3, 4, 5) for c in (0, 1, 2)):
        found.append(Zero("M[pi, c]", _vanished(eq, Family.C1, Family.C2)))
    if tables.n and not any(r in tables.coupling for r in (0, 1, 2)):
        found.append(Zero("M[alpha, c]", _vanished(eq, Family.C2)))
    if tables.n and not any(r in tables.coupling for r in (3, 4, 5)):
        found.append(Zero("M[alpha, pi]", _vanished(eq, Family.C6, Family.C7)))
    if tables.n > 1 and tables.c8 is not TableKind.FULL:
        found.append(Zero("M[alpha, alpha] off the diagonal", eq.table(Family.C8).zero))
    return tuple(found)


def _vanished(eq: Equations, *families: Family) -> str:
    """Why tables vanish."""
    return str(eq.reason(*families))
