"""The tables of a body in space: shape integrals, stiffness and damping, with their zeros, reasons and numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from derive.mechanics.axes import PAIRS
from derive.mechanics.symbols import Family
from derive.mechanics.tables import NO_SHAPES, ODD, SCALARS, TENSORS, CoefficientTable, TableKind, entries
from derive.mechanics.zero_reasons import AT_CENTRE, CONDITION_17, CONDITION_19, EXACT_SUM, ORTHONORMAL, UNDAMPED
from derive.spec.model.body import SymbolicBody

if TYPE_CHECKING:
    from derive.mechanics.bodies.modal_body import ModalBody

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
"""The descriptions and units of all tables of a body of first order, in the order of the parameters."""

SECOND_ORDER_DOCS = DOCS | {
    Family.C5: ("symmetric part of int rho ((Phi_i . Phi_j + X . Psi_ij) I - Phi_i Phi_j - X Psi_ij)", "kg"),
    Family.C9: ("int rho Psi_ij", "kg/m"),
    Family.C10: ("int rho X x Psi_ij", "kg"),
}
"""The descriptions and units of all tables of a body of second order."""


MEAN = {
    Family.C1: AT_CENTRE,
    Family.C2: CONDITION_17,
    Family.C6: CONDITION_19,
    Family.C8: ORTHONORMAL,
    Family.STIFFNESS: "orthogonality (modes orthonormal in the mass and the stiffness)",
    Family.DAMPING: "orthogonality (damping of each mode alone)",
}
"""The reasons why integrals vanish in the mean frame; of c8, K and B the entries off the diagonal."""


def symbolic_tables(spec: SymbolicBody) -> tuple[CoefficientTable, ...]:
    """The tables of a body with parameters, whose zeros depend on its frame."""
    kinds: dict[Family, tuple[TableKind, str]] = {}
    if spec.frame == "mean":
        kinds |= {family: (TableKind.ZERO, MEAN[family]) for family in (Family.C1, Family.C2, Family.C6)}
        kinds[Family.C8] = TableKind.UNIT, MEAN[Family.C8]
        kinds |= {family: (TableKind.DIAGONAL, MEAN[family]) for family in (Family.STIFFNESS, Family.DAMPING)}
    if not spec.damping:
        kinds[Family.DAMPING] = (TableKind.ZERO, UNDAMPED)
    return _tables(spec.modes, kinds)


def modal_tables(given: ModalBody) -> tuple[CoefficientTable, ...]:
    """The tables of a body of numbers; tables of zeros are marked as such, and c8, K and B may be diagonal."""
    kinds: dict[Family, tuple[TableKind, str]] = {}
    docs = SECOND_ORDER_DOCS if given.second_order else DOCS
    values = {family: table_values(given, full_table(family)) for family in docs}
    for family in SCALARS:
        matrix = _matrix(given, family)
        if not np.count_nonzero(matrix - np.diag(np.diag(matrix))):
            unit = family is Family.C8 and bool(np.all(np.diag(matrix) == 1))
            kinds[family] = TableKind.UNIT if unit else TableKind.DIAGONAL, _reason(given, family)
    kinds |= {family: (TableKind.ZERO, _reason(given, family)) for family, v in values.items() if not np.any(v)}
    return _tables(given.modes, kinds, docs)


def rigid_tables(at_centre: str) -> tuple[CoefficientTable, ...]:
    """The tables of a rigid body; at_centre: the reason why c1 vanishes, empty if it does not."""
    return _tables(0, {Family.C1: (TableKind.ZERO, at_centre)} if at_centre else {})


def full_table(family: Family) -> CoefficientTable:
    """The table of a family with all of its entries."""
    return CoefficientTable(family, TableKind.FULL, *SECOND_ORDER_DOCS[family])


def _tables(
    n: int, kinds: dict[Family, tuple[TableKind, str]], docs: Mapping[Family, tuple[str, str]] = DOCS
) -> tuple[CoefficientTable, ...]:
    tables = []
    for family, (doc, unit) in docs.items():
        table = CoefficientTable(family, TableKind.FULL, doc, unit)
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


def table_values(given: ModalBody, table: CoefficientTable) -> Array:
    """The entries of a table, in the order of `entries`."""
    n, family = given.modes, table.family
    if table.point:
        point = given.points[int(table.point) - 1]
        if family is Family.POINT_SECOND:
            assert point.second is not None
            return np.asarray(point.second[np.triu_indices(n)]).ravel()
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
    if family in (Family.C9, Family.C10):
        of_second_order = given.c9 if family is Family.C9 else given.c10
        assert of_second_order is not None
        return np.asarray(of_second_order[np.triu_indices(n)]).ravel()
    vectors: dict[Family, Array] = {Family.C1: given.c1, Family.C2: given.c2, Family.C6: given.c6}
    return vectors[family].ravel()


def kept_entries(table: CoefficientTable, n: int, values: Array) -> Array:
    """The entries that a table has, of all its entries in the order of `entries`."""
    if table.kind is TableKind.DIAGONAL:
        rows, columns = np.triu_indices(n)
        diagonal: Array = values[rows == columns]
        return diagonal
    return values if table.kind is TableKind.FULL else values[:0]


def _reason(given: ModalBody, family: Family) -> str:
    """The reason that a table vanishes (off its diagonal): the reason of its first zero entry in the body."""
    if not given.zeros:
        return EXACT_SUM
    names = (entry.name for entry in entries(full_table(family), given.modes))
    return next((given.zeros[name] for name in names if name in given.zeros), EXACT_SUM)
