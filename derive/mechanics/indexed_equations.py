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
from derive.mechanics.equations import Coefficient, Coordinate, Definition, ParameterSymbol, Row, Term, Vanished
from derive.mechanics.kinematics import PHI, RDOT, R
from derive.mechanics.motion import MASS, Motion
from derive.mechanics.series import ALPHA, ALPHADOT, Series, family
from derive.mechanics.spatial import AXES, PAIRS, spatial_motion, spatial_series, spatial_sums
from derive.roles import Role

Kind = Literal["full", "diagonal", "unit", "zero"]

TENSORS, SCALARS = ("C3", "C4", "C5"), ("c8", "K", "B")

INDICES = {
    "c1": "",
    "C3": "",
    "c2": "i",
    "C4": "i",
    "c6": "i",
    "C5": "ij",
    "c7": "ij",
    "c8": "ij",
    "K": "ij",
    "B": "ij",
}

FORCE_SERIES = (
    Series("elastic_i", None, ((ALPHA, "K_i_j"),), "gradient of the strain energy"),
    Series("damping_i", None, ((ALPHADOT, "B_i_j"),), "damping force"),
    Series("strain", None, ((ALPHA, "elastic_j"),), "twice the strain energy"),
)
STRAIN = sp.Symbol("strain")
FORCES = (
    Term("alpha_i", "elastic", "(13), (22)", sp.Symbol("elastic_i")),
    Term("alpha_i", "damping", "(13)", sp.Symbol("damping_i")),
)


@dataclass(frozen=True)
class Table:
    """A shape integral, stiffness K or damping B: which of its entries there are, and why there are not more."""

    name: str
    kind: Kind
    doc: str
    unit: str
    zero: str = ""


@dataclass(frozen=True)
class Contraction:
    """name_i = base + sum over j of factor_j table_i_j; `sums` are pairs (factor, table entry)."""

    name: str
    base: sp.Expr
    sums: tuple[tuple[str, str], ...]
    doc: str


@dataclass(frozen=True)
class Total:
    """name = base + sum over i of term, which is an expression of index i."""

    name: str
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

    def table(self, name: str) -> Table:
        """The table of that name."""
        return next(t for t in self.tables if t.name == name)

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
    sums = _Sums({t.name: t for t in tables}, {**reasons, **_zero_entries(tables)})
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
        + tuple(
            Coordinate(sp.Symbol(f"{ALPHA}{i}"), f"amplitude of assumed shape {i}", "m", Role.AMPLITUDE)
            for i in numbered
        ),
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
            found |= dict.fromkeys(entries(t.name), ((t.name, t.zero),))
    return found


def entries(name: str) -> tuple[sp.Symbol, ...]:
    """The components of an integral for generic indices: c2_i_1, c2_i_2, c2_i_3."""
    return tuple(sp.Symbol("_".join([name, *indices(name), *([label] if label else [])])) for label in labels(name))


def indices(table: str) -> str:
    """What the entries of a table are counted by: nothing, a shape i, or a pair of shapes ij."""
    if table.startswith(("X", "Phi")):
        return "i" if table.startswith("Phi") else ""
    return INDICES[table]


def labels(table: str) -> tuple[str, ...]:
    """The components of a table as names have them: 1 2 3, or 11 12 13 22 23 33; one empty label if it has none."""
    if table in SCALARS:
        return ("",)
    return tuple(f"{a}{b}" for a, b in PAIRS) if table in TENSORS else tuple(map(str, AXES))


def point_tables(number: int, name: str) -> tuple[Table, Table]:
    """X and the shapes at a marker, as tables X1 and Phi1 of the first marker."""
    position = Table(f"X{number}", "full", f"X of marker {name}", "m")
    return position, Table(f"Phi{number}", "full", f"the shapes at marker {name}", "")


def _point(motion: Motion, number: int, name: str, doc: str, deforms: bool) -> GenericPoint:
    """A marker, from the same fields taken at that point."""
    x, phi = ([sp.Symbol(f"{table}_{k}") for k in AXES] for table in (f"X{number}", f"Phi{number}_i"))
    totals = []
    for k, place, shape in zip(AXES, x, phi, strict=True):
        if deforms:
            totals.append(Total(f"r_{k}", place, sp.Symbol("alpha_i") * shape, f"X + u at the marker . e{k}"))
            totals.append(Total(f"rdot_{k}", sp.S.Zero, sp.Symbol("alphadot_i") * shape, f"its rate . e{k}"))
    r = sp.Matrix([sp.Symbol(f"r_{k}") for k in AXES]) if deforms else sp.Matrix(x)
    rdot = sp.Matrix([sp.Symbol(f"rdot_{k}") for k in AXES]) if deforms else sp.zeros(3, 1)
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

    def __init__(self, tables: Mapping[str, Table], reasons: zeros.Reasons) -> None:
        self.tables = tables
        self.reasons = reasons
        self.contractions: list[Contraction] = []
        self.totals: list[Total] = []
        self.inlined: dict[sp.Symbol, sp.Expr] = {}

    def add(self, series: Series) -> None:
        """Sort one series in; those that it is made of came before."""
        behind: list[tuple[str, str]] = []
        base = self._entry(series.base, behind) if series.base else sp.S.Zero
        sums: list[tuple[str, str]] = []
        for factor, entry in series.sums:
            own = sp.Symbol(f"{factor}_i")
            if not series.indexed:
                base += own * self._entry(_of_i(entry), behind)
            elif self._kind(entry, behind) == "full":
                sums.append((factor, entry))
            elif self._kind(entry, []) == "diagonal":
                base += own * sp.Symbol(f"{family(entry)}_i")
            elif self._kind(entry, []) == "unit":
                base += own
        symbol = sp.Symbol(series.name)
        if not series.indexed:
            self._scalar(series, sp.expand(base), behind)
        elif sums:
            self.contractions.append(Contraction(series.name, base, tuple(sums), series.doc))
        elif base != 0:
            self.inlined[symbol] = base
        else:
            self.reasons[symbol] = tuple(dict.fromkeys(behind))

    def _scalar(self, series: Series, expr: sp.Expr, behind: list[tuple[str, str]]) -> None:
        terms = sp.Add.make_args(expr)
        inside = sp.Add(*(t for t in terms if any(is_indexed(s) for s in t.free_symbols)))
        base = expr - inside
        if inside != 0:
            self.totals.append(Total(series.name, base, inside, series.doc))
        elif base != 0:
            self.inlined[sp.Symbol(series.name)] = base
        else:
            self.reasons[sp.Symbol(series.name)] = tuple(dict.fromkeys(behind))

    def _entry(self, name: str, behind: list[tuple[str, str]]) -> sp.Expr:
        """An integral or an earlier series, zero if it vanishes."""
        symbol = sp.Symbol(name)
        if symbol in self.reasons:
            behind += self.reasons[symbol]
            return sp.S.Zero
        if family(name) in self.tables and self._kind(name, behind) == "zero":
            return sp.S.Zero
        return self.inlined.get(symbol, symbol)

    def _kind(self, name: str, behind: list[tuple[str, str]]) -> Kind:
        table = self.tables[family(name)]
        if table.kind == "zero":
            behind.append((table.name, table.zero))
        return table.kind


def is_indexed(symbol: sp.Symbol) -> bool:
    """Whether there is one for each shape i."""
    return "i" in symbol.name.split("_")


def _of_i(name: str) -> str:
    return "_".join("i" if part == "j" else part for part in name.split("_"))
