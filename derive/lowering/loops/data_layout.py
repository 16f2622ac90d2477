"""Data layout of a model with loops: the parameters p in the order of the tables, the constants k packed for loops.

In p an integral has the order of the appendix: for each mode i, or pair i <= j (i < j where the integral is odd) by
rows, its components. In k the square tables are packed in panels, vectors over the shapes are padded to a multiple of
four, and scalars come last.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from derive.algebra import fraction, sp
from derive.ir.expressions import Element, Expr, Number, ScalarRef
from derive.ir.indices import padded, variable
from derive.ir.kernel import Argument, Kernel, Output, Section, View
from derive.ir.model import Model, Variable, Zero
from derive.ir.packing import Packing
from derive.ir.statements import (
    Cholesky,
    Clear,
    Map,
    Pack,
    PackSource,
    Require,
    RequireFinite,
    Requirement,
    ReturnCode,
    Statement,
    Store,
    StoreStrided,
)
from derive.lowering.model_tables import parameter_variables
from derive.lowering.terms import model_terms
from derive.mechanics.fixed_symbols import MASS
from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.sums import PARITY
from derive.mechanics.symbols import Family, parameter
from derive.mechanics.tables import CoefficientTable, TableKind
from derive.mechanics.terms import ModelConstant, ParameterSymbol
from derive.roles import Role, Source

TABLES, TRIANGLE, ROOT = "tables", "c8_pairs", "root"
GROUPS = (
    (Family.C5, Family.C7, Family.C9, Family.C10),
    (Family.STIFFNESS, Family.DAMPING),
    (Family.C8,),
    (Family.POINT_SECOND,),
)
"""Families of square tables that are read together: those of M and h, those of h, and those of few functions."""
PACKED = tuple(family for group in GROUPS for family in group)


@dataclass(frozen=True)
class DataLayout:
    """The constants of one model: the argument k, the packing of its tables, and what scalars are in the Kernel.

    `parameters` are the variables of p, in order; `triangle` is the array of c8 for i <= j.
    """

    argument: Argument
    packing: Packing
    scalars: dict[sp.Symbol, Number | ScalarRef]
    parameters: tuple[Variable, ...]
    sources: tuple[tuple[CoefficientTable, int], ...]
    triangle: str = TRIANGLE


def arrays(table: CoefficientTable) -> tuple[str, ...]:
    """The arrays or scalars of a table, one for each component: C5_11, C5_12, ...; K."""
    return tuple(table.entry(component).name for component in table.components)


def size(table: CoefficientTable, n: int) -> int:
    """The number of parameters of a table for n modes."""
    if table.kind in (TableKind.ZERO, TableKind.UNIT):
        return 0
    pairs = n * (n + PARITY.get(table.family, 1)) // 2
    counts = (1, n, n if table.kind is TableKind.DIAGONAL else pairs)
    return counts[table.counted] * len(table.components)


def layout(eq: IndexedEquations) -> DataLayout:
    """The layout of p and k for the equations of a body."""
    n = eq.modes
    kept = [t for t in eq.tables if size(t, n)]
    full = [t for t in kept if t.kind is TableKind.FULL]
    groups = (tuple(a for f in group for t in full if t.family is f for a in arrays(t)) for group in GROUPS)
    packing = Packing(TABLES, n, tuple(group for group in groups if group))
    names = packing.tables
    views = [View(TABLES, 0, packing.size)] if names else []
    vectors = [name for t in kept if t.kind is TableKind.DIAGONAL or t.counted == 1 for name in arrays(t)]
    offset = packing.size if names else 0
    for name, length in [(v, padded(n)) for v in vectors] + _c8_arrays(eq):
        views.append(View(name, offset, length))
        offset += length
    scalars: dict[sp.Symbol, Number | ScalarRef] = {}
    for c in _scalars(eq):
        number = c.value.is_Rational
        scalars[c.symbol] = Number(fraction(c.value)) if number else ScalarRef(str(c.symbol))
    for t in kept:
        if not t.counted:
            scalars |= {symbol: ScalarRef(symbol.name) for symbol in t.generic_entries}
    elements = tuple(leaf.name for leaf in scalars.values() if isinstance(leaf, ScalarRef))
    positions = tuple(range(offset, offset + len(elements)))
    argument = Argument("k", elements, "constants from setup", arrays=tuple(views), positions=positions)
    return DataLayout(argument, packing, scalars, _parameters(eq, kept), tuple(_offsets(eq, kept)))


def _scalars(eq: IndexedEquations) -> tuple[ModelConstant, ...]:
    """The scalar constants: the mass, which is always a parameter, and gravity."""
    mass = _mass(eq)
    return tuple(replace(c, value=mass.symbol) if c.symbol == MASS else c for c in eq.coefficients)


def _mass(eq: IndexedEquations) -> ParameterSymbol:
    """The parameter that is the mass: the one of the specification, or m with its number as the default."""
    value = next(c.value for c in eq.coefficients if c.symbol == MASS)
    known = (p for p in eq.parameters if p.symbol == value)
    return next(known, None) or ParameterSymbol(parameter("m", positive=True), "mass of the body", "kg", float(value))


def _others(eq: IndexedEquations) -> tuple[ParameterSymbol, ...]:
    """The parameters besides the mass and the entries of tables, which are arrays here."""
    mass = _mass(eq).symbol
    return tuple(p for p in eq.parameters if p.symbol != mass and not p.symbol.identity.parameter)


def _c8_arrays(eq: IndexedEquations) -> list[tuple[str, int]]:
    n = eq.modes
    return [(TRIANGLE, n * (n + 1) // 2), (ROOT, n * n)] if n and eq.table(Family.C8).kind is TableKind.FULL else []


def _parameters(eq: IndexedEquations, kept: list[CoefficientTable]) -> tuple[Variable, ...]:
    first, *rest = parameter_variables((_mass(eq), *_others(eq)))
    tables = (Variable(t.name, _doc(t), t.unit, 0.0, size(t, eq.modes)) for t in kept)
    return (first, *tables, *rest)


def _doc(table: CoefficientTable) -> str:
    parts = [table.doc]
    if table.counted == 2 and table.kind is TableKind.FULL:
        parts.append("for i <= j by rows" if PARITY[table.family] > 0 else "for i < j by rows")
    elif table.counted:
        parts.append("for each i")
    if len(table.components) > 1:
        labels = ("".join(map(str, component)) for component in table.components)
        parts.append(f"components {' '.join(labels)} together")
    return ", ".join(parts)


def _offsets(eq: IndexedEquations, kept: list[CoefficientTable]) -> list[tuple[CoefficientTable, int]]:
    offsets, offset = [], 1
    for t in kept:
        offsets.append((t, offset))
        offset += size(t, eq.modes)
    return offsets


def copied(output: str, offset: int, source: str, count: int) -> Section:
    """A section that copies an array to an output."""
    loop = Map(count, (StoreStrided(output, offset, 1, Element(source, variable("i"))),))
    return Section("c8", Source.APPENDIX, "int rho Phi_i . Phi_j, which does not change", (loop,))


def setup(eq: IndexedEquations, layout: DataLayout) -> Kernel:
    """p -> k: packing, and the Cholesky factor of c8 where it is full."""
    n = eq.modes
    views = tuple(View(f"p_{t.name}", offset, size(t, n)) for t, offset in layout.sources if t.counted)
    elements, positions = _scalar_elements(eq, layout)
    p = Argument("p", elements, "parameters", arrays=views, positions=positions)
    k = layout.argument
    total = k.size
    body: list[Statement] = [Clear("k", total)]
    sources = [
        PackSource(name, f"p_{t.name}", c, len(t.components), PARITY[t.family])
        for t, _ in layout.sources
        if t.family in PACKED and t.kind is TableKind.FULL
        for c, name in enumerate(arrays(t))
    ]
    ordered = tuple(s for name in layout.packing.tables for s in sources if s.table == name)
    body += [Pack(layout.packing, "k", ordered)] if ordered else []
    offsets = {view.name: view.offset for view in k.arrays}
    rows = [
        StoreStrided("k", offsets[name], 1, Element(f"p_{t.name}", variable("i", len(t.components), c)))
        for t, _ in layout.sources
        if t.counted == 1 or t.kind is TableKind.DIAGONAL
        for c, name in enumerate(arrays(t))
    ]
    body += [Map(n, tuple(rows))] if rows else []
    values: dict[str, Expr] = {str(c.symbol): ScalarRef(f"p_{c.value}") for c in _scalars(eq)}
    body += [Store("k", offset, values.get(name, ScalarRef(f"p_{name}"))) for offset, name in k.named_elements]
    checks: list[Statement] = [
        RequireFinite("p", p.size, ReturnCode.NOT_FINITE, "a parameter is not finite"),
        *(
            Require(
                Requirement.POSITIVE, ScalarRef(f"p_{q.symbol}"), ReturnCode.NOT_FINITE, f"{q.symbol} must be positive"
            )
            for q in (_mass(eq), *_others(eq))
            if q.positive
        ),
    ]
    sections = [
        Section("checks", "", "checks of the parameters", tuple(checks)),
        Section("constants", Source.APPENDIX, "shape integrals and stiffness in the layout of the loops", tuple(body)),
    ]
    if TRIANGLE in offsets:
        pairs = n * (n + 1) // 2
        sections.append(copied("k", offsets[TRIANGLE], "p_c8", pairs))
        root = Cholesky("k", offsets[ROOT], "p_c8", n, ReturnCode.PIVOT, "c8 is not positive definite")
        sections.append(Section("root", Source.FACTORISATION, "Cholesky factor of c8", (root,)))
    doc = "Constants k from the parameters p: once for a set of parameters."
    return Kernel("setup", doc, (p,), (Output("k", (), "constants", None, total),), tuple(sections))


def _scalar_elements(eq: IndexedEquations, layout: DataLayout) -> tuple[tuple[str, ...], tuple[int, ...]]:
    """The names of the scalar parameters, and their indices in p."""
    elements = [(f"p_{_mass(eq).symbol}", 0)]
    end = 1
    for t, offset in layout.sources:
        if not t.counted:
            elements += [(f"p_{name}", offset + c) for c, name in enumerate(arrays(t))]
        end = offset + size(t, eq.modes)
    elements += [(f"p_{q.symbol}", end + c) for c, q in enumerate(_others(eq))]
    return tuple(name for name, _ in elements), tuple(index for _, index in elements)


def model(
    eq: IndexedEquations, layout: DataLayout, kernels: tuple[Kernel, ...], zeros: tuple[Zero, ...], choice: str
) -> Model:
    """The kernels of a model with names, units and reasons."""
    n, rigid = eq.modes, eq.rows[:6]

    def of_shapes(name: str, doc: str, unit: str, role: Role | None = None) -> tuple[Variable, ...]:
        """A variable with one element for each mode; the name of a single element ends in 1."""
        return (Variable(f"{name}1" if n == 1 else name, doc, unit, 0.0, n, role),) if n else ()

    table_of = {name: t for t in eq.tables for name in arrays(t)}
    docs = {name: (t.doc, t.unit) for name, t in table_of.items()}
    docs |= {str(c.symbol): (c.doc, c.unit) for c in eq.coefficients}
    docs |= {TABLES: (", ".join(layout.packing.tables), ""), TRIANGLE: ("c8 for i <= j", "kg"), ROOT: ("of c8", "")}
    constants = tuple(Variable(v.name, docs[v.name][0], docs[v.name][1], 0.0, v.size) for v in layout.argument.arrays)
    constants += tuple(Variable(name, *docs[name]) for name in layout.argument.elements)
    result = Model(
        name=eq.name,
        doc=eq.doc,
        frame_doc=eq.frame_doc,
        coordinates=tuple(Variable(str(c.q), c.doc, c.unit, role=c.role) for c in eq.coordinates[:7])
        + of_shapes("alpha", "amplitudes of the assumed modes", "m", Role.AMPLITUDE),
        velocities=tuple(Variable(str(r.v), r.doc, r.unit) for r in rigid)
        + of_shapes("alphadot", "time derivatives of alpha", "m/s"),
        equations=tuple(Variable(r.name, f"row of delta {r.name}", r.force_unit) for r in rigid)
        + of_shapes("alpha", "rows of delta alpha", "N"),
        parameters=layout.parameters,
        constants=constants,
        kernels=(setup(eq, layout), *kernels),
        markers=tuple(Variable(p.name, p.doc, "m") for p in eq.markers),
        zeros=zeros,
        vanished=tuple(Zero(f"{v.term.name} term of row {v.term.row}", str(v.reason)) for v in eq.vanished),
        lowering="loops",
        choice=choice,
        data=_data(eq, layout),
    )
    return replace(result, terms=model_terms(eq, result.pattern("mass", "M")))


def _data(eq: IndexedEquations, layout: DataLayout) -> tuple[tuple[int, float], ...]:
    """The defaults: those of a body given by data, or a unit ball of inertia whose modes do not couple."""
    n, end = eq.modes, 1
    defaults = [(0, _mass(eq).default)]
    numbers = [eq.body.values.numbers(t) for t, _ in layout.sources]
    if all(values is not None for values in numbers):
        gravity = [p.default for p in _others(eq)]
        data = np.concatenate([[defaults[0][1]], *(v for v in numbers if v is not None), gravity])
        return tuple((k, float(value)) for k, value in enumerate(data) if value)
    for t, offset in layout.sources:
        if t.family is Family.C3:
            defaults += [(offset + k, 1.0) for k, (a, b) in enumerate(t.components) if a == b]
        elif t.family in (Family.C8, Family.STIFFNESS):
            diagonal = range(n) if t.kind is TableKind.DIAGONAL else (i * n - i * (i - 1) // 2 for i in range(n))
            defaults += [(offset + k, 1.0) for k in diagonal]
        end = offset + size(t, n)
    defaults += [(end + k, q.default) for k, q in enumerate(_others(eq))]
    return tuple(defaults)
