"""Derivatives of what the loops of a tree compute, a column after the other: derivatives of loops along directions.

Along a direction, the loops run once more, each with the derivatives of what it writes. Which entries a column has
follows from a run of the loops themselves on sets of columns.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from derive.ir.analysis import reads
from derive.ir.dependence import Reached, dependences
from derive.ir.expressions import Element, Expr, Number, Operation, Operator, ScalarRef
from derive.ir.indices import ElementIndex, IndexTerm, constant, variable
from derive.ir.kernel import Argument, Kernel, Output, Section, View
from derive.ir.patterns import Pattern, pattern
from derive.ir.statements import Entry, ForEach, InstanceItem, Statement, StoreElement, Work
from derive.lowering.instances.loop_code.kernels import ZERO
from derive.lowering.instances.places import Places
from derive.lowering.trees.link_loop import SLOPES, LinkArrays, tangent_of

COLUMN, ROW, ENTRY = "column", "row", "entry"
"""The variables of loops over columns, over rows, and over entries of a column."""
ONE = Number(Fraction(1))
Rows = tuple[str, int, int]
"""Rows of a matrix: the array that the loops write, the first element, and how many."""


@dataclass(frozen=True)
class Directions:
    """Columns of a matrix: directions along which the loops are differentiated.

    seeds: arrays whose elements from a first one on change in these columns, each by so much for a unit. scalars:
    derivatives of scalars, by their names and the numbers of columns.
    """

    name: str
    count: int
    seeds: tuple[tuple[str, int, Expr], ...] = ()
    scalars: Mapping[str, Mapping[int, Expr]] = field(default_factory=dict)


@dataclass(frozen=True)
class LoopTangents:
    """The derivatives of the rows that statements write, along directions.

    sizes: of the arrays that are arguments. is_square: whether the pattern has the whole diagonal.
    function: the name of the function, in the names of constant arrays.
    """

    arrays: LinkArrays
    function: str
    statements: Sequence[Statement]
    sizes: Mapping[str, int]
    rows: Sequence[Rows]
    directions: Sequence[Directions]
    is_square: bool = False

    @cached_property
    def _works(self) -> dict[str, Work]:
        return {statement.array: statement for statement in self.statements if isinstance(statement, Work)}

    @property
    def _places(self) -> Places:
        return self.arrays.places

    # ---- the pattern ----

    @cached_property
    def pattern(self) -> Pattern:
        """The entries of the matrix that are no structural zeros."""
        columns, size = sum(of.count for of in self.directions), sum(count for *_, count in self.rows)
        reached = self._reached()
        numbers = [reached[array][start + k] for array, start, count in self.rows for k in range(count)]
        entries = {(i, j) for i, of_row in enumerate(numbers) for j in range(columns) if of_row >> j & 1}
        return pattern(size, columns, entries | {(i, i) for i in range(size if self.is_square else 0)})

    def _reached(self) -> Mapping[str, Sequence[int]]:
        """The columns on which the elements of the arrays of rows depend, as bits."""
        arrays = {name: [0] * size for name, size in self.sizes.items()}
        scalars, first = dict[str, int](), 0
        for of in self.directions:
            for array, start, _ in of.seeds:
                for column in range(of.count):
                    arrays[array][start + column] |= 1 << (first + column)
            for name, columns in of.scalars.items():
                scalars[name] = scalars.get(name, 0) | sum(1 << (first + column) for column in columns)
            first += of.count
        results = {name: self._works[name] for name, *_ in self.rows}
        body = tuple(s for s in self.statements if s not in results.values())
        read = {name for statement in body for name in reads(statement)}
        others = read - {*arrays, *self._works, *self._places.arrays, *scalars}
        arguments = [Argument(name, (), "", arrays=(View(name, 0, size),)) for name, size in self.sizes.items()]
        arguments += [Argument(name, (), "", scalar=True) for name in (*scalars, *others)]
        outputs = tuple(Output(name, (), "", count=work.count) for name, work in results.items())
        constants = tuple(self._places.arrays.values())
        kernel = Kernel(self.function, "", tuple(arguments), outputs, (Section("", "", "", body),), constants)
        given: dict[str, Any] = {name: [*map(Reached, columns)] for name, columns in arrays.items()}
        given |= {name: Reached(columns) for name, columns in scalars.items()}
        return dependences(kernel, given | {name: Reached() for name in others})

    # ---- the statements ----

    def columns(self, output: str) -> list[Statement]:
        """The statements that write the entries of the matrix to an output."""
        result, active, first = list[Statement](), dict[str, None](), 0
        for of in self.directions:
            if copies := [*self._copies(of, first, output)]:
                own_statements, own = self._along(of, copies)
                result += own_statements
                active |= dict.fromkeys(own)
            first += of.count
        works = [self._works.get(name, Work(name, self.sizes.get(name, 0))) for name in active]
        tangents = [replace(work, array=tangent_of(work.array), cleared=False) for work in works]
        return [Work(SLOPES, max(len(of.scalars) for of in self.directions)), *tangents, *result]

    def _along(self, of: Directions, copies: Sequence[InstanceItem]) -> tuple[list[Statement], list[str]]:
        """The statements of each direction, and the arrays of which there are derivatives."""
        places = {name: k for k, name in enumerate(of.scalars)}
        active = {array for array, *_ in of.seeds}
        tangents = [*self._tangents(places, active)]
        sizes = {**{name: work.count for name, work in self._works.items()}, **self.sizes}
        names = [name for name in sizes if name in active | {array for array, *_ in self.rows}]
        before, slopes = self._slopes(of, places)
        zeros = [_cleared(tangent_of(name), sizes[name]) for name in names]
        seeds = [StoreElement(Element(tangent_of(a), variable(COLUMN, 1, k)), unit) for a, k, unit in of.seeds]
        body = (*zeros, *seeds, *slopes, *tangents, *copies)
        return [*before, ForEach(COLUMN, constant(0), constant(of.count), body)], names

    def _tangents(self, places: Mapping[str, int], active: set[str]) -> Iterator[InstanceItem]:
        """Yield the derivatives of all statements; `active` gets the arrays that have some."""
        for statement in self.statements:
            if isinstance(statement, ForEach):
                _, loop = self.arrays.made[id(statement)]
                if (tangent := loop.tangent(statement.backward, active, places)) is not None:
                    yield tangent
            elif isinstance(statement, StoreElement):
                assert isinstance(statement.target, Element)
                slope = _slope(statement.expr, places)
                if slope is not None and statement.target.index:
                    active.add(statement.target.array)
                    target = Element(tangent_of(statement.target.array), statement.target.index)
                    yield StoreElement(target, slope, statement.operator)

    def _slopes(self, of: Directions, places: Mapping[str, int]) -> tuple[list[Statement], list[InstanceItem]]:
        """The statements before the columns that keep the derivatives of scalars, and those of a column."""
        every = sorted((column, places[name]) for name, by in of.scalars.items() for column in by)
        if not every:
            return [], []
        name, scalars = f"slopes_by_{of.name}", [*of.scalars]
        values = [of.scalars[scalars[place]][column] for column, place in every]
        kept = [StoreElement(Element(name, constant(k)), value) for k, value in enumerate(values)]
        span = self._span(ENTRY, name, [[k for k, (at, _) in enumerate(every) if at == c] for c in range(of.count)])
        place = self._places.place(f"scalar_of_{name}_{self.function}", ENTRY, [place for _, place in every])
        store = StoreElement(Element(SLOPES, place.at(0)), Element(name, variable(ENTRY)))
        own = [place.entry] if place.entry else []
        return [Work(name, len(every)), *kept], [_cleared(SLOPES, len(scalars)), *span((*own, store))]

    def _span(
        self, of: str, name: str, numbers: Sequence[Sequence[int]]
    ) -> Callable[[tuple[InstanceItem, ...]], list[InstanceItem]]:
        """The loop of a column over numbers that follow each other, by the variable `of`."""
        first, last = [[*n, 0][0] for n in numbers], [n[-1] + 1 if n else 0 for n in numbers]
        start, stop = (
            self._places.place(f"{what}_of_{name}_{self.function}", COLUMN, values)
            for what, values in (("start", first), ("stop", last))
        )
        named = [place.entry for place in (start, stop) if place.entry]
        return lambda body: [*named, ForEach(of, start.first, stop.first, body)]

    def _copies(self, of: Directions, first: int, output: str) -> Iterator[InstanceItem]:
        """Yield the statements that write the entries of a column, whose direction comes after `first` others."""
        columns: list[list[tuple[int, int]]] = [[] for _ in range(of.count)]
        for k, (i, j) in enumerate(self.pattern.entries):
            if first <= j < first + of.count:
                columns[j - first].append((i, k))
        begin = 0
        for n, (array, start, count) in enumerate(self.rows):
            own = [[(i - begin, k) for i, k in column if begin <= i < begin + count] for column in columns]
            begin += count
            if any(own):
                yield from self._copy(f"{of.name}_{n}", output, (tangent_of(array), start), own)

    def _copy(
        self, name: str, output: str, source: tuple[str, int], own: Sequence[Sequence[tuple[int, int]]]
    ) -> list[InstanceItem]:
        """The statements for some rows; own: the rows and the numbers of the entries of each column."""
        array, start = source
        rows, numbers = [[i for i, _ in column] for column in own], [[k for _, k in column] for column in own]
        if all(column == [*range(column[0], column[-1] + 1)] for column in rows if column):
            offsets = [k[0] - i[0] if i else 0 for i, k in zip(rows, numbers, strict=True)]
            place = self._places.place(f"entry_of_{name}_{self.function}", COLUMN, offsets)
            target = ElementIndex(place.first.offset, (*place.first.terms, IndexTerm(1, ROW)))
            store = StoreElement(Element(output, target), Element(array, variable(ROW, 1, start)))
            entry = [place.entry] if place.entry else []
            return [*entry, *self._span(ROW, f"rows_{name}", rows)((store,))]
        least = min(k for column in numbers for k in column)
        table = {k - least: i for column in own for i, k in column}
        integers = [table.get(k, 0) for k in range(max(table) + 1)]
        place_of = self._places.integers(f"of_rows_{name}_{self.function}", integers)
        row = Entry("row_of_entry", place_of, variable(ENTRY, 1, -least))
        store = StoreElement(Element(output, variable(ENTRY)), Element(array, variable(row.name, 1, start)))
        return self._span(ENTRY, f"entries_{name}", numbers)((row, store))


def _cleared(array: str, count: int) -> ForEach:
    return ForEach(ROW, constant(0), constant(count), (StoreElement(Element(array, variable(ROW)), ZERO),))


def _slope(expr: Expr, places: Mapping[str, int]) -> Expr | None:
    """The derivative of a number or a scalar, perhaps with the opposite sign."""
    match expr:
        case ScalarRef(name) if name in places:
            return Element(SLOPES, constant(places[name]))
        case Operation(Operator.NEG, (inner,)) if (slope := _slope(inner, places)) is not None:
            return Operation(Operator.NEG, (slope,))
    return None
