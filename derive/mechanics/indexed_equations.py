"""The equations of motion of a body in space for a generic shape i: sums over the shapes stay sums.

`body.equations` writes the same derivation out for each shape; here it is kept as it is, so that loops come out of it
and its size does not depend on the number of shapes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import sympy as sp

from derive.mechanics import points as at_point
from derive.mechanics import virtual_work_equations as body
from derive.mechanics import zeros
from derive.mechanics.equations import Coefficient, Coordinate, Definition, ParameterSymbol, Reason, Row, Term, Vanished
from derive.mechanics.kinematics import PHI, RDOT, R
from derive.mechanics.motion import MASS, Motion
from derive.mechanics.series import ALPHA, ALPHADOT, Series, exchanged
from derive.mechanics.spatial import AXES, PAIRS, spatial_motion, spatial_series, spatial_sums
from derive.mechanics.symbols import Family, I, Identity, J, ShapeIndex, Symbol, amplitude, is_indexed, quantity, vector

TableKind = Literal["full", "diagonal", "unit", "zero"]

INDICES = {
    Family.C1: 0,
    Family.C3: 0,
    Family.C2: 1,
    Family.C4: 1,
    Family.C6: 1,
    Family.C5: 2,
    Family.C7: 2,
    Family.C8: 2,
    Family.STIFFNESS: 2,
    Family.DAMPING: 2,
    Family.POINT_POSITION: 0,
    Family.POINT_SHAPE: 1,
}
"""How many shape indices the entries of a table are counted by."""

TENSORS, SCALARS = (Family.C3, Family.C4, Family.C5), (Family.C8, Family.STIFFNESS, Family.DAMPING)


@dataclass(frozen=True)
class Table:
    """A shape integral, stiffness K or damping B: which of its entries there are, and why there are not more.

    X and the shapes at a material point are tables as well; `point` is the number of the point.
    """

    family: Family
    kind: TableKind
    doc: str
    unit: str
    zero: str = ""
    point: str = ""

    @property
    def symbol(self) -> Symbol:
        """The table as a whole."""
        return Symbol(Identity(self.family, point=self.point))

    @property
    def name(self) -> str:
        """The printed name of the whole table."""
        return self.symbol.identity.name

    @property
    def counted(self) -> int:
        """How many shape indices an entry has."""
        return INDICES[self.family]

    @property
    def components(self) -> tuple[tuple[int, ...], ...]:
        """The components of an entry: 1 2 3, or 11 12 13 22 23 33; one without indices of a scalar."""
        if self.family in SCALARS:
            return ((),)
        return PAIRS if self.family in TENSORS else tuple((k,) for k in AXES)

    def entry(self, component: tuple[int, ...], *shapes: ShapeIndex) -> Symbol:
        """An entry, or without shapes the array of one component for all shapes."""
        return Symbol(Identity(self.family, shapes, component, point=self.point))

    @property
    def generic_entries(self) -> tuple[Symbol, ...]:
        """The components for generic indices: c2_i_1, c2_i_2, c2_i_3."""
        return tuple(self.entry(component, *(I, J)[: self.counted]) for component in self.components)


ELASTIC, DAMPING_FORCE = (quantity(family, shapes=(I,)) for family in (Family.ELASTIC, Family.DAMPING_FORCE))
STRAIN = quantity(Family.STRAIN)
FORCE_SERIES = (
    Series(ELASTIC, None, ((ALPHA, quantity(Family.STIFFNESS, shapes=(I, J))),), "gradient of the strain energy"),
    Series(DAMPING_FORCE, None, ((ALPHADOT, quantity(Family.DAMPING, shapes=(I, J))),), "damping force"),
    Series(STRAIN, None, ((ALPHA, quantity(Family.ELASTIC, shapes=(J,))),), "twice the strain energy"),
)
FORCES = (
    Term("alpha_i", "elastic", "(13), (22)", ELASTIC),
    Term("alpha_i", "damping", "(13)", DAMPING_FORCE),
)


@dataclass(frozen=True)
class Contraction:
    """symbol_i = base + sum over j of factor_j table_i_j; `sums` are pairs (factor, table entry)."""

    symbol: Symbol
    base: sp.Expr
    sums: tuple[tuple[Symbol, Symbol], ...]
    doc: str


@dataclass(frozen=True)
class Total:
    """symbol = base + sum over i of term, which is an expression of index i."""

    symbol: Symbol
    base: sp.Expr
    term: sp.Expr
    doc: str


@dataclass(frozen=True)
class GenericPoint:
    """A marker for a generic shape: position, velocity, columns of its Jacobian, and the work of a force there.

    `columns` and `load` are those of the rigid motion; `shape` and `shape_load` those of shape i. X and the shapes at
    the point are tables, see `point_tables`; `force` defines the force seen from the body base.
    """

    name: str
    doc: str
    totals: tuple[Total, ...]
    position: tuple[sp.Expr, ...]
    velocity: tuple[sp.Expr, ...]
    columns: tuple[tuple[sp.Expr, ...], ...]
    shape: tuple[sp.Expr, ...]
    force: tuple[Definition, ...]
    load: tuple[sp.Expr, ...]
    shape_load: sp.Expr


@dataclass(frozen=True)
class GenericEquations:
    """The equations of motion of a body with `modes` shapes: rigid rows, and one row for a generic shape i.

    `definitions` are scalars (Q, products of omega, gravity in the body base); `contractions` come before `totals`.
    Expressions are in these names, in `tables`, and in alpha_i, alphadot_i, alphaddot_i. `data` are the values of the
    parameters, for a body given by numbers. `choice` says why there are loops.
    """

    name: str
    doc: str
    origin: str
    modes: int
    coordinates: tuple[Coordinate, ...]
    rows: tuple[Row, ...]
    rates: tuple[sp.Expr, ...]
    parameters: tuple[ParameterSymbol, ...]
    scalars: tuple[Coefficient, ...]
    tables: tuple[Table, ...]
    definitions: tuple[Definition, ...]
    contractions: tuple[Contraction, ...]
    totals: tuple[Total, ...]
    terms: tuple[Term, ...]
    vanished: tuple[Vanished, ...]
    kinetic_energy: sp.Expr
    strain_energy: sp.Expr
    weight_energy: sp.Expr | None
    linear_momentum: tuple[sp.Expr, ...]
    angular_momentum: tuple[sp.Expr, ...]
    points: tuple[GenericPoint, ...]
    data: tuple[float, ...] | None = None
    choice: str = ""

    def table(self, family: Family) -> Table:
        """The table of an integral."""
        return next(t for t in self.tables if t.family is family)

    def reason(self, *families: Family) -> Reason:
        """Why tables vanish."""
        return Reason(tuple((t.symbol, t.zero) for t in map(self.table, families)))

    def sum_of(self, row: str) -> sp.Expr:
        """The left-hand side of one equation of motion; that of a shape has the name alpha_i."""
        return sp.Add(*(t.expr for t in self.terms if t.row == row))

    def _repr_html_(self) -> str:
        """What a notebook shows; the report is imported when one asks."""
        from derive.report.notebook import equations_html

        return equations_html(self)


def generic_equations(
    name: str,
    doc: str,
    origin: str,
    modes: int,
    tables: tuple[Table, ...],
    scalars: tuple[Coefficient, ...],
    parameters: tuple[ParameterSymbol, ...],
    points: tuple[tuple[str, str], ...] = (),
    data: tuple[float, ...] | None = None,
) -> GenericEquations:
    """The equations of motion of a body with these tables; `scalars` are its mass and, if there is any, gravity.

    `points` are markers, each a name and what it is.
    """
    motion = spatial_motion(0)
    gravity = tuple(c for c in scalars if c.symbol != MASS)
    named = tuple(d for d in motion.definitions if d.section == "oo")
    definitions = (*motion.rotation_definitions, *named, *body.gravity_definitions(motion, gravity))
    kept, reasons = zeros.drop_definitions(definitions, zeros.reasons_of(scalars))
    sums = _Sums({t.family: t for t in tables if not t.point}, {**reasons, **_zero_entries(tables)})
    for series in (*spatial_series(), *spatial_sums(), *FORCE_SERIES):
        sums.add(series)
    complete = (*body.rigid_inertia(motion), *body.generic_inertia(motion), *FORCES)
    complete += (*body.rigid_weight(motion), *body.generic_weight(motion)) if gravity else ()
    terms, vanished = zeros.drop_terms(complete, sums.reasons)

    def settled(expr: sp.Expr) -> sp.Expr:
        return sp.expand(zeros.drop(expr, sums.reasons).xreplace(sums.inlined))

    rigid = spatial_motion(0)
    numbered = range(1, modes + 1)
    return GenericEquations(
        name=name,
        doc=doc,
        origin=origin,
        modes=modes,
        coordinates=rigid.coordinates
        + tuple(Coordinate(amplitude(i), f"amplitude of assumed shape {i}", "m") for i in numbered),
        rows=rigid.rows,
        rates=rigid.rates,
        parameters=parameters,
        scalars=scalars,
        tables=tables,
        definitions=kept,
        contractions=tuple(sums.contractions),
        totals=tuple(sums.totals),
        terms=tuple(replace(t, expr=settled(t.expr)) for t in terms),
        vanished=vanished,
        kinetic_energy=settled(body.kinetic_energy(motion)),
        strain_energy=settled(STRAIN / 2),
        weight_energy=settled(body.weight_energy(motion)) if gravity else None,
        linear_momentum=tuple(settled(p) for p in body.linear_momentum(motion)),
        angular_momentum=tuple(settled(p) for p in body.angular_momentum(motion)),
        points=tuple(_point(motion, k, *point, bool(modes)) for k, point in enumerate(points, 1)),
        data=data,
    )


def _zero_entries(tables: tuple[Table, ...]) -> zeros.Reasons:
    """The entries of tables that vanish, for a generic shape, with the reasons."""
    found: zeros.Reasons = {}
    for t in tables:
        if t.kind == "zero":
            found |= dict.fromkeys(t.generic_entries, ((t.symbol, t.zero),))
    return found


def point_tables(number: int, name: str) -> tuple[Table, Table]:
    """X and the shapes at a marker, as tables X1 and Phi1 of the first marker."""
    position = Table(Family.POINT_POSITION, "full", f"X of marker {name}", "m", point=str(number))
    return position, Table(Family.POINT_SHAPE, "full", f"the shapes at marker {name}", "", point=str(number))


def _point(motion: Motion, number: int, name: str, doc: str, deforms: bool) -> GenericPoint:
    """A marker, from the same fields taken at that point."""
    x, phi = (table.generic_entries for table in point_tables(number, name))
    r, rdot = (vector(Family.RADIUS, len(AXES), derivative=d) for d in (0, 1))
    totals = []
    for k, place, shape in zip(AXES, x, phi, strict=True):
        if deforms:
            totals.append(Total(r[k - 1], place, amplitude(I) * shape, "X + u at the marker"))
            totals.append(Total(rdot[k - 1], sp.S.Zero, amplitude(I, 1) * shape, "its rate"))
    if not deforms:
        r, rdot = sp.Matrix(x), sp.zeros(3, 1)
    at = {R: r, RDOT: rdot, PHI: sp.Matrix(phi)}
    displacements = (*motion.translations, *motion.frame.rotations())
    return GenericPoint(
        name=name,
        doc=doc,
        totals=tuple(totals),
        position=tuple(at_point.vector_at(motion, motion.position, at)),
        velocity=tuple(at_point.vector_at(motion, motion.velocity, at)),
        columns=tuple(tuple(at_point.vector_at(motion, d, at)) for d in displacements),
        shape=tuple(at_point.vector_at(motion, motion.frame.deformation(), at)),
        force=at_point.force_definitions(motion),
        load=tuple(at_point.work_at(motion, d, at) for d in displacements),
        shape_load=at_point.work_at(motion, motion.frame.deformation(), at),
    )


class _Sums:
    """Series sorted into what is summed by loops, what is written where it is used, and what vanishes."""

    def __init__(self, tables: Mapping[Family, Table], reasons: zeros.Reasons) -> None:
        self.tables = tables
        self.reasons = reasons
        self.contractions: list[Contraction] = []
        self.totals: list[Total] = []
        self.inlined: dict[sp.Symbol, sp.Expr] = {}

    def add(self, series: Series) -> None:
        """Sort one series in; those that it is made of came before."""
        behind: list[tuple[sp.Symbol, str]] = []
        base = self._entry(series.base, behind) if series.base else sp.S.Zero
        sums: list[tuple[Symbol, Symbol]] = []
        for factor, entry in series.sums:
            own = exchanged(factor, {J: I})
            if not series.indexed:
                base += own * self._entry(exchanged(entry, {J: I}), behind)
            elif self._kind(entry, behind) == "full":
                sums.append((factor, entry))
            elif self._kind(entry, []) == "diagonal":
                base += own * quantity(entry.identity.family, shapes=(I,))
            elif self._kind(entry, []) == "unit":
                base += own
        if not series.indexed:
            self._scalar(series, sp.expand(base), behind)
        elif sums:
            self.contractions.append(Contraction(series.symbol, base, tuple(sums), series.doc.format(i="i")))
        elif base != 0:
            self.inlined[series.symbol] = base
        else:
            self.reasons[series.symbol] = tuple(dict.fromkeys(behind))

    def _scalar(self, series: Series, expr: sp.Expr, behind: list[tuple[sp.Symbol, str]]) -> None:
        terms = sp.Add.make_args(expr)
        inside = sp.Add(*(t for t in terms if any(is_indexed(s) for s in t.free_symbols)))
        base = expr - inside
        if inside != 0:
            self.totals.append(Total(series.symbol, base, inside, series.doc.format(i="i")))
        elif base != 0:
            self.inlined[series.symbol] = base
        else:
            self.reasons[series.symbol] = tuple(dict.fromkeys(behind))

    def _entry(self, symbol: Symbol, behind: list[tuple[sp.Symbol, str]]) -> sp.Expr:
        """An integral or an earlier series, zero if it vanishes."""
        if symbol in self.reasons:
            behind += self.reasons[symbol]
            return sp.S.Zero
        if symbol.identity.family in self.tables and self._kind(symbol, behind) == "zero":
            return sp.S.Zero
        return self.inlined.get(symbol, symbol)

    def _kind(self, entry: Symbol, behind: list[tuple[sp.Symbol, str]]) -> TableKind:
        table = self.tables[entry.identity.family]
        if table.kind == "zero":
            behind.append((table.symbol, table.zero))
        return table.kind
