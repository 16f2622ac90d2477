"""The general body in space: its tables as parameters or as numbers, for both ways of lowering.

The parameters of a body are m, then the tables that it has, entry by entry in the order of `entries`; gravity last.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from derive.mechanics import quantity
from derive.mechanics.bodies.modal_body import ModalBody, ModalPoint
from derive.mechanics.body import Body
from derive.mechanics.motion.material_points import MaterialPoint
from derive.mechanics.symbols import Family, Symbol
from derive.mechanics.symbols import parameter as parameter_symbol
from derive.mechanics.tables import NO_SHAPES, ODD, PAIRS, SCALARS, TENSORS, CoefficientTable, TableKind, entries
from derive.mechanics.terms import ModelConstant, ParameterSymbol
from derive.roles import Source
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
    Family.C1: "the choice of the origin (the centre of mass)",
    Family.C2: "condition (17) (no mean displacement)",
    Family.C6: "condition (19) (no mean rotation)",
    Family.C8: "orthogonality (modes orthonormal in the mass)",
    Family.STIFFNESS: "orthogonality (modes orthonormal in the mass and the stiffness)",
    Family.DAMPING: "orthogonality (damping of each mode alone)",
}
"""Why integrals vanish in the mean frame; of c8, K and B those off the diagonal."""

NOTHING = "the sum over the nodes, which is exactly zero"
UNDAMPED = "the specification (no damping)"
MASS = ParameterSymbol(parameter_symbol("m", positive=True), "mass of the body", "kg", 1.0)


def symbolic_tables(spec: SymbolicBody) -> tuple[CoefficientTable, ...]:
    """What tables a body with parameters has, by its frame."""
    kinds: dict[Family, tuple[TableKind, str]] = {}
    if spec.frame == "mean":
        kinds |= {family: (TableKind.ZERO, MEAN[family]) for family in (Family.C1, Family.C2, Family.C6)}
        kinds[Family.C8] = TableKind.UNIT, MEAN[Family.C8]
        kinds |= {family: (TableKind.DIAGONAL, MEAN[family]) for family in (Family.STIFFNESS, Family.DAMPING)}
    if not spec.damping:
        kinds[Family.DAMPING] = (TableKind.ZERO, UNDAMPED)
    return _tables(spec.modes, kinds)


def modal_tables(given: ModalBody) -> tuple[CoefficientTable, ...]:
    """What tables a body of numbers has: those that are not zero; c8, K and B may be diagonal."""
    kinds: dict[Family, tuple[TableKind, str]] = {}
    values = {family: _values(given, _full(family)) for family in DOCS}
    for family in SCALARS:
        matrix = _matrix(given, family)
        if not np.count_nonzero(matrix - np.diag(np.diag(matrix))):
            unit = family is Family.C8 and bool(np.all(np.diag(matrix) == 1))
            kinds[family] = TableKind.UNIT if unit else TableKind.DIAGONAL, _reason(given, family)
    kinds |= {family: (TableKind.ZERO, _reason(given, family)) for family, v in values.items() if not np.any(v)}
    return _tables(given.modes, kinds)


def _full(family: Family) -> CoefficientTable:
    """The table of a family with all of its entries."""
    return CoefficientTable(family, TableKind.FULL, *DOCS[family])


def _tables(n: int, kinds: dict[Family, tuple[TableKind, str]]) -> tuple[CoefficientTable, ...]:
    tables = []
    for family in DOCS:
        table = _full(family)
        kind, zero = kinds.get(family, (table.kind, table.zero))
        if table.counted and n == 0:
            kind, zero = TableKind.ZERO, NO_SHAPES
        elif family is Family.C7 and n == 1:
            kind, zero = TableKind.ZERO, ODD
        tables.append(replace(table, kind=kind, zero=zero))
    return tuple(tables)


def _matrix(given: ModalBody, family: Family) -> Array:
    """A table without components, as a matrix over the shapes."""
    return {Family.C8: given.c8, Family.STIFFNESS: given.stiffness, Family.DAMPING: given.damping}[family]


def _values(given: ModalBody, table: CoefficientTable) -> Array:
    """The entries of a table, in the order of `entries`."""
    n, family = given.modes, table.family
    if table.point:
        point = given.points[int(table.point) - 1]
        return np.asarray(point.position if family is Family.POINT_POSITION else point.shapes).ravel()
    if family in TENSORS:
        tensor = {Family.C3: given.C3, Family.C4: given.C4, Family.C5: given.C5}[family]
        even = (tensor + np.swapaxes(tensor, -1, -2)) / 2
        components = np.stack([even[..., a - 1, b - 1] for a, b in PAIRS], axis=-1)
        return np.asarray(components[np.triu_indices(n)] if family is Family.C5 else components).ravel()
    if family in SCALARS:
        upper: Array = _matrix(given, family)[np.triu_indices(n)]
        return upper
    if family is Family.C7:
        return np.asarray(given.c7[np.triu_indices(n, 1)]).ravel()
    vectors: dict[Family, Array] = {Family.C1: given.c1, Family.C2: given.c2, Family.C6: given.c6}
    return vectors[family].ravel()


def _kept(table: CoefficientTable, n: int, values: Array) -> Array:
    """The entries that a table has, of all its entries in the order of `entries`."""
    if table.kind is TableKind.DIAGONAL:
        rows, columns = np.triu_indices(n)
        diagonal: Array = values[rows == columns]
        return diagonal
    return values if table.kind is TableKind.FULL else values[:0]


def _reason(given: ModalBody, family: Family) -> str:
    """The reason that a table vanishes (off its diagonal): the reason of its first zero entry in the body."""
    names = (entry.name for entry in entries(_full(family), given.modes))
    return next((given.zeros[name] for name in names if name in given.zeros), NOTHING)


def parameters(given: ModalBody, tables: tuple[CoefficientTable, ...], gravity: Gravity | None = None) -> Array:
    """The parameters p of a body for a model with these tables, gravity at its defaults.

    Raises ValueError when the body has an integral that the model takes to vanish.
    """
    parts = [np.array([given.mass])]
    for t in tables:
        values = _values(given, t)
        if t.kind is TableKind.FULL:
            parts.append(values)
            continue
        diagonal = np.zeros(len(values), dtype=bool)
        if t.counted == 2:
            diagonal = np.array([i == j for i, j in zip(*np.triu_indices(given.modes), strict=True)], dtype=bool)
        size = np.abs(values).max(initial=0.0)
        if np.any(np.abs(values[~diagonal] if t.kind is not TableKind.ZERO else values) > 1e-9 * max(size, given.mass)):
            raise ValueError(f"the model takes {t.name} to vanish ({t.zero}), but that of {given.name} does not")
        if t.kind is TableKind.UNIT and np.any(np.abs(values[diagonal] - 1) > 1e-9):
            raise ValueError(
                f"the model takes {t.name} to be the unit matrix ({t.zero}), but that of {given.name} is not: "
                "bring the body to the mean frame with orthonormal modes, or scale them to modal masses of 1 kg"
            )
        if t.kind is TableKind.DIAGONAL:
            parts.append(values[diagonal])
    _, symbols = quantity.gravity(gravity)
    return np.concatenate([*parts, [p.default for p in symbols]])


@dataclass(frozen=True)
class NumberValues:
    """Entries that are the numbers of a modal body, folded as the doubles they are."""

    body: ModalBody

    def constants(self, table: CoefficientTable) -> Iterator[ModelConstant]:
        """See `Values`."""
        pairs = zip(entries(table, self.body.modes), _values(self.body, table), strict=True)
        for entry, value in pairs:
            zero = None if value else self.body.zeros.get(entry.name, NOTHING)
            yield _constant(entry, sp.Rational(float(value)), zero)

    def present(self, table: CoefficientTable) -> NDArray[np.bool_]:
        """See `Values`."""
        n, components = self.body.modes, len(table.components)
        present: NDArray[np.bool_] = _values(self.body, table) != 0
        if table.counted < 2:
            return present.reshape(*(n,) * table.counted, components)
        full = np.zeros((n, n, components), dtype=bool)
        full[np.triu_indices(n, 1 if table.family is Family.C7 else 0)] = present.reshape(-1, components)
        return np.asarray(full | full.swapaxes(0, 1))

    def numbers(self, table: CoefficientTable) -> Array | None:
        """See `Values`."""
        return _kept(table, self.body.modes, _values(self.body, table))


@dataclass(frozen=True)
class ParameterValues:
    """Entries that are run-time parameters, as far as a table has them."""

    modes: int

    def constants(self, table: CoefficientTable) -> Iterator[ModelConstant]:
        """See `Values`."""
        for entry in entries(table, self.modes):
            if table.kind is TableKind.ZERO or (table.kind is not TableKind.FULL and not _on_diagonal(entry)):
                yield _constant(entry, sp.S.Zero, table.zero)
            elif table.kind is TableKind.UNIT:
                yield _constant(entry, sp.S.One, None)
            else:
                yield _constant(entry, _as_parameter(entry), None)

    def present(self, table: CoefficientTable) -> NDArray[np.bool_]:
        """See `Values`."""
        n, components = self.modes, len(table.components)
        full = np.full((n,) * table.counted + (components,), table.kind is TableKind.FULL)
        if table.kind is TableKind.DIAGONAL:
            full |= np.eye(n, dtype=bool)[..., None]
        return full

    def numbers(self, table: CoefficientTable) -> Array | None:
        """See `Values`."""
        return None


def _constant(entry: Symbol, value: sp.Expr, zero: str | None) -> ModelConstant:
    doc, unit = DOCS[entry.identity.family]
    equation = "(13)" if entry.identity.family in (Family.STIFFNESS, Family.DAMPING) else Source.APPENDIX
    return ModelConstant(entry, value, equation, doc, unit, zero)


def _as_parameter(entry: Symbol) -> Symbol:
    """The run-time parameter that is the value of an entry."""
    return Symbol(replace(entry.identity, parameter=True))


def modal_body(given: ModalBody, gravity: Gravity | None = None) -> Body:
    """A body of numbers as (15) needs to know it."""
    weight, of_gravity = quantity.gravity(gravity)
    return Body(
        name=given.name,
        doc=given.doc,
        frame_doc=_where(given),
        dimension=3,
        modes=given.modes,
        mass=sp.Rational(given.mass),
        tables=modal_tables(given),
        values=NumberValues(given),
        points=tuple(map(_point, given.points)),
        parameters=of_gravity,
        gravity=weight,
    )


def parametric_body(spec: SymbolicBody) -> Body:
    """A body whose mass, shape integrals and stiffness are parameters."""
    weight, of_gravity = quantity.gravity(spec.gravity)
    tables, values = symbolic_tables(spec), ParameterValues(spec.modes)
    symbols = [MASS]
    for table in tables:
        for entry in (c.symbol for c in values.constants(table) if c.value == _as_parameter(c.symbol)):
            default = _on_diagonal(entry) and table.family in (Family.C3, Family.C8, Family.STIFFNESS)
            symbols.append(ParameterSymbol(_as_parameter(entry), table.doc, table.unit, float(default), positive=False))
    return Body(
        name=spec.name,
        doc=describe_symbolic(spec),
        frame_doc="",
        dimension=3,
        modes=spec.modes,
        mass=MASS.symbol,
        tables=tables,
        values=values,
        parameters=(*symbols, *of_gravity),
        gravity=weight,
    )


def _on_diagonal(entry: Symbol) -> bool:
    """c8_2_2, K_1_1; C3_11."""
    known = entry.identity
    first, second = known.components if known.family is Family.C3 else known.shapes if len(known.shapes) > 1 else (0, 1)
    return first == second


def describe_symbolic(spec: SymbolicBody) -> str:
    """What the body is, in a line."""
    frame = "mean frame" if spec.frame == "mean" else "modes as given"
    return f"free body in space, {frame}, {spec.modes} modes, shape integrals as parameters"


def _where(given: ModalBody) -> str:
    """Where c is, as a sentence."""
    return f"c is where {given.origin} lies in the floating frame." if given.origin else ""


def _point(point: ModalPoint) -> MaterialPoint:
    def exact(vector: Array) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix([sp.Rational(float(x)) for x in vector])

    return MaterialPoint(point.name, point.doc, exact(point.position), tuple(map(exact, point.shapes)))
