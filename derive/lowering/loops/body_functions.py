"""Lowering of indexed equations to kernels with loops over the assumed modes; the flat lowering unrolls them.

The size of the generated code does not depend on the number of modes. Tables are dense; a table that vanishes as a
whole (c2 in the mean frame), or is a unit or diagonal matrix, is known here and costs nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from derive.ir.expressions import ScalarRef
from derive.ir.kernel import Argument, Kernel
from derive.ir.model import Model, Zero
from derive.ir.patterns import ColumnGroup, RowSet, RowSetKind, block_pattern
from derive.ir.statements import Store, StoreStrided
from derive.lowering.attitude import with_attitude_check
from derive.lowering.loops import data_layout as store
from derive.lowering.loops.accelerations import accel
from derive.lowering.loops.assignments import NOTHING, IndexedStore, Scalar
from derive.lowering.loops.context import RIGID, SHAPE, LoopContext, row_labels
from derive.lowering.loops.iteration_matrix import jacobian
from derive.lowering.model_functions import FunctionKind, ModelFunction, OutputElements, functions_of
from derive.mechanics.axes import AXES
from derive.mechanics.expansion import TRANSLATIONS
from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.symbols import Family, I, amplitude, state_rate
from derive.mechanics.tables import TableKind


def lower_loops(equations: IndexedEquations, choice: str = "") -> Model:
    """The kernels of a model with loops over the shapes, with names, units, patterns and the reasons of its zeros."""
    context = LoopContext(equations)
    lowered = (IMPLEMENTATIONS[function.kind](context, function) for function in functions_of(equations))
    kernels = tuple(with_attitude_check(kernel, equations) for kernel in lowered)
    return store.model(equations, context.layout, kernels, _zeros(context), choice)


def _mass(context: LoopContext, function: ModelFunction) -> Kernel:
    program = context.program(context.q)
    program.phase("M", "(15)", "factors of the accelerations", *context.mass_wants())
    return program.kernel(function, context.inputs, {"M": _mass_elements(context)}, *context.shapes_of_mass())


def _force(context: LoopContext, function: ModelFunction) -> Kernel:
    program = context.program(context.q, context.v)
    program.phase("h", "(15)", "centrifugal, Coriolis, elastic and other forces", *context.force_wants())
    return program.kernel(function, context.inputs, {"h": _force_elements(context)})


def _mass_force(context: LoopContext, function: ModelFunction) -> Kernel:
    program = context.program(context.q, context.v)
    of_mass, of_force = context.mass_wants(), context.force_wants()
    scalars, rows = [*of_mass[0], *of_force[0]], [*of_mass[1], *of_force[1]]
    program.phase("M and h", "(15)", "factors of the accelerations, and forces", scalars, rows)
    outputs = {"M": _mass_elements(context), "h": _force_elements(context)}
    return program.kernel(function, context.inputs, outputs, *context.shapes_of_mass())


def _mass_elements(context: LoopContext) -> OutputElements:
    shape = context.mass_pattern()
    return OutputElements(("see its pattern",), shape, len(shape.rowidx))


def _force_elements(context: LoopContext) -> OutputElements:
    return OutputElements(row_labels("h", context), count=RIGID + context.n)


def _energy(context: LoopContext, function: ModelFunction) -> Kernel:
    eq = context.equations
    program = context.program(context.q, context.v)
    values = [eq.kinetic_energy, eq.strain_energy, *([eq.weight_energy] if eq.weight_energy is not None else [])]
    labels = ("kinetic", "strain", "gravity")[: len(values)]
    wants: list[Scalar] = [(Store("energy", k, NOTHING), value) for k, value in enumerate(values)]
    program.phase("energy", "(22)", "1/2 int rho xdot . xdot, the strain energy, and gravity", wants)
    return program.kernel(function, context.inputs, {"energy": OutputElements(labels)})


def _momentum(context: LoopContext, function: ModelFunction) -> Kernel:
    eq = context.equations
    program = context.program(context.q, context.v)
    values = (*eq.linear_momentum, *eq.angular_momentum)
    wants: list[Scalar] = [(Store("momentum", k, NOTHING), value) for k, value in enumerate(values)]
    program.phase("momentum", "(1)", "int rho xdot and int rho x x xdot", wants)
    labels = tuple(f"{kind}_{k}" for kind in ("linear", "angular") for k in AXES)
    return program.kernel(function, context.inputs, {"momentum": OutputElements(labels)})


def _rates(context: LoopContext, function: ModelFunction) -> Kernel:
    program = context.program(context.q, context.v)
    wants: list[Scalar] = [(Store("qdot", k, NOTHING), rate) for k, rate in enumerate(context.rigid_rates)]
    rows: list[IndexedStore] = [(StoreStrided("qdot", RIGID + 1, 1, NOTHING), amplitude(I, 1))]
    program.phase("rates", "(1)", "from Qdot = Q (omega x)", wants, rows)
    labels = (
        *(f"{name}_t" for name in context.q.elements),
        *([f"alpha1_t .. alpha{context.n}_t"] if context.n else []),
    )
    return program.kernel(function, context.inputs, {"qdot": OutputElements(labels, count=RIGID + 1 + context.n)})


def _marker(context: LoopContext, function: ModelFunction) -> Kernel:
    """Position, velocity and Jacobian of a material point, full columns of three."""
    point = context.equations.marker(function.variant)
    program = context.program(context.q, context.v)
    program.mode_sums |= {t.symbol: t for t in point.mode_sums}
    program.table_sums |= {t.symbol: t for t in point.table_sums}
    scalars: list[Scalar] = [(Store("x", k, NOTHING), e) for k, e in enumerate(point.position)]
    scalars += [(Store("xdot", k, NOTHING), e) for k, e in enumerate(point.velocity)]
    groups, offset = [], 0
    for column in range(RIGID):
        kept = [(r, e) for r, e in enumerate(point.jacobian[:, column]) if e != 0]
        scalars += [(Store("jacobian", offset + k, NOTHING), e) for k, (_, e) in enumerate(kept)]
        offset += len(kept)
        groups.append(ColumnGroup(1, tuple(RowSet(RowSetKind.ROW, r) for r, _ in kept)))
    rows: list[IndexedStore] = [
        (StoreStrided("jacobian", offset + r, 3, NOTHING), e) for r, e in enumerate(point.jacobian[:, RIGID])
    ]
    groups += [ColumnGroup(context.n, (RowSet(RowSetKind.RANGE, 0, 3),))] if context.n else []
    program.phase("marker", "(1)", "x = c + Q r, its time derivative and its Jacobian", scalars, rows)
    shape = block_pattern(3, tuple(groups))
    outputs = {
        "x": OutputElements(("x1", "x2", "x3")),
        "xdot": OutputElements(("x1dot", "x2dot", "x3dot")),
        "jacobian": OutputElements(("see its pattern",), shape, len(shape.rowidx)),
    }
    return program.kernel(function, context.inputs, outputs)


def _load(context: LoopContext, function: ModelFunction) -> Kernel:
    point = context.equations.marker(function.variant)
    components = tuple(point.force)
    force = Argument("F", tuple(s.name for s in components), "force at the marker, in the inertial frame [N]")
    program = context.program(context.q)
    program.known |= {symbol: ScalarRef(symbol.name) for symbol in components}
    program.mode_sums |= {t.symbol: t for t in point.mode_sums}
    program.table_sums |= {t.symbol: t for t in point.table_sums}
    program.definitions += point.force_definitions
    wants: list[Scalar] = [(Store("f", r, NOTHING), e) for r, e in enumerate(point.load[:RIGID])]
    rows: list[IndexedStore] = [(StoreStrided("f", RIGID, 1, NOTHING), point.load[RIGID])]
    program.phase("f", "(10)", "virtual work of the force", wants, rows)
    outputs = {"f": OutputElements(row_labels("f", context), count=RIGID + context.n)}
    return program.kernel(function, {**context.inputs, "F": force}, outputs)


def _residual(context: LoopContext, function: ModelFunction) -> Kernel:
    n = context.n
    program = context.program(context.y, context.ydot)
    first = RIGID + 1 + n
    scalars: list[Scalar] = [
        (Store("F", k, NOTHING), state_rate(q) - rate)
        for k, (q, rate) in enumerate(zip(context.elements["q"], context.rigid_rates, strict=True))
    ]
    scalars += [(Store("F", first + r, NOTHING), context.left[name]) for r, name in enumerate(context.rows)]
    rows: list[IndexedStore] = [
        (StoreStrided("F", RIGID + 1, 1, NOTHING), state_rate(amplitude(I)) - amplitude(I, 1)),
        (StoreStrided("F", first + RIGID, 1, NOTHING), context.left[SHAPE]),
    ]
    program.phase("F", "(15)", "qdot less its value from v, then M vdot + h", scalars, rows)
    labels = (*(f"{name}_t - ..." for name in context.q.elements), "...", *row_labels("M vdot + h", context))
    return program.kernel(function, context.inputs, {"F": OutputElements(labels, count=first + RIGID + n)})


def _zeros(context: LoopContext) -> tuple[Zero, ...]:
    """The blocks of the mass matrix that vanish, with the reasons."""
    eq = context.equations
    result = [Zero("M[c, c] off the diagonal", TRANSLATIONS)]
    if all(context.mass_entry(r, c) == 0 for r in (3, 4, 5) for c in (0, 1, 2)):
        result.append(Zero("M[pi, c]", _vanished(eq, Family.C1, Family.C2)))
    if context.n and not any(r in context.coupling for r in (0, 1, 2)):
        result.append(Zero("M[alpha, c]", _vanished(eq, Family.C2)))
    if context.n and not any(r in context.coupling for r in (3, 4, 5)):
        result.append(Zero("M[alpha, pi]", _vanished(eq, Family.C6, Family.C7)))
    if context.n > 1 and context.c8 is not TableKind.FULL:
        result.append(Zero("M[alpha, alpha] off the diagonal", eq.table(Family.C8).zero))
    return tuple(result)


def _vanished(eq: IndexedEquations, *families: Family) -> str:
    """The reason that all tables of these families vanish."""
    return str(eq.reason(*families))


IMPLEMENTATIONS: Mapping[FunctionKind, Callable[[LoopContext, ModelFunction], Kernel]] = {
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
