"""The general body in space: its tables as parameters or as numbers, for both ways of lowering.

The parameters of a body are m, then the tables that it has, entry by entry in the order of `entries`; gravity last.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.bodies.spatial_tables import (
    DOCS,
    SECOND_ORDER_DOCS,
    kept_entries,
    modal_tables,
    symbolic_tables,
    table_values,
)
from derive.mechanics.body import Body
from derive.mechanics.motion.material_points import MaterialPoint
from derive.mechanics.symbols import Family, identity
from derive.mechanics.symbols import parameter as parameter_symbol
from derive.mechanics.tables import CoefficientTable, TableKind, entries
from derive.mechanics.terms import ModelConstant, ParameterSymbol
from derive.mechanics.zero_reasons import EXACT_SUM
from derive.roles import Source
from derive.spec.model.body import DisplacementOrder, Gravity, SymbolicBody

if TYPE_CHECKING:
    from derive.mechanics.bodies.modal_body import ModalBody, ModalPoint
    from derive.mechanics.typed_symbol import Symbol

Array = NDArray[np.float64]

MASS = ParameterSymbol(parameter_symbol("m", positive=True), "mass of the body", "kg", 1.0)


def parameters(given: ModalBody, tables: tuple[CoefficientTable, ...], gravity: Gravity | None = None) -> Array:
    """The parameters p of a body for a model with these tables, gravity at its defaults.

    Raises ValueError when the body has an integral that the model takes to vanish, or is of another order.
    """
    if given.second_order != any(t.family is Family.C9 for t in tables):
        order = "second" if given.second_order else "first"
        raise ValueError(f"{given.name} is a body of {order} order in the amplitudes, and the model is not")
    parts = [np.array([given.mass])]
    for t in tables:
        values = table_values(given, t)
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
    """Entries that are the numbers of a modal body, which are folded into the code as doubles."""

    body: ModalBody

    def constants(self, table: CoefficientTable) -> Iterator[ModelConstant]:
        """Return the constants of a table, see `Values`."""
        pairs = zip(entries(table, self.body.modes), table_values(self.body, table).tolist(), strict=True)
        zeros = self.body.zeros

        def reason(entry: Symbol) -> str:
            return zeros.get(entry.name, EXACT_SUM) if zeros else EXACT_SUM

        return _constants(
            table,
            (
                (entry, sp.Rational(value), None) if value else (entry, sp.S.Zero, reason(entry))
                for entry, value in pairs
            ),
        )

    def present(self, table: CoefficientTable) -> NDArray[np.bool_]:
        """Return the mask of a table, see `Values`."""
        n, components = self.body.modes, len(table.components)
        present: NDArray[np.bool_] = table_values(self.body, table) != 0
        if table.counted < 2:
            return present.reshape(*(n,) * table.counted, components)
        full = np.zeros((n, n, components), dtype=bool)
        full[np.triu_indices(n, 1 if table.family is Family.C7 else 0)] = present.reshape(-1, components)
        return np.asarray(full | full.swapaxes(0, 1))

    def numbers(self, table: CoefficientTable) -> Array | None:
        """Return the numbers of a table, see `Values`."""
        return kept_entries(table, self.body.modes, table_values(self.body, table))


@dataclass(frozen=True)
class ParameterValues:
    """Entries that are run-time parameters, except for those that vanish or are constant in their table."""

    modes: int

    def constants(self, table: CoefficientTable) -> Iterator[ModelConstant]:
        """Return the constants of a table, see `Values`."""
        return _constants(table, ((entry, *_parametric(entry, table)) for entry in entries(table, self.modes)))

    def present(self, table: CoefficientTable) -> NDArray[np.bool_]:
        """Return the mask of a table, see `Values`."""
        n, components = self.modes, len(table.components)
        full = np.full((n,) * table.counted + (components,), table.kind is TableKind.FULL)
        if table.kind is TableKind.DIAGONAL:
            full |= np.eye(n, dtype=bool)[..., None]
        return full

    def numbers(self, table: CoefficientTable) -> Array | None:
        """Return the numbers of a table, see `Values`."""
        return None


def _constants(
    table: CoefficientTable, values: Iterable[tuple[Symbol, sp.Expr, str | None]]
) -> Iterator[ModelConstant]:
    """The constants of the entries of a table, from these, their values, and the reasons of those that vanish."""
    source = _source(table)
    for entry, value, zero in values:
        yield ModelConstant(entry, value, source, table.doc, table.unit, zero)


def _parametric(entry: Symbol, table: CoefficientTable) -> tuple[sp.Expr, str | None]:
    """The value of an entry that is a parameter if the table has it, and the reason if it vanishes."""
    if table.kind is TableKind.ZERO or (table.kind is not TableKind.FULL and not _on_diagonal(entry)):
        return sp.S.Zero, table.zero
    return sp.S.One if table.kind is TableKind.UNIT else _as_parameter(entry), None


def _source(table: CoefficientTable) -> str:
    """The equation that the entries of a table come from."""
    family = table.family
    if (table.doc, table.unit) == SECOND_ORDER_DOCS[family] != DOCS.get(family):
        return Source.SECOND_ORDER
    return "(13)" if family in (Family.STIFFNESS, Family.DAMPING) else Source.APPENDIX


def _as_parameter(entry: Symbol) -> Symbol:
    """The run-time parameter that is the value of an entry."""
    return replace(identity(entry), parameter=True).symbol


def modal_body(given: ModalBody, gravity: Gravity | None = None) -> Body:
    """The `Body` of the equations of motion (15) for a body of numbers."""
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
        order=DisplacementOrder.TRUNCATED if given.second_order else DisplacementOrder.FIRST_ORDER,
    )


def parametric_body(spec: SymbolicBody) -> Body:
    """The `Body` of (15) for a body whose mass, shape integrals and stiffness are parameters."""
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
    """Whether an entry is on the diagonal of its table, such as c8_2_2, K_1_1 or C3_11."""
    known = entry.identity
    first, second = known.components if known.family is Family.C3 else known.shapes if len(known.shapes) > 1 else (0, 1)
    return first == second


def describe_symbolic(spec: SymbolicBody) -> str:
    """A line that describes a body with parameters."""
    frame = "mean frame" if spec.frame == "mean" else "modes as given"
    return f"free body in space, {frame}, {spec.modes} modes, shape integrals as parameters"


def _where(given: ModalBody) -> str:
    """A sentence on the position of the origin c."""
    return f"c is where {given.origin} lies in the floating frame." if given.origin else ""


def exact_vector(vector: Array) -> sp.ImmutableMatrix:
    """A vector of doubles as a column of exact numbers."""
    return sp.ImmutableMatrix([sp.Rational(float(x)) for x in vector])


def _point(point: ModalPoint) -> MaterialPoint:
    second = () if point.second is None else tuple(tuple(map(exact_vector, row)) for row in point.second)
    shapes = tuple(map(exact_vector, point.shapes))
    return MaterialPoint(point.name, point.doc, exact_vector(point.position), shapes, second=second)
