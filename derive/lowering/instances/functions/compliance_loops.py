"""The compliance of the markers of a body with many modes in loops over the rows of its joints.

Where the compliance of the modes is constant, all rows of G at one marker that have the same constants of modes (three
of displacements, or three of rotations) are a group, and what a group computes is one code for its rows: written out,
it is most of the text of a body, which a call executes once and caches do not hold. A row has three coefficients p,
and the coordinates that are coupled with the modes have the factors x of L^-1 G^T. Entries of two rows are then
p^T C p' + x^T D^-1 x', and C is constant. Rows along the axes of the body have p = -1 of one constant each.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from itertools import groupby

import casadi as ca

from derive.ir.expressions import Element, Expr, Operation, Operator
from derive.ir.indices import ElementIndex, IndexTerm, constant, variable
from derive.ir.statements import ForEach, InstanceItem, StoreElement
from derive.lowering.flat.context import stores
from derive.lowering.flat.schedule import StepItem
from derive.lowering.instances.classes.mode_factors import AXES
from derive.lowering.instances.functions.constant_modes import ROTATIONS, ConstantModes
from derive.lowering.instances.functions.marker_modes import named, product, total
from derive.lowering.instances.loop_code.class_code import ClassCode, InnerLoops, Tables
from derive.mechanics.symbols import Family, Identity

ROW, COLUMN = "constraint", "partner"
"""The variables of the loops over the rows of one group, and of another one."""
LABELS = range(AXES)


@dataclass(frozen=True)
class RowGroup:
    """Rows of G with the same constants of modes: the first one, how many they are, and their handle of the body.

    place: the number of the first row among those of its joint; number: that of the group; labels: the constants;
    start: the first number of its coefficients in their array, None if they are -1 of one constant after the other.
    """

    first: int
    count: int
    handle: int
    place: int
    number: int
    labels: tuple[Identity, ...]
    start: int | None


def _minus(a: Expr, parts: Sequence[Expr]) -> Expr:
    return reduce(lambda x, y: Operation(Operator.SUB, (x, y)), parts, a)


class ComplianceLoops:
    """The loops over the rows of a body, and the values that they read.

    bias: gamma of each row.
    """

    def __init__(self, of: ClassCode, modes: ConstantModes, bias: Sequence[ca.SX]) -> None:
        self.of, self.modes, self.half_force, self.bias = of, modes, modes.half_force, bias
        assert modes.markers
        self.markers = modes.markers
        self.coupled = self.markers.coupled
        self.coefficients, self.turning, self.halves, self.weighted, self.shared = (
            f"{what}_of_{of.name}" for what in ("coefficients", "turning", "halves", "weighted_halves", "shared")
        )

    @cached_property
    def groups(self) -> tuple[RowGroup, ...] | None:
        """The groups of rows; None if some rows have other factors than loops compute."""
        result: list[RowGroup] = []
        start = 0
        for h, rows in enumerate(self.of.system_rows):
            for _, run in groupby(rows, self._constants_of):
                own = list(run)
                labels = tuple(dict.fromkeys(n for row in own for n in self.modes.rows[row].coefficients))
                if len(labels) != AXES:
                    return None
                place = own[0] - rows[0], len(result)
                if self._are_units(own, labels):
                    result.append(RowGroup(own[0], len(own), h, *place, labels, None))
                    continue
                if any(len(self.modes.rows[row].coefficients) != AXES for row in own):
                    return None
                result.append(RowGroup(own[0], len(own), h, *place, labels, start))
                start += AXES * len(own)
        fixed = {j for row in self.modes.rows for j in row.factors if j not in self.coupled}
        varies = any(not row.factors[j].is_constant() for row in self.modes.rows for j in row.factors if j in fixed)
        apart = not any(self.modes.factors.lower[j] for j in fixed)
        return tuple(result) if len(self.coupled) == ROTATIONS and apart and not varies else None

    def _constants_of(self, row: int) -> set[tuple[Family, str]]:
        """The kind of the constants of a row, and their marker."""
        return {(label.family, label.point) for label in self.modes.rows[row].coefficients}

    def _are_units(self, rows: Sequence[int], labels: Sequence[Identity]) -> bool:
        """Whether rows have the coefficient -1 of one constant each, in the order in which loops find these."""
        own = [self.modes.rows[row].coefficients for row in rows]
        numbers = [self.markers.labels.index(label) for label in labels]
        alone = all([*of] == [label] and of[label].is_minus_one() for of, label in zip(own, labels, strict=False))
        return alone and len(rows) == AXES and numbers == [*range(numbers[0], numbers[0] + AXES)]

    # ---- values ----

    def items(self) -> Iterator[StepItem]:
        """The items that store what the loops read."""
        modes, rows = self.modes, self.modes.rows
        assert self.groups is not None
        own = [row for g in self.groups if g.start is not None for row in rows[g.first : g.first + g.count]]
        yield from stores(self.coefficients, [c for row in own for c in row.coefficients.values()])
        yield from stores(self.turning, [row.factors.get(j, ca.SX(0)) for row in rows for j in self.coupled])
        yield from stores(self.shared, self._shared)
        yield from stores(self._rights, [self.right(row) for row in range(len(rows))])
        for group in self.groups:
            for other in self.groups[group.number :]:
                constants = [modes.compliances[a, b] for a in group.labels for b in other.labels]
                yield from stores(self._table(group, other), [*constants, *self._fixed(group, other)])

    @cached_property
    def _shared(self) -> list[ca.SX]:
        """The numbers that all rows read: L between coupled coordinates, D^-1, and D^-1 L^-1 f."""
        modes, order = self.modes, self.coupled
        lower = [dict(modes.factors.lower[j]).get(i, ca.SX(0)) for i in order for j in order[: order.index(i)]]
        inverses = [modes.inverse[j] for j in order]
        return [*lower, *inverses, *(modes.inverse[j] * self.half_force[j] for j in order)]

    def _fixed(self, group: RowGroup, other: RowGroup) -> list[ca.SX]:
        """The part of each entry that is due to coordinates without coupling; nothing if there is none."""
        rows, result = self.modes.rows, []
        for a in range(group.first, group.first + group.count):
            for b in range(other.first, other.first + other.count):
                one, two = rows[a].factors, rows[b].factors
                both = [j for j in one if j in two and j not in self.coupled]
                result.append(sum((one[j] * self.modes.inverse[j] * two[j] for j in both), start=ca.SX(0)))
        return result if any(not value.is_zero() for value in result) else []

    def right(self, row: int) -> ca.SX:
        """The right-hand side of a row without what its loop subtracts."""
        modes, own = self.modes, self.modes.rows[row]
        parts = [-f * modes.inverse[j] * self.half_force[j] for j, f in own.factors.items() if j not in self.coupled]
        parts += [-f * modes.of_translations[n] for n, f in own.coefficients.items() if n in modes.of_translations]
        return sum(parts, start=self.bias[row])

    def _table(self, group: RowGroup, other: RowGroup) -> str:
        return f"compliance_{group.number + 1}_{other.number + 1}_of_{self.of.name}"

    # ---- loops ----

    def loops(self, targets: RowTargets) -> InnerLoops:
        """All loops. targets: where entries and right-hand sides go."""
        assert self.groups is not None
        rows, pairs = len(self.modes.rows), AXES * len(self.modes.rows)
        own = AXES * sum(group.count for group in self.groups if group.start is not None)
        arrays = {self.coefficients: own, self.turning: pairs, self.halves: pairs, self.weighted: pairs}
        arrays |= {self.shared: len(self._shared)}
        tables = {self._rights: rows}
        tables |= {
            self._table(group, other): AXES**2 + len(self._fixed(group, other))
            for group in self.groups
            for other in self.groups[group.number :]
        }

        def made(at: Tables) -> Iterator[InstanceItem]:
            assert self.groups is not None
            for group in self.groups:
                yield self._rows(group, at, targets)
            for group in self.groups:
                for other in self.groups[group.number :]:
                    yield self._block(group, other, at, targets)

        return InnerLoops(arrays, tables, made)

    @property
    def _rights(self) -> str:
        return f"right_of_{self.of.name}"

    def _shared_at(self, index: int) -> Element:
        return Element(self.shared, constant(index))

    def _of_row(self, array: str, group: RowGroup, k: int, index: str = ROW) -> Element:
        """One of the three numbers of a row."""
        return Element(array, variable(index, AXES, AXES * group.first + k))

    def _coefficient(self, group: RowGroup, k: int, index: str = ROW) -> Element:
        """One of the three coefficients of a row."""
        assert group.start is not None
        return Element(self.coefficients, variable(index, AXES, group.start + k))

    def _along(self, group: RowGroup, by: int, p: Sequence[Expr]) -> list[Expr]:
        """The parts of a motion of the marker along a row, with a minus sign if its coefficients are units."""
        labels = [self.markers.labels.index(label) for label in group.labels]
        if group.start is None:
            return [self.markers.at(by, variable(ROW, 1, labels[0]))]
        return [product(p[m], self.markers.at(by, constant(labels[m]))) for m in LABELS]

    def _rows(self, group: RowGroup, at: Tables, targets: RowTargets) -> ForEach:
        """The loop over the rows of a group: the factors of the coupled coordinates, and the right-hand side."""
        pairs = [(i, j) for i in range(ROTATIONS) for j in range(i)]
        inverses = len(pairs)
        forces = inverses + ROTATIONS
        body: list[InstanceItem] = []
        is_unit = group.start is None
        p = [] if is_unit else [named(body, f"p{m + 1}", self._coefficient(group, m)) for m in LABELS]
        x: list[Expr] = []
        for i in range(ROTATIONS):
            terms = self._along(group, i, p)
            start: Expr = self._of_row(self.turning, group, i)
            if is_unit:
                start, terms = total([start, *terms]), []
            terms += [product(self._shared_at(pairs.index((i, j))), x[j]) for j in range(i)]
            x.append(named(body, f"x{i + 1}", _minus(start, terms)))
        for i in range(ROTATIONS):
            body.append(StoreElement(self._of_row(self.halves, group, i), x[i]))
            weighted = product(x[i], self._shared_at(inverses + i))
            body.append(StoreElement(self._of_row(self.weighted, group, i), weighted))
        loads = self._along(group, ROTATIONS, p)
        motions = [product(x[i], self._shared_at(forces + i)) for i in range(ROTATIONS)]
        right: Expr = at(self._rights, group.first, IndexTerm(1, ROW))
        if is_unit:
            right, loads = total([right, *loads]), []
        body.append(StoreElement(targets.right(group), _minus(right, [*loads, *motions])))
        return ForEach(ROW, constant(0), constant(group.count), tuple(body))

    def _block(self, group: RowGroup, other: RowGroup, at: Tables, targets: RowTargets) -> ForEach:
        """The loops over the entries of the rows of two groups."""
        table = self._table(group, other)
        body: list[InstanceItem] = []
        p = (
            []
            if other.start is None
            else [named(body, f"p{m + 1}", self._coefficient(other, m, COLUMN)) for m in LABELS]
        )
        y = [named(body, f"y{i + 1}", self._of_row(self.weighted, other, i, COLUMN)) for i in range(ROTATIONS)]
        parts = [product(self._of_row(self.halves, group, i), y[i]) for i in range(ROTATIONS)]
        less: list[Expr] = []
        if group.start is None and other.start is None:
            parts.insert(0, at(table, 0, IndexTerm(AXES, ROW), IndexTerm(1, COLUMN)))
        elif group.start is None:
            less = [product(at(table, m, IndexTerm(AXES, ROW)), p[m]) for m in LABELS]
        elif other.start is None:
            motion = [named(body, f"m{k + 1}", at(table, AXES * k, IndexTerm(1, COLUMN))) for k in LABELS]
            less = [product(self._coefficient(group, k), motion[k]) for k in LABELS]
        else:
            motion = [
                named(body, f"m{k + 1}", total([product(at(table, AXES * k + m), p[m]) for m in LABELS]))
                for k in LABELS
            ]
            parts = [*(product(self._coefficient(group, k), motion[k]) for k in LABELS), *parts]
        if self._fixed(group, other):
            parts.insert(0, at(table, AXES**2, IndexTerm(other.count, ROW), IndexTerm(1, COLUMN)))
        entry = StoreElement(targets.entry(group, other), _minus(total(parts), less))
        stop = constant(group.count) if group is not other else variable(COLUMN, 1, 1)  # the other half is the same
        body.append(ForEach(ROW, constant(0), stop, (entry,)))
        return ForEach(COLUMN, constant(0), constant(other.count), tuple(body))


class RowTargets:
    """Where the entries and the right-hand sides of rows go.

    entries: the index of the entry of two rows of joints at two handles, by rows and columns; rights: that of the
    right-hand side of a row. Both are of the first rows of joints, with the distances of the next ones.
    """

    def __init__(
        self,
        entries: Mapping[tuple[int, int], tuple[str, ElementIndex, int, int]],
        rights: Mapping[int, tuple[str, ElementIndex, int]],
    ) -> None:
        self.entries, self.rights = entries, rights

    def entry(self, group: RowGroup, other: RowGroup) -> Element:
        """The entry of a row and a column, in loops over these."""
        array, first, row, column = self.entries[group.handle, other.handle]
        terms = *first.terms, IndexTerm(row, ROW), IndexTerm(column, COLUMN)
        return Element(array, ElementIndex(first.offset + row * group.place + column * other.place, terms))

    def right(self, group: RowGroup) -> Element:
        """The right-hand side of a row, in a loop over the rows."""
        array, first, distance = self.rights[group.handle]
        terms = *first.terms, IndexTerm(distance, ROW)
        return Element(array, ElementIndex(first.offset + distance * group.place, terms))
