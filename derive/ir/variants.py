"""Kernels whose loops do much of the same work as the loops of one: an integer selects what they do differently.

The iterations of matching loops are compared value by value. What all kernels compute and store comes first, in the
words of the first kernel; then comes what some of them have in common, and what one alone does, each behind a test of
the integer. Values are the same if their operations and operands are, so that results keep their bits. Places that
differ come from a table with the places of each kernel.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace

from derive.ir.analysis import names_read, reads
from derive.ir.body_values import BodyValues, Numbers, Scope, matched
from derive.ir.expansion import expand
from derive.ir.expressions import Element, Number, Operation, ScalarRef, TableValue, walk
from derive.ir.indices import ElementIndex, IndexTerm, Of
from derive.ir.kernel import ConstantArray, Kernel
from derive.ir.loop_nests import Assign, For, If, Integer, Node, every
from derive.ir.statements import ForEach, Let, Statement

VARIANT = "variant"
"""The name of the integer, unless a kernel has another use for it."""


@dataclass(frozen=True)
class Variants:
    """Several kernels that share their loops.

    selector: the integer that is the number of the selected kernel; before: the statements of each kernel before its
    loops; nodes: the loops; tables: the constant arrays that these read besides those of the kernels.
    """

    kernels: tuple[Kernel, ...]
    selector: str
    before: tuple[tuple[Statement, ...], ...]
    nodes: tuple[Node, ...]
    tables: tuple[ConstantArray, ...]

    @property
    def differ(self) -> bool:
        """Whether there is anything to select."""
        return bool(self.tables) or any(isinstance(node, If) for node in every(self.nodes))

    @property
    def reads(self) -> frozenset[str]:
        """The names that the kernels read."""
        before = (name for own in self.before for statement in own for name in reads(statement))
        return frozenset((*names_read(self.nodes), *before))


def variants(kernels: Sequence[Kernel]) -> Variants | None:
    """The kernels as one, or None if their loops do not match or contain more than values and assignments."""
    if any(len(kernel.sections) != 1 for kernel in kernels):
        return None
    bodies = [kernel.sections[0].body for kernel in kernels]
    firsts = [next((n for n, s in enumerate(body) if isinstance(s, ForEach)), len(body)) for body in bodies]
    loops = [[_loop(s) for s in body[n:]] for body, n in zip(bodies, firsts, strict=True)]
    known = [[loop for loop in own if loop is not None] for own in loops]
    if not known[0] or known != loops or len({tuple(replace(loop, body=()) for loop in own) for own in known}) != 1:
        return None
    merging = _Merging(kernels)
    nodes = tuple(merging.loop(of) for of in zip(*known, strict=True))
    before = tuple(body[:n] for body, n in zip(bodies, firsts, strict=True))
    return Variants(tuple(kernels), merging.selector, before, nodes, merging.tables)


def _loop(statement: Statement) -> For | None:
    """The loop of a statement, if its iterations contain values and assignments and read nothing that they write."""
    (node,) = nodes if len(nodes := expand(statement)) == 1 else (None,)
    if not isinstance(node, For) or node.count is None:
        return None
    if not all(isinstance(item, Let | Assign | Integer) for item in node.body):
        return None
    targets = [item.target for item in node.body if isinstance(item, Assign)]
    parts = [part for item in node.body if isinstance(item, Let | Assign) for part in walk(item.expr)]
    known = Number | ScalarRef | Operation | Element | TableValue
    if not all(isinstance(target, Element) and target.index for target in targets):
        return None
    if not all(isinstance(part, known) for part in parts):
        return None
    read = {part.array for part in parts if isinstance(part, Element)}
    return node if read.isdisjoint(target.array for target in targets if isinstance(target, Element)) else None


class _Merging:
    """The kernels, and the tables of the places at which they differ."""

    def __init__(self, kernels: Sequence[Kernel]) -> None:
        self.kernels = kernels
        self.integers = {a.name: a for kernel in kernels for a in kernel.constants}
        arguments = {name for kernel in kernels for a in kernel.arguments for name in (a.name, *a.names)}
        self.taken = Scope({*arguments, *self.integers, *(o.name for k in kernels for o in k.outputs)})
        self.selector = self.taken.new(VARIANT)
        self._table = self.taken.new(f"of_{kernels[0].name}_{VARIANT}s")
        self._rows: dict[tuple[int, ...], int] = {}
        self._arrays: list[ConstantArray] = []

    @property
    def tables(self) -> tuple[ConstantArray, ...]:
        """The tables; in the first one the values of the kernels follow each other."""
        rows = tuple(value for row in self._rows for value in row)
        return (*((ConstantArray(self._table, rows, True),) if rows else ()), *self._arrays)

    def row(self, values: Sequence[int]) -> tuple[str, ElementIndex]:
        """The table and the index there of the value of the selected kernel."""
        values = (*values, *(0 for _ in self.kernels[len(values) :]))
        number = self._rows.setdefault(values, len(self._rows))
        return self._table, ElementIndex(number * len(values), (IndexTerm(1, self.selector),))

    def array(self, values: Sequence[Sequence[int]], variable: str, first: int) -> tuple[str, ElementIndex]:
        """A table with a value for each iteration and the index of that of the selected kernel."""
        count, flat = len(values[0]), tuple(value for own in values for value in own)
        name = self.taken.new(f"{self._table}_by_{variable}")
        self._arrays.append(ConstantArray(name, flat, True))
        return name, ElementIndex(-first, (IndexTerm(1, variable), IndexTerm(count, self.selector)))

    def loop(self, loops: Sequence[For]) -> For:
        """One loop for those of all kernels."""
        numbers: Numbers = {}
        bodies = [BodyValues(loop.body, numbers) for loop in loops]
        scope = Scope({*self.taken.taken, loops[0].variable})
        return replace(loops[0], body=tuple(self._parts(loops[0], bodies, [b.assignments for b in bodies], scope)))

    def _parts(
        self, loop: For, bodies: Sequence[BodyValues], left: Sequence[dict[int, Assign]], scope: Scope
    ) -> list[Node]:
        """The rest of the bodies: what they have in common, and a test between the rest of the last one and others."""
        if len(bodies) == 1:
            return scope.written(bodies[0], left[0], {})
        columns = [self._by_columns(k, loop, body, own) for k, (body, own) in enumerate(zip(bodies, left, strict=True))]
        keys = dict.fromkeys(key for of in columns for key in of)
        common = [pair for key in keys for pair in matched([of.get(key, []) for of in columns])]
        common = _in_order(common, bodies, left)
        placing = _Placing(self, loop, bodies, scope)
        targets = {
            pair[0]: placing.assign([own[n] for own, n in zip(left, pair, strict=True)]) for pair in sorted(common)
        }
        result = scope.written(bodies[0], targets, targets)
        used = [{pair[k] for pair in common} for k in range(len(bodies))]
        left = [{n: node for n, node in own.items() if n not in of} for own, of in zip(left, used, strict=True)]
        then = self._parts(loop, bodies[:-1], left[:-1], scope.inner())
        otherwise = self._parts(loop, bodies[-1:], left[-1:], scope.inner())
        if then or otherwise:
            result.append(If(self.selector, len(bodies) - 1, tuple(then), tuple(otherwise)))
        return result

    def _by_columns(
        self, number: int, loop: For, body: BodyValues, left: dict[int, Assign]
    ) -> dict[Hashable, list[tuple[int, Hashable]]]:
        """The rest of a body, by the column of a matrix in the first iteration: the places and what they assign."""
        result: dict[Hashable, list[tuple[int, Hashable]]] = defaultdict(list)
        for n, node in left.items():
            assert isinstance(node.target, Element) and node.target.index is not None
            output = next((o for o in self.kernels[number].outputs if o.name == node.target.array), None)
            column: object = None
            if output and output.pattern:
                first = replace(loop, stop=loop.start.plus(loop.step))
                (position,) = self.positions(first, body, node.target.index)
                column = bisect_right(output.pattern.colptr, position) - 1
            result[node.target.array, column].append((n, (node.operator, body.number(node.expr))))
        return result

    def positions(self, loop: For, body: BodyValues, index: ElementIndex) -> list[int]:
        """An index in all iterations of a loop."""
        named = {node.name: node for node in body.nodes if isinstance(node, Integer)}

        def at(of: ElementIndex, value: int) -> int:
            known = {loop.variable: value}
            for term in of.terms:
                if term.variable in named:
                    integer = named[term.variable]
                    known[term.variable] = int(self.integers[integer.array].values[at(integer.index, value)])
            return of.at(known)

        return [at(index, value) for value in loop.values({})]


def _in_order(
    common: list[tuple[int, ...]], bodies: Sequence[BodyValues], left: Sequence[dict[int, Assign]]
) -> list[tuple[int, ...]]:
    """The assignments in common, which come first, without those behind another assignment to the same element."""
    places = [{n: body.target(node) for n, node in own.items()} for body, own in zip(bodies, left, strict=True)]
    while True:
        others = [own.keys() - {pair[k] for pair in common} for k, own in enumerate(left)]
        firsts = [{at[n]: n for n in sorted(rest, reverse=True)} for at, rest in zip(places, others, strict=True)]
        kept = [
            pair
            for pair in common
            if all(n < first.get(at[n], n + 1) for n, at, first in zip(pair, places, firsts, strict=True))
        ]
        if kept == common:
            return kept
        common = kept


class _Placing:
    """The assignments that bodies have in common, at the places of the selected kernel."""

    def __init__(self, merging: _Merging, loop: For, bodies: Sequence[BodyValues], scope: Scope) -> None:
        self.merging, self.loop, self.bodies, self.scope = merging, loop, bodies, scope
        self._moves: dict[Hashable, ElementIndex] = {}
        self._steps: dict[tuple[int, ...], str] = {}
        self._new: list[Node] = []

    def assign(self, nodes: Sequence[Assign]) -> tuple[Node, ...]:
        """The assignment that stands for one of each body, behind the integers that place it first."""
        first = nodes[0]
        indices = [node.target.index for node in nodes if isinstance(node.target, Element) and node.target.index]
        if len({body.place(index) for body, index in zip(self.bodies, indices, strict=True)}) == 1:
            return (first,)
        self._new = []
        offset = indices[0].offset
        moved = [index.plus(-offset) for index in indices]
        key = tuple(body.place(index) for body, index in zip(self.bodies, moved, strict=True))
        if key not in self._moves:
            self._moves[key] = self._moved(moved, offset)
        assert isinstance(first.target, Element)
        index = self._moves[key].plus(offset)
        return (*self._new, replace(first, target=replace(first.target, index=index)))

    def _moved(self, indices: list[ElementIndex], first: int) -> ElementIndex:
        """The index that is one of these indices; a table has it from `first` on, since offsets there are no text."""
        variable = self.loop.variable
        own: tuple[IndexTerm, ...] = indices[0].terms
        distances = [index.offset for index in indices]
        strides = tuple(index.stride(variable) for index in indices)
        if any(term != IndexTerm(term.stride, variable, Of.VALUE) for index in indices for term in index.terms):
            values = [self.merging.positions(self.loop, *of) for of in zip(self.bodies, indices, strict=True)]
            distances = [of[0] - values[0][0] for of in values]
            moved = [[value + distance for value in values[0]] for distance in distances]
            if values != moved:
                values = [[first + value for value in of] for of in values]
                at = self._integer("place", *self.merging.array(values, variable, self.loop.start.offset))
                return ElementIndex(-first, (at,))
        elif len(set(strides)) > 1:
            if strides not in self._steps:
                self._steps[strides] = self._integer("step", *self.merging.row(strides), times=variable).variable
            own = (IndexTerm(1, self._steps[strides]),)
        if not any(distances):
            return ElementIndex(0, own)
        place = self._integer("place", *self.merging.row([first + distance for distance in distances]))
        return ElementIndex(-first, (*own, place))

    def _integer(self, name: str, array: str, index: ElementIndex, times: str = "") -> IndexTerm:
        """The term of an integer that is named before the assignment."""
        of_bodies = {other for body in self.bodies for other in body.of_names}
        name = self.scope.new(name, of_bodies)
        self._new.append(Integer(name, array, index, times))
        return IndexTerm(1, name)
