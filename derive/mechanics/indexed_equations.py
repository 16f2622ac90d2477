"""The equations of motion of a body with their sums over the modes kept, from which loops are generated.

The size of these equations does not depend on the number of modes. `expansion` expands the same terms for each mode.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics import zeros
from derive.mechanics.equations import Equations
from derive.mechanics.expansion import expand
from derive.mechanics.generic_forces import SHAPE_ROW, generic_forces
from derive.mechanics.motion.material_points import indexed_marker
from derive.mechanics.sums import IndexedSum, ModeSum, TableSum, canonical, exchanged, of_index
from derive.mechanics.symbols import Family, I, J, amplitude, is_indexed, quantity
from derive.mechanics.tables import CoefficientTable, TableKind, point_tables
from derive.mechanics.terms import EquationOfMotion, Reason, Term
from derive.spec.model.body import Lowering

if TYPE_CHECKING:
    from derive.mechanics.body import Body
    from derive.mechanics.motion.body_motion import Motion
    from derive.mechanics.typed_symbol import Symbol


@dataclass(frozen=True, repr=False)
class IndexedEquations(Equations):
    """The equations of motion of a body with their sums over the modes kept, and a row for a generic mode alpha_i.

    Expressions are in `definitions` (scalars), in `tables`, in `table_sums`, in `mode_sums` made of these, and in the
    alpha_i. `lowering` is what the specification of the body asks of the lowering.
    """

    body: Body = field(kw_only=True)
    tables: tuple[CoefficientTable, ...] = ()
    table_sums: tuple[TableSum, ...] = ()
    mode_sums: tuple[ModeSum, ...] = ()
    lowering: Lowering = "auto"

    def expanded(self) -> Equations:
        """Return the equations with all sums over the modes expanded, and one row for each mode."""
        return self._expanded

    @cached_property
    def _expanded(self) -> Equations:
        return expand(self.body)

    def table(self, family: Family) -> CoefficientTable:
        """The table of a family of integrals; StopIteration if the equations have none."""
        return next(t for t in self.tables if t.family is family)

    def reason(self, *families: Family) -> Reason:
        """The reason why a quantity vanishes: the tables of these families are zero."""
        return Reason(tuple((t.symbol, t.zero) for t in map(self.table, families)))

    def _sums(self) -> list[tuple[str, sp.Expr | str]]:
        result: list[tuple[str, sp.Expr | str]] = []
        for c in self.table_sums:
            products = " + ".join(f"sum_j {factor}*{entry}" for factor, entry in c.sums)
            result.append((c.symbol.name, f"{c.offset} + {products}" if c.offset != 0 else products))
        for s in self.mode_sums:
            result.append((s.symbol.name, f"{s.offset} + sum_i ({s.term})" if s.offset != 0 else f"sum_i ({s.term})"))
        return result


def derive_body(body: Body, lowering: Lowering = "auto") -> IndexedEquations:
    """The equations of motion of a body in the indexed form: the rigid rows, and a row for a generic mode.

    `lowering` is the choice of the specification: auto, flat or loops.
    """
    work = body.virtual_work
    motion, forces = work.motion, generic_forces({table.family for table in body.tables})
    coefficients = (body.mass_constant, *body.gravity)
    definitions = (*motion.rotation_definitions, *motion.named, *(work.gravity if body.gravity else ()))
    kept, reasons = zeros.drop_definitions(definitions, zeros.reasons_of(coefficients))
    sums = _Sums({t.family: t for t in body.tables}, {**reasons, **_zero_entries(body.tables)})
    for indexed_sum in chain(motion.moment_sums, motion.row_sums, *(force.sums for force in forces)):
        sums.add(indexed_sum)
    complete = (
        *work.rigid,
        *(work.generic if body.modes or body.dimension == 3 else ()),
        *(force.term for force in forces),
        *((*work.rigid_weight, *work.generic_weight) if body.gravity else ()),
    )
    terms, vanished = zeros.drop_terms(complete, sums.reasons)

    def settled(*exprs: sp.Expr) -> sp.Expr:
        return sp.expand(zeros.drop(sp.Add(*exprs), sums.reasons).xreplace(sums.inlined))

    points = (indexed_marker(motion, k, point, bool(body.modes)) for k, point in enumerate(body.points, 1))
    of_points = (
        table
        for k, point in enumerate(body.points, 1)
        for table in point_tables(k, point.name, body.dimension, bool(point.second))
    )
    return IndexedEquations(
        name=body.name,
        doc=body.doc,
        frame_doc=body.frame_doc,
        coordinates=body.motion.coordinates,
        rows=(*motion.rows, *((_shape_row(),) if body.modes else ())),
        rates=(*motion.rates, *((amplitude(I, 1),) if body.modes else ())),
        parameters=body.parameters,
        coefficients=coefficients,
        definitions=kept,
        terms=tuple(replace(t, expr=settled(t.expr)) for t in terms),
        vanished=tuple(v if v.reason else replace(v, reason=_identity(motion, v.term)) for v in vanished),
        kinetic_energy=settled(work.kinetic_energy, *(force.kinetic for force in forces)),
        strain_energy=settled(*(force.strain for force in forces)),
        weight_energy=settled(work.weight_energy) if body.gravity else None,
        linear_momentum=tuple(map(settled, work.linear_momentum)),
        angular_momentum=tuple(map(settled, work.angular_momentum)),
        mass_moments=tuple(map(settled, work.mass_moments)),
        markers=tuple(points),
        body=body,
        tables=(*body.tables, *of_points),
        table_sums=tuple(sums.table_sums),
        mode_sums=tuple(sums.mode_sums),
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
        else:
            self._inline(indexed_sum.symbol, offset, behind)

    def _scalar(self, indexed_sum: IndexedSum, expr: sp.Expr, behind: list[tuple[sp.Symbol, str]]) -> None:
        terms = sp.Add.make_args(expr)
        inside = sp.Add(*(t for t in terms if any(is_indexed(s) for s in t.free_symbols)))
        offset = expr - inside
        if inside != 0:
            self.mode_sums.append(
                ModeSum(indexed_sum.symbol, offset, inside, indexed_sum.doc.format(i="i"), indexed_sum.source)
            )
        else:
            self._inline(indexed_sum.symbol, offset, behind)

    def _inline(self, symbol: Symbol, value: sp.Expr, behind: list[tuple[sp.Symbol, str]]) -> None:
        """A sum without terms in the modes: a value, or zero for the reasons behind it."""
        if value != 0:
            self.inlined[symbol] = value
        else:
            self.reasons[symbol] = tuple(dict.fromkeys(behind))

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
