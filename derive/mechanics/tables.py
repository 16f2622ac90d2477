"""Tables of coefficients with mode indices: shape integrals, stiffness and damping, with their structural zeros."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from itertools import product
from typing import TYPE_CHECKING

from derive.mechanics.axes import AXES, PAIRS
from derive.mechanics.sums import PARITY, signed_entry
from derive.mechanics.symbols import Family, I, Identity, J, ShapeIndex

if TYPE_CHECKING:
    from derive.mechanics.terms import ModelConstant
    from derive.mechanics.typed_symbol import Symbol

INDICES = {
    Family.C1: 0,
    Family.C3: 0,
    Family.C2: 1,
    Family.C4: 1,
    Family.C6: 1,
    Family.C5: 2,
    Family.C7: 2,
    Family.C8: 2,
    Family.C9: 2,
    Family.C10: 2,
    Family.FIELD_WEIGHT: 3,
    Family.STIFFNESS: 2,
    Family.CUBIC_STIFFNESS: 3,
    Family.PRELOAD: 1,
    Family.DAMPING: 2,
    Family.ROTARY: 2,
    Family.POINT_POSITION: 0,
    Family.POINT_SHAPE: 1,
    Family.POINT_SECOND: 2,
}
"""The number of mode indices of an entry, by the family of its table."""

TENSORS, SCALARS = (Family.C3, Family.C4, Family.C5), (Family.C8, Family.STIFFNESS, Family.DAMPING)
VECTORS = (Family.C1, Family.C2, Family.C9, Family.POINT_POSITION, Family.POINT_SHAPE, Family.POINT_SECOND)


NO_SHAPES = "the number of shapes (there is none)"
ODD = "c7 is odd in its indices (one shape does not act on itself)"


class TableKind(Enum):
    """The sparsity of a table: which of its entries are not structurally zero."""

    FULL = "full"
    DIAGONAL = "diagonal"
    UNIT = "unit"
    ZERO = "zero"


@dataclass(frozen=True)
class CoefficientTable:
    """A family of constant coefficients: a shape integral, stiffness K or damping B, with the reasons of its zeros.

    X and the shapes at a material point are tables as well; `point` is the number of the point. In the plane
    (`dimension` 2) tensors and the third components of vectors are scalars. `vanishing` are components that vanish for
    all shapes, each with its reason.
    """

    family: Family
    kind: TableKind
    doc: str
    unit: str
    zero: str = ""
    point: str = ""
    dimension: int = 3
    vanishing: tuple[tuple[tuple[int, ...], str], ...] = ()

    @property
    def symbol(self) -> Symbol:
        """The symbol of the table as a whole."""
        return Identity(self.family, point=self.point).symbol

    @property
    def name(self) -> str:
        """The printed name of the whole table."""
        return Identity(self.family, point=self.point).name

    @property
    def counted(self) -> int:
        """The number of mode indices of an entry."""
        return INDICES[self.family]

    @property
    def components(self) -> tuple[tuple[int, ...], ...]:
        """The components of an entry: 1 2 3, or 11 12 13 22 23 33; a single empty one for a scalar."""
        if self.dimension == 2:
            return ((1,), (2,)) if self.family in VECTORS else ((),)
        if self.family in (*SCALARS, Family.CUBIC_STIFFNESS, Family.PRELOAD, Family.FIELD_WEIGHT):
            return ((),)
        return PAIRS if self.family in TENSORS else tuple((k,) for k in AXES)

    def entry(self, component: tuple[int, ...], *shapes: ShapeIndex) -> Symbol:
        """An entry for given modes, or without modes the array of a component for all modes."""
        return Identity(self.family, shapes, component, point=self.point).symbol

    @property
    def generic_entries(self) -> tuple[Symbol, ...]:
        """The components for generic indices: c2_i_1, c2_i_2, c2_i_3."""
        return tuple(self.entry(component, *(I, J)[: self.counted]) for component in self.components)

    @property
    def zeros(self) -> tuple[tuple[tuple[int, ...], str], ...]:
        """The components that vanish, with their reasons."""
        if self.kind is TableKind.ZERO:
            return tuple((component, self.zero) for component in self.components)
        return self.vanishing


def entries(table: CoefficientTable, n: int) -> Iterator[Symbol]:
    """The entries of a table for n modes, by rows with i <= j (i < j in an odd table): C5_1_2_11."""
    shapes = range(1, n + 1)
    odd = PARITY.get(table.family, 1) < 0
    counted: tuple[list[tuple[int, ...]], ...] = (
        [()],
        [(i,) for i in shapes],
        [(i, j) for i in shapes for j in shapes if i < j or (i == j and not odd)],
    )
    for numbers, generic in product(counted[table.counted], table.generic_entries):
        _, entry = signed_entry(generic, *numbers)
        yield entry


def point_tables(
    number: int, name: str, dimension: int = 3, second_order: bool = False
) -> tuple[CoefficientTable, ...]:
    """X and the shapes at a marker, as tables X1 and Phi1 of the first marker; at second order Psi1 as well."""
    point = str(number)
    position, shapes = f"X of marker {name}", f"the shapes at marker {name}"
    first = (
        CoefficientTable(Family.POINT_POSITION, TableKind.FULL, position, "m", point=point, dimension=dimension),
        CoefficientTable(Family.POINT_SHAPE, TableKind.FULL, shapes, "", point=point, dimension=dimension),
    )
    if not second_order:
        return first
    second = f"the Psi_ij at marker {name}"
    return (
        *first,
        CoefficientTable(Family.POINT_SECOND, TableKind.FULL, second, "1/m", point=point, dimension=dimension),
    )


PLANAR_DOCS = {
    Family.C1: ("int rho X", "kg m"),
    Family.C2: ("int rho Phi_i", "kg"),
    Family.C3: ("int rho X . X", "kg m^2"),
    Family.C4: ("int rho X . Phi_i", "kg m"),
    Family.C6: ("int rho X x Phi_i", "kg m"),
    Family.C7: ("int rho Phi_i x Phi_j", "kg"),
    Family.C8: ("int rho Phi_i . Phi_j", "kg"),
    Family.C5: ("int rho (Phi_i . Phi_j + X . Psi_ij)", "kg"),
    Family.C9: ("int rho Psi_ij", "kg/m"),
    Family.C10: ("int rho X x Psi_ij", "kg"),
    Family.FIELD_WEIGHT: ("part of theta_p in Psi_ij", "1/m"),
    Family.STIFFNESS: ("stiffness", "N/m"),
    Family.PRELOAD: ("work of the axial force at rest", "N"),
    Family.DAMPING: ("damping", "N s/m"),
    Family.ROTARY: ("rotary inertia of attached masses", "kg"),
}
"""The tables of a planar body with their descriptions and units. C5 is a table of its own at second order alone."""

OPTIONAL = (
    Family.C5,
    Family.C9,
    Family.C10,
    Family.FIELD_WEIGHT,
    Family.CUBIC_STIFFNESS,
    Family.PRELOAD,
    Family.DAMPING,
    Family.ROTARY,
)
"""Tables that not every body has."""


def exact_tables(
    constants: Sequence[ModelConstant], docs: Mapping[Family, tuple[str, str]], dimension: int
) -> tuple[CoefficientTable, ...]:
    """The tables that exact constants of a body make up: those that vanish, are diagonal, or full.

    docs: the descriptions and units of the tables, in their order.
    """
    tables = []
    for family, (doc, unit) in docs.items():
        of_family = [c for c in constants if c.symbol.identity.family is family]
        full = CoefficientTable(family, TableKind.FULL, doc, unit, dimension=dimension)
        if of_family:
            tables.append(_table_of(full, of_family))
        elif INDICES[family] and family not in OPTIONAL:
            deforms = any(INDICES[c.symbol.identity.family] for c in constants)
            tables.append(replace(full, kind=TableKind.ZERO, zero=ODD if deforms else NO_SHAPES))
    return tuple(tables)


def _table_of(full: CoefficientTable, constants: Sequence[ModelConstant]) -> CoefficientTable:
    reasons = {component: _reason(constants, component) for component in full.components}
    vanishing = tuple((component, reason) for component, reason in reasons.items() if reason)
    kind, zero = TableKind.FULL, ""
    if len(vanishing) == len(full.components):
        kind, zero = TableKind.ZERO, vanishing[0][1]
    elif full.counted == 2 and (off := [c for c in constants if len(set(c.symbol.identity.shapes)) == 2]):
        if all(c.zero for c in off):
            kind, zero = TableKind.DIAGONAL, str(off[0].zero)
    elif full.counted == 2:
        kind = TableKind.DIAGONAL
    return replace(full, kind=kind, zero=zero, vanishing=() if kind is TableKind.ZERO else vanishing)


def _reason(constants: Iterable[ModelConstant], component: tuple[int, ...]) -> str:
    """The reason why a component vanishes for all shapes; empty if it does not vanish."""
    of_component = [c for c in constants if c.symbol.identity.components == component]
    return str(of_component[0].zero) if of_component and all(c.zero for c in of_component) else ""
