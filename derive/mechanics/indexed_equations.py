"""The equations of motion of a body with their sums over the modes kept, from which loops are generated.

The size of these equations does not depend on the number of modes. `expansion` expands the same terms for each mode.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import chain

import sympy as sp

from derive.mechanics import zeros
from derive.mechanics.body import Body
from derive.mechanics.equations import Equations
from derive.mechanics.motion.body_motion import Motion
from derive.mechanics.motion.material_points import indexed_marker
from derive.mechanics.motion.planar import planar_sums
from derive.mechanics.motion.spatial import spatial_sums
from derive.mechanics.sums import (
    ALPHA,
    ALPHADDOT,
    ALPHADOT,
    IndexedSum,
    ModeSum,
    TableSum,
    canonical,
    exchanged,
    of_index,
)
from derive.mechanics.symbols import Family, I, J, Symbol, amplitude, is_indexed, quantity
from derive.mechanics.tables import CoefficientTable, TableKind, point_tables
from derive.mechanics.terms import Coordinate, EquationOfMotion, Reason, Term
from derive.mechanics.virtual_work_equations import (
    SHAPE_ROW,
    generic_weight,
    gravity_definitions,
    rigid_weight,
    weight_energy,
)
from derive.roles import Source
from derive.spec.model.body import Lowering

ELASTIC, DAMPING_FORCE = (quantity(family, shapes=(I,)) for family in (Family.ELASTIC, Family.DAMPING_FORCE))
STRAIN = quantity(Family.STRAIN)
ELASTIC_SUMS = (
    IndexedSum(ELASTIC, None, ((ALPHA, quantity(Family.STIFFNESS, shapes=(I, J))),), "gradient of the strain energy"),
    IndexedSum(STRAIN, None, ((ALPHA, quantity(Family.ELASTIC, shapes=(J,))),), "twice the strain energy"),
)
PRELOAD_WORK = quantity(Family.PRELOAD_WORK)
PRELOAD_SUM = IndexedSum(
    PRELOAD_WORK, None, ((ALPHA, quantity(Family.PRELOAD, shapes=(J,))),), "work of forces at rest"
)
DAMPING_SUMS = (
    IndexedSum(DAMPING_FORCE, None, ((ALPHADOT, quantity(Family.DAMPING, shapes=(I, J))),), "damping force"),
)
ROTARY, ROTARY_RATE = (quantity(Family.ROTARY_MOMENT, shapes=(I,), derivative=d) for d in (2, 1))
ROTARY_PRODUCT = quantity(Family.ROTARY_PRODUCT)
_R = quantity(Family.ROTARY, shapes=(I, J))
ROTARY_SUMS = (
    IndexedSum(ROTARY, None, ((ALPHADDOT, _R),), "moment of the rotary inertia"),
    IndexedSum(ROTARY_RATE, None, ((ALPHADOT, _R),), "momentum of the rotary inertia"),
    IndexedSum(
        ROTARY_PRODUCT,
        None,
        ((ALPHADOT, quantity(Family.ROTARY_MOMENT, shapes=(J,), derivative=1)),),
        "twice the energy of the rotary inertia",
    ),
)
ROTARY_TERM = Term(SHAPE_ROW, "rotary", "(10)", ROTARY)
ELASTIC_TERM = Term(SHAPE_ROW, "elastic", "(13), (22)", ELASTIC)
PRELOAD_TERM = Term(SHAPE_ROW, "preload", Source.STRETCHING, quantity(Family.PRELOAD, shapes=(I,)))
DAMPING_TERM = Term(SHAPE_ROW, "damping", "(13)", DAMPING_FORCE)


def derive_body(body: Body, lowering: Lowering = "auto") -> Equations:
    """The equations of motion of a body in the indexed form: the rigid rows, and a row for a generic mode.

    `lowering` is the choice of the specification: auto, flat or table.
    """
    motion, planar = body.rigid_motion, body.dimension == 2
    coefficients = (body.mass_constant, *body.gravity)
    families = {table.family for table in body.tables}
    definitions = (*motion.rotation_definitions, *motion.named, *gravity_definitions(motion, body.gravity))
    kept, reasons = zeros.drop_definitions(definitions, zeros.reasons_of(coefficients))
    sums = _Sums({t.family: t for t in body.tables}, {**reasons, **_zero_entries(body.tables)})
    indexed_sums = tuple(chain(*(planar_sums if planar else spatial_sums)(body.truncated)))
    forces: tuple[Term, ...] = ()
    kinetic = body.kinetic_energy
    if Family.ROTARY in families:
        indexed_sums, forces = (*indexed_sums, *ROTARY_SUMS), (ROTARY_TERM,)
        kinetic += ROTARY_PRODUCT / 2
    if Family.STIFFNESS in families:
        indexed_sums, forces = (*indexed_sums, *ELASTIC_SUMS[:1]), (*forces, ELASTIC_TERM)
    if Family.DAMPING in families:
        indexed_sums, forces = (*indexed_sums, *DAMPING_SUMS), (*forces, DAMPING_TERM)
    if Family.STIFFNESS in families:
        indexed_sums = (*indexed_sums, *ELASTIC_SUMS[1:])
    strain = STRAIN / 2 if Family.STIFFNESS in families else sp.S.Zero
    if Family.PRELOAD in families:
        indexed_sums, forces, strain = (*indexed_sums, PRELOAD_SUM), (*forces, PRELOAD_TERM), strain + PRELOAD_WORK
    for indexed_sum in indexed_sums:
        sums.add(indexed_sum)
    complete = (*body.rigid_inertia, *(body.generic_inertia if body.modes or not planar else ()), *forces)
    if body.gravity:
        complete += (*rigid_weight(motion), *generic_weight(motion))
    terms, vanished = zeros.drop_terms(complete, sums.reasons)

    def settled(expr: sp.Expr) -> sp.Expr:
        return sp.expand(zeros.drop(expr, sums.reasons).xreplace(sums.inlined))

    numbered = range(1, body.modes + 1)
    points = (indexed_marker(motion, k, point, bool(body.modes)) for k, point in enumerate(body.points, 1))
    of_points = (
        table
        for k, point in enumerate(body.points, 1)
        for table in point_tables(k, point.name, body.dimension, bool(point.second))
    )
    return Equations(
        name=body.name,
        doc=body.doc,
        frame_doc=body.frame_doc,
        coordinates=motion.coordinates
        + tuple(Coordinate(amplitude(i), f"amplitude of assumed mode {i}", "m") for i in numbered),
        rows=(*motion.rows, *((_shape_row(),) if body.modes else ())),
        rates=(*motion.rates, *((amplitude(I, 1),) if body.modes else ())),
        parameters=body.parameters,
        coefficients=coefficients,
        definitions=kept,
        terms=tuple(replace(t, expr=settled(t.expr)) for t in terms),
        vanished=tuple(v if v.reason else replace(v, reason=_identity(motion, v.term)) for v in vanished),
        mass=sp.ImmutableMatrix(0, 0, []),
        mass_zeros=(),
        kinetic_energy=settled(kinetic),
        strain_energy=settled(strain),
        weight_energy=settled(weight_energy(motion)) if body.gravity else None,
        linear_momentum=tuple(settled(p) for p in body.linear_momentum),
        angular_momentum=tuple(settled(p) for p in body.angular_momentum),
        markers=tuple(points),
        tables=(*body.tables, *of_points),
        table_sums=tuple(sums.table_sums),
        mode_sums=tuple(sums.mode_sums),
        body=body,
        lowering=lowering,
    )


def _identity(motion: Motion, term: Term) -> Reason:
    """The reason of a term that vanishes in every body."""
    return Reason(identity=motion.identities.get((term.row, term.name), ""))


def _shape_row() -> EquationOfMotion:
    """The row of a generic shape."""
    return EquationOfMotion(SHAPE_ROW, amplitude(I, 1), amplitude(I, 2), "rate of alpha_i", "m/s", "N")


def _zero_entries(tables: tuple[CoefficientTable, ...]) -> zeros.Reasons:
    """The entries of tables that vanish for every shape, with their reasons."""
    reasons: zeros.Reasons = {}
    for t in tables:
        vanishing = dict(t.zeros)
        for component, entry in zip(t.components, t.generic_entries, strict=True):
            if component in vanishing:
                reasons[entry] = ((t.symbol, vanishing[component]),)
    return reasons


class _Sums:
    """The sums of a body, sorted into those that loops compute, those that are inlined, and those that vanish."""

    def __init__(self, tables: Mapping[Family, CoefficientTable], reasons: zeros.Reasons) -> None:
        self.tables = tables
        self.reasons = reasons
        self.table_sums: list[TableSum] = []
        self.mode_sums: list[ModeSum] = []
        self.inlined: dict[sp.Symbol, sp.Expr] = {}

    def add(self, indexed_sum: IndexedSum) -> None:
        """Add a sum; the sums that it refers to have been added before."""
        behind: list[tuple[sp.Symbol, str]] = []
        offset = self._entry(indexed_sum.offset, behind) if indexed_sum.offset else sp.S.Zero
        sums: list[tuple[sp.Expr, Symbol]] = []
        for factor, entry in indexed_sum.sums:
            own = of_index(factor, I, J)
            if not indexed_sum.indexed:
                offset += own * self._entry(exchanged(entry, {J: I}), behind)
            elif self._kind(entry, behind) is TableKind.FULL:
                sums.append((factor, entry))
            elif self._kind(entry, []) is TableKind.DIAGONAL:
                offset += own * quantity(entry.identity.family, *entry.identity.components, shapes=(I,))
            elif self._kind(entry, []) is TableKind.UNIT:
                offset += own
        if not indexed_sum.indexed:
            self._scalar(indexed_sum, sp.expand(offset), behind)
        elif sums:
            doc = indexed_sum.doc.format(i="i")
            self.table_sums.append(TableSum(indexed_sum.symbol, offset, tuple(sums), doc, indexed_sum.source))
        elif offset != 0:
            self.inlined[indexed_sum.symbol] = offset
        else:
            self.reasons[indexed_sum.symbol] = tuple(dict.fromkeys(behind))

    def _scalar(self, indexed_sum: IndexedSum, expr: sp.Expr, behind: list[tuple[sp.Symbol, str]]) -> None:
        terms = sp.Add.make_args(expr)
        inside = sp.Add(*(t for t in terms if any(is_indexed(s) for s in t.free_symbols)))
        offset = expr - inside
        if inside != 0:
            self.mode_sums.append(
                ModeSum(indexed_sum.symbol, offset, inside, indexed_sum.doc.format(i="i"), indexed_sum.source)
            )
        elif offset != 0:
            self.inlined[indexed_sum.symbol] = offset
        else:
            self.reasons[indexed_sum.symbol] = tuple(dict.fromkeys(behind))

    def _entry(self, symbol: Symbol, behind: list[tuple[sp.Symbol, str]]) -> sp.Expr:
        """The symbol of an integral or of an earlier sum; zero if it vanishes."""
        if symbol in self.reasons:
            behind += self.reasons[symbol]
            return sp.S.Zero
        return self.inlined.get(symbol, symbol)

    def _kind(self, entry: Symbol, behind: list[tuple[sp.Symbol, str]]) -> TableKind:
        if (reason := self.reasons.get(canonical(entry))) is not None:
            behind += reason
            return TableKind.ZERO
        return self.tables[entry.identity.family].kind
