"""Generic equations to kernels with loops over tables: the second way of lowering, beside the flat one.

The size of what comes out does not depend on the number of shapes. Tables are dense; what vanishes as a whole (c2 in
the mean frame), or is a unit or diagonal matrix, is known here and costs nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from derive.ir.expressions import ScalarRef
from derive.ir.model import Argument, Kernel, Model, Zero
from derive.ir.patterns import ColumnGroup, RowSet, RowSetKind, block_pattern
from derive.ir.statements import Store, StoreStrided
from derive.lowering.functions import FunctionKind, ModelFunction, functions_of
from derive.lowering.loops import data_layout as store
from derive.lowering.loops.accelerations import accel
from derive.lowering.loops.iteration_matrix import jacobian
from derive.lowering.loops.program import NOTHING, Elements, IndexedStore, Scalar
from derive.lowering.loops.tables import RIGID, SHAPE, Tables, row_labels
from derive.mechanics.equations import Equations
from derive.mechanics.expansion import TRANSLATIONS
from derive.mechanics.symbols import Family, I, amplitude, state_rate
from derive.mechanics.tables import AXES, TableKind


def lower_tables(equations: Equations, choice: str = "") -> Model:
    """The kernels of a model with loops over the shapes, with names, units, patterns and the reasons of its zeros."""
    tables = Tables(equations)
    kernels = tuple(IMPLEMENTATIONS[function.kind](tables, function) for function in functions_of(equations))
    return store.model(equations, tables.layout, kernels, _zeros(tables), choice)


def _mass(tables: Tables, function: ModelFunction) -> Kernel:
    program = tables.program(tables.q)
    program.phase("M", "(15)", "factors of the accelerations", *tables.mass_wants())
    return program.kernel(function, tables.inputs, {"M": _mass_elements(tables)}, *tables.shapes_of_mass())


def _force(tables: Tables, function: ModelFunction) -> Kernel:
    program = tables.program(tables.q, tables.v)
    program.phase("h", "(15)", "centrifugal, Coriolis, elastic and other forces", *tables.force_wants())
    return program.kernel(function, tables.inputs, {"h": _force_elements(tables)})


def _mass_force(tables: Tables, function: ModelFunction) -> Kernel:
    program = tables.program(tables.q, tables.v)
    of_mass, of_force = tables.mass_wants(), tables.force_wants()
    scalars, rows = [*of_mass[0], *of_force[0]], [*of_mass[1], *of_force[1]]
    program.phase("M and h", "(15)", "factors of the accelerations, and forces", scalars, rows)
    outputs = {"M": _mass_elements(tables), "h": _force_elements(tables)}
    return program.kernel(function, tables.inputs, outputs, *tables.shapes_of_mass())


def _mass_elements(tables: Tables) -> Elements:
    shape = tables.mass_pattern()
    return Elements(("see its pattern",), len(shape.rowidx), shape)


def _force_elements(tables: Tables) -> Elements:
    return Elements(row_labels("h", tables), RIGID + tables.n)


def _energy(tables: Tables, function: ModelFunction) -> Kernel:
    eq = tables.equations
    program = tables.program(tables.q, tables.v)
    values = [eq.kinetic_energy, eq.strain_energy, *([eq.weight_energy] if eq.weight_energy is not None else [])]
    labels = ("kinetic", "strain", "gravity")[: len(values)]
    wants: list[Scalar] = [(Store("energy", k, NOTHING), value) for k, value in enumerate(values)]
    program.phase("energy", "(22)", "1/2 int rho xdot . xdot, the strain energy, and gravity", wants)
    return program.kernel(function, tables.inputs, {"energy": Elements(labels)})


def _momentum(tables: Tables, function: ModelFunction) -> Kernel:
    eq = tables.equations
    program = tables.program(tables.q, tables.v)
    values = (*eq.linear_momentum, *eq.angular_momentum)
    wants: list[Scalar] = [(Store("momentum", k, NOTHING), value) for k, value in enumerate(values)]
    program.phase("momentum", "(1)", "int rho xdot and int rho x x xdot", wants)
    labels = tuple(f"{kind}_{k}" for kind in ("linear", "angular") for k in AXES)
    return program.kernel(function, tables.inputs, {"momentum": Elements(labels)})


def _rates(tables: Tables, function: ModelFunction) -> Kernel:
    program = tables.program(tables.q, tables.v)
    wants: list[Scalar] = [(Store("qdot", k, NOTHING), rate) for k, rate in enumerate(tables.rigid_rates)]
    rows: list[IndexedStore] = [(StoreStrided("qdot", RIGID + 1, 1, NOTHING), amplitude(I, 1))]
    program.phase("rates", "(1)", "from Qdot = Q (omega x)", wants, rows)
    labels = (*(f"{name}_t" for name in tables.q.elements), *([f"alpha1_t .. alpha{tables.n}_t"] if tables.n else []))
    return program.kernel(function, tables.inputs, {"qdot": Elements(labels, RIGID + 1 + tables.n)})


def _marker(tables: Tables, function: ModelFunction) -> Kernel:
    """Position, velocity and Jacobian of a material point, full columns of three."""
    point = tables.equations.marker(function.variant)
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
    rows: list[IndexedStore] = [
        (StoreStrided("jacobian", place + r, 3, NOTHING), e) for r, e in enumerate(point.jacobian[:, RIGID])
    ]
    groups += [ColumnGroup(tables.n, (RowSet(RowSetKind.RANGE, 0, 3),))] if tables.n else []
    program.phase("marker", "(1)", "x = c + Q r, its time derivative and its Jacobian", scalars, rows)
    shape = block_pattern(3, tuple(groups))
    outputs = {
        "x": Elements(("x1", "x2", "x3")),
        "xdot": Elements(("x1dot", "x2dot", "x3dot")),
        "jacobian": Elements(("see its pattern",), len(shape.rowidx), shape),
    }
    return program.kernel(function, tables.inputs, outputs)


def _load(tables: Tables, function: ModelFunction) -> Kernel:
    point = tables.equations.marker(function.variant)
    components = tuple(point.force)
    force = Argument("F", tuple(s.name for s in components), "force at the marker, in the inertial frame [N]")
    program = tables.program(tables.q)
    program.known |= {symbol: ScalarRef(symbol.name) for symbol in components}
    program.totals |= {t.symbol: t for t in point.totals}
    program.definitions += point.force_definitions
    wants: list[Scalar] = [(Store("f", r, NOTHING), e) for r, e in enumerate(point.load[:RIGID])]
    rows: list[IndexedStore] = [(StoreStrided("f", RIGID, 1, NOTHING), point.load[RIGID])]
    program.phase("f", "(10)", "virtual work of the force", wants, rows)
    outputs = {"f": Elements(row_labels("f", tables), RIGID + tables.n)}
    return program.kernel(function, {**tables.inputs, "F": force}, outputs)


def _residual(tables: Tables, function: ModelFunction) -> Kernel:
    n = tables.n
    program = tables.program(tables.y, tables.ydot)
    first = RIGID + 1 + n
    scalars: list[Scalar] = [
        (Store("F", k, NOTHING), state_rate(q) - rate)
        for k, (q, rate) in enumerate(zip(tables.elements["q"], tables.rigid_rates, strict=True))
    ]
    scalars += [(Store("F", first + r, NOTHING), tables.left[name]) for r, name in enumerate(tables.rows)]
    rows: list[IndexedStore] = [
        (StoreStrided("F", RIGID + 1, 1, NOTHING), state_rate(amplitude(I)) - amplitude(I, 1)),
        (StoreStrided("F", first + RIGID, 1, NOTHING), tables.left[SHAPE]),
    ]
    program.phase("F", "(15)", "qdot less its value from v, then M vdot + h", scalars, rows)
    labels = (*(f"{name}_t - ..." for name in tables.q.elements), "...", *row_labels("M vdot + h", tables))
    return program.kernel(function, tables.inputs, {"F": Elements(labels, first + RIGID + n)})


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


IMPLEMENTATIONS: Mapping[FunctionKind, Callable[[Tables, ModelFunction], Kernel]] = {
    FunctionKind.MASS: _mass,
    FunctionKind.FORCE: _force,
    FunctionKind.MASS_FORCE: _mass_force,
    FunctionKind.ACCEL: accel,
    FunctionKind.ENERGY: _energy,
    FunctionKind.MOMENTUM: _momentum,
    FunctionKind.RATES: _rates,
    FunctionKind.MARKER: _marker,
    FunctionKind.LOAD: _load,
    FunctionKind.RESIDUAL: _residual,
    FunctionKind.JACOBIAN: jacobian,
}
