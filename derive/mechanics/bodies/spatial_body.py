"""The general body in space: its tables as parameters or as numbers, for both ways of lowering.

The parameters of a body are m, then the tables that it has, entry by entry in the order of `entries`; gravity last.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from derive.mechanics import motion, quantity
from derive.mechanics import virtual_work_equations as body
from derive.mechanics.bodies.modal_body import ModalBody, ModalPoint
from derive.mechanics.equations import Coefficient, Equations, ParameterSymbol
from derive.mechanics.indexed_equations import (
    SCALARS,
    TENSORS,
    GenericEquations,
    Table,
    TableKind,
    generic_equations,
    point_tables,
)
from derive.mechanics.points import MaterialPoint
from derive.mechanics.series import PARITY
from derive.mechanics.spatial import PAIRS, spatial_motion
from derive.mechanics.symbols import Family, Symbol
from derive.mechanics.symbols import parameter as parameter_symbol
from derive.mechanics.virtual_work_equations import Body
from derive.spec.model.body import Gravity, SymbolicBody

Array = NDArray[np.float64]

DOCS: dict[Family, tuple[str, str]] = {
    Family.C1: ("int rho X", "kg m"),
    Family.C2: ("int rho Phi_i", "kg"),
    Family.C3: ("int rho ((X . X) I - X X)", "kg m^2"),
    Family.C4: ("symmetric part of int rho ((Phi_i . X) I - Phi_i X)", "kg m"),
    Family.C5: ("symmetric part of int rho ((Phi_i . Phi_j) I - Phi_i Phi_j)", "kg"),
    Family.C6: ("int rho X x Phi_i", "kg m"),
    Family.C7: ("int rho Phi_i x Phi_j", "kg"),
    Family.C8: ("int rho Phi_i . Phi_j", "kg"),
    Family.STIFFNESS: ("stiffness", "N/m"),
    Family.DAMPING: ("damping", "N s/m"),
}
"""All tables in the order of the parameters: what they are, their units."""

MEAN = {
    Family.C1: "the choice of O (the centre of mass)",
    Family.C2: "condition (17) (no mean displacement)",
    Family.C6: "condition (19) (no mean rotation)",
    Family.C8: "orthogonality (modes orthonormal in the mass)",
    Family.STIFFNESS: "orthogonality (modes orthonormal in the mass and the stiffness)",
    Family.DAMPING: "orthogonality (damping of each mode alone)",
}
"""Why integrals vanish in the mean frame; of c8, K and B those off the diagonal."""

NOTHING = "the sum over the nodes, which is exactly zero"
NO_SHAPES = "the number of shapes (there is none)"
ODD = "c7 is odd in its indices (one shape does not act on itself)"
UNDAMPED = "the specification (no damping)"
MASS = ParameterSymbol(parameter_symbol("m", positive=True), "mass of the body", "kg", 1.0)


def entries(table: Table, n: int) -> Iterator[Symbol]:
    """The entries of a table in the order of the parameters: C5_1_2_11."""
    shapes = range(1, n + 1)
    odd = PARITY.get(table.family, 1) < 0
    counted: tuple[list[tuple[int, ...]], ...] = (
        [()],
        [(i,) for i in shapes],
        [(i, j) for i in shapes for j in shapes if i < j or (i == j and not odd)],
    )
    for numbers, component in product(counted[table.counted], table.components):
        yield table.entry(component, *numbers)


def symbolic_tables(spec: SymbolicBody) -> tuple[Table, ...]:
    """What tables a body with parameters has, by its frame."""
    kinds: dict[Family, tuple[TableKind, str]] = {}
    if spec.frame == "mean":
        kinds |= {family: ("zero", MEAN[family]) for family in (Family.C1, Family.C2, Family.C6)}
        kinds[Family.C8] = "unit", MEAN[Family.C8]
        kinds |= {family: ("diagonal", MEAN[family]) for family in (Family.STIFFNESS, Family.DAMPING)}
    if not spec.damping:
        kinds[Family.DAMPING] = ("zero", UNDAMPED)
    return _tables(spec.modes, kinds)


def modal_tables(given: ModalBody) -> tuple[Table, ...]:
    """What tables a body of numbers has: those that are not zero; c8, K and B may be diagonal; its points last."""
    kinds: dict[Family, tuple[TableKind, str]] = {}
    values = {family: _values(given, _full(family)) for family in DOCS}
    for family in SCALARS:
        matrix = _matrix(given, family)
        if not np.count_nonzero(matrix - np.diag(np.diag(matrix))):
            unit = family is Family.C8 and bool(np.all(np.diag(matrix) == 1))
            kinds[family] = "unit" if unit else "diagonal", _reason(given, family)
    kinds |= {family: ("zero", _reason(given, family)) for family, v in values.items() if not np.any(v)}
    points = (t for k, point in enumerate(given.points, 1) for t in point_tables(k, point.name))
    return (*_tables(given.modes, kinds), *points)


def _full(family: Family) -> Table:
    """The table of a family with all of its entries."""
    return Table(family, "full", *DOCS[family])


def _tables(n: int, kinds: dict[Family, tuple[TableKind, str]]) -> tuple[Table, ...]:
    tables = []
    for family in DOCS:
        table = _full(family)
        kind, zero = kinds.get(family, (table.kind, table.zero))
        if table.counted and n == 0:
            kind, zero = "zero", NO_SHAPES
        elif family is Family.C7 and n == 1:
            kind, zero = "zero", ODD
        tables.append(replace(table, kind=kind, zero=zero))
    return tuple(tables)


def _matrix(given: ModalBody, family: Family) -> Array:
    """A table without components, as a matrix over the shapes."""
    return {Family.C8: given.c8, Family.STIFFNESS: given.stiffness, Family.DAMPING: given.damping}[family]


def _values(given: ModalBody, table: Table) -> Array:
    """The entries of a table, in the order of `entries`."""
    n, family = given.modes, table.family
    if table.point:
        point = given.points[int(table.point) - 1]
        return np.asarray(point.position if family is Family.POINT_POSITION else point.shapes).ravel()
    if family in TENSORS:
        tensor = {Family.C3: given.C3, Family.C4: given.C4, Family.C5: given.C5}[family]
        even = (tensor + np.swapaxes(tensor, -1, -2)) / 2
        components = np.stack([even[..., a - 1, b - 1] for a, b in PAIRS], axis=-1)
        return components[np.triu_indices(n)].ravel() if family is Family.C5 else components.ravel()
    if family in SCALARS:
        return np.asarray(_matrix(given, family)[np.triu_indices(n)])
    if family is Family.C7:
        return given.c7[np.triu_indices(n, 1)].ravel()
    return {Family.C1: given.c1, Family.C2: given.c2, Family.C6: given.c6}[family].ravel()


def _reason(given: ModalBody, family: Family) -> str:
    """Why a table vanishes, or vanishes off its diagonal: what the body says of its first zero entry."""
    names = (entry.name for entry in entries(_full(family), given.modes))
    return next((given.zeros[name] for name in names if name in given.zeros), NOTHING)


def parameters(given: ModalBody, tables: tuple[Table, ...], gravity: Gravity | None = None) -> Array:
    """The parameters p of a body for a model with these tables, gravity at its defaults.

    Raises ValueError when the body has an integral that the model takes to vanish.
    """
    parts = [np.array([given.mass])]
    for t in tables:
        values = _values(given, t)
        if t.kind == "full":
            parts.append(values)
            continue
        diagonal = np.zeros(len(values), dtype=bool)
        if t.counted == 2:
            diagonal = np.array([i == j for i, j in zip(*np.triu_indices(given.modes), strict=True)], dtype=bool)
        size = np.abs(values).max(initial=0.0)
        if np.any(np.abs(values[~diagonal] if t.kind != "zero" else values) > 1e-9 * max(size, given.mass)):
            raise ValueError(f"the model takes {t.name} to vanish ({t.zero}), but that of {given.name} does not")
        if t.kind == "unit" and np.any(np.abs(values[diagonal] - 1) > 1e-9):
            raise ValueError(
                f"the model takes {t.name} to be the unit matrix ({t.zero}), but that of {given.name} is not: "
                "bring the body to the mean frame with orthonormal modes, or scale them to modal masses of 1 kg"
            )
        if t.kind == "diagonal":
            parts.append(values[diagonal])
    _, symbols = quantity.gravity(gravity)
    return np.concatenate([*parts, [p.default for p in symbols]])


def derive_modal(given: ModalBody, gravity: Gravity | None = None) -> Equations:
    """The equations of motion of a body of numbers, written out; its integrals are folded as the doubles they are."""

    def number(entry: Symbol, value: float) -> tuple[sp.Expr, str | None]:
        return sp.Rational(value), None if value else given.zeros.get(entry.name, NOTHING)

    values = {
        entry: number(entry, float(value))
        for table in map(_full, DOCS)
        for entry, value in zip(entries(table, given.modes), _values(given, table), strict=True)
    }
    points = tuple(map(_point, given.points))
    return _written_out(
        given.name, given.doc, _where(given), given.modes, values, sp.Rational(given.mass), points, (), gravity
    )


def derive_symbolic(spec: SymbolicBody) -> Equations:
    """The equations of motion of a body whose mass, shape integrals and stiffness are parameters, written out."""
    values: dict[Symbol, tuple[sp.Expr, str | None]] = {}
    symbols = [MASS]
    for t in symbolic_tables(spec):
        for entry in entries(t, spec.modes):
            same = _on_diagonal(entry)
            if t.kind == "zero" or (t.kind != "full" and not same):
                values[entry] = sp.S.Zero, t.zero
            elif t.kind == "unit":
                values[entry] = sp.S.One, None
            else:
                symbol = Symbol(replace(entry.identity, parameter=True))
                default = float(same and t.family in (Family.C3, Family.C8, Family.STIFFNESS))
                symbols.append(ParameterSymbol(symbol, t.doc, t.unit, default, positive=False))
                values[entry] = symbol, None
    doc = describe_symbolic(spec)
    return _written_out(spec.name, doc, "", spec.modes, values, MASS.symbol, (), tuple(symbols), spec.gravity)


def _on_diagonal(entry: Symbol) -> bool:
    """c8_2_2, K_1_1; C3_11."""
    known = entry.identity
    first, second = known.components if known.family is Family.C3 else known.shapes if len(known.shapes) > 1 else (0, 1)
    return first == second


def describe_symbolic(spec: SymbolicBody) -> str:
    """What the body is, in a line."""
    frame = "mean frame" if spec.frame == "mean" else "modes as given"
    return f"free body in space, {frame}, {spec.modes} modes, shape integrals as parameters"


def _written_out(
    name: str,
    doc: str,
    origin: str,
    n: int,
    values: dict[Symbol, tuple[sp.Expr, str | None]],
    mass: sp.Expr,
    points: tuple[MaterialPoint, ...],
    symbols: tuple[ParameterSymbol, ...],
    gravity: Gravity | None,
) -> Equations:
    forces = (Family.STIFFNESS, Family.DAMPING)
    by_family: dict[Family, list[Coefficient]] = {family: [] for family in DOCS}
    for entry, (value, zero) in values.items():
        family = entry.identity.family
        what, unit = DOCS[family]
        equation = "(13)" if family in forces else "appendix"
        by_family[family].append(Coefficient(entry, value, equation, what, unit, zero))
    integrals = tuple(c for family, some in by_family.items() if family not in forces for c in some)
    weight, of_gravity = quantity.gravity(gravity)
    damped = any(not c.zero for c in by_family[Family.DAMPING])
    return body.equations(
        Body(
            name=name,
            doc=doc,
            origin=origin,
            motion=spatial_motion(n),
            mass=mass,
            integrals=integrals,
            stiffness=tuple(by_family[Family.STIFFNESS]),
            points=points,
            parameters=(*symbols, *of_gravity),
            damping=tuple(by_family[Family.DAMPING]) if damped else (),
            gravity=weight,
        )
    )


def _where(given: ModalBody) -> str:
    """Where c is, as a sentence."""
    return f"c is where {given.origin} lies in the floating frame." if given.origin else ""


def _point(point: ModalPoint) -> MaterialPoint:
    def exact(vector: Array) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix([sp.Rational(float(x)) for x in vector])

    return MaterialPoint(point.name, point.doc, exact(point.position), tuple(map(exact, point.shapes)))


def generic_symbolic(spec: SymbolicBody) -> GenericEquations:
    """The equations of motion of a body with parameters, for a generic shape."""
    return _generic(spec.name, describe_symbolic(spec), "", spec.modes, symbolic_tables(spec), spec.gravity)


def _generic(
    name: str, doc: str, origin: str, n: int, tables: tuple[Table, ...], gravity: Gravity | None,
    points: tuple[ModalPoint, ...] = (), data: Array | None = None, mass: float = 1.0,
) -> GenericEquations:  # fmt: skip
    weight, of_gravity = quantity.gravity(gravity)
    scalars = (Coefficient(motion.MASS, MASS.symbol, "(15)", "mass of the body", "kg"), *weight)
    first = ParameterSymbol(MASS.symbol, MASS.doc, MASS.unit, mass)
    return generic_equations(
        name,
        doc,
        origin,
        n,
        tables,
        scalars,
        (first, *of_gravity),
        tuple((p.name, p.doc) for p in points),
        None if data is None else tuple(map(float, data)),
    )


def generic_modal(given: ModalBody, gravity: Gravity | None = None) -> GenericEquations:
    """The equations of motion of a body of numbers, for a generic shape: its numbers are the defaults of parameters."""
    tables = modal_tables(given)
    data = parameters(given, tables, gravity)
    return _generic(given.name, given.doc, _where(given), given.modes, tables, gravity, given.points, data, given.mass)


Present = dict[Family, NDArray[np.bool_]]
"""Which entries of C5 (N, N, 6), c7 (N, N, 3), K, B (N, N, 1), C4 (N, 6), c2 and c6 (N, 3) there are."""


def present_modal(given: ModalBody) -> Present:
    """The entries of a body of numbers that do not vanish."""
    n = given.modes
    present: Present = {}
    for family in (Family.C4, Family.C2, Family.C6):
        table = _full(family)
        present[family] = (_values(given, table) != 0).reshape(n, len(table.components))
    for family in (Family.C5, Family.C7, Family.STIFFNESS, Family.DAMPING):
        table = _full(family)
        full = np.zeros((n, n, len(table.components)), dtype=bool)
        upper = np.triu_indices(n, 1 if family is Family.C7 else 0)
        full[upper] = (_values(given, table) != 0).reshape(-1, len(table.components))
        present[family] = full | full.swapaxes(0, 1)
    return present


def present_symbolic(spec: SymbolicBody) -> Present:
    """The entries that a body with parameters has."""
    n = spec.modes
    present: Present = {}
    for t in symbolic_tables(spec):
        if t.counted:
            full = np.full((n,) * t.counted + (len(t.components),), t.kind == "full")
            if t.kind == "diagonal":
                full |= np.eye(n, dtype=bool)[..., None]
            present[t.family] = full
    return present
