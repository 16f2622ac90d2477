"""Tables of the factors of linear forms, row by row for each instance, and the loops over their rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import reduce
from itertools import pairwise

from derive.ir.expressions import Element, Expr, Operation, Operator, ScalarRef
from derive.ir.indices import LANES, ElementIndex, IndexTerm, constant
from derive.ir.kernel import ConstantArray
from derive.ir.statements import ForEach, StoreElement
from derive.ir.symmetric_tables import MatrixKind, SymmetricTable, Values

ROW = "row"
"""The variable of the loops over the rows of a table."""


@dataclass(frozen=True)
class StoredRows:
    """Rows of numbers that an array has at equal distances.

    first: the place of the first number of the first row; row, column: the distances between rows and in a row;
    has_offsets: whether rows begin with a constant term.
    """

    array: str
    first: ElementIndex
    row: int
    column: int
    has_offsets: bool

    def loop(self, start: int, stop: int, to: Element, names: Sequence[str]) -> ForEach:
        """The loop over some rows, whose values go to an array from an element on.

        names: those of the elements of the window.
        """

        def entry(k: int) -> Expr:
            index = self.first.plus(start * self.row + k * self.column)
            return Element(self.array, ElementIndex(index.offset, (IndexTerm(self.row, ROW), *index.terms)))

        offsets = [entry(0)] if self.has_offsets else []
        products = (entry(len(offsets) + k) for k in range(len(names)))
        parts = [Operation(Operator.MUL, (x, ScalarRef(name))) for x, name in zip(products, names, strict=True)]
        total = reduce(lambda a, b: Operation(Operator.ADD, (a, b)), [*offsets, *parts])
        assert to.index
        body = StoreElement(replace(to, index=ElementIndex(to.index.offset, (IndexTerm(1, ROW),))), total)
        return ForEach(ROW, constant(0), constant(stop - start), (body,))


def rows_in_an_array(rows: Sequence[Sequence[Expr]], has_offsets: bool) -> tuple[StoredRows, list[int]] | None:
    """Where an array has all of some rows at equal distances, with the number of each; None if none has."""
    entries = [[x for x in row if isinstance(x, Element) and x.index] for row in rows]
    if not rows or any(len(found) != len(row) or len(row) < 2 for found, row in zip(entries, rows, strict=True)):
        return None
    places = [[x.index for x in row if x.index] for row in entries]
    firsts = sorted(row[0].offset for row in places)
    if len({(x.array, x.state, x.index and x.index.terms) for row in entries for x in row}) > 1 or len(firsts) < 2:
        return None
    column, distance = places[0][1].offset - places[0][0].offset, firsts[1] - firsts[0]
    if not distance or any(b - a != distance for a, b in pairwise(firsts)):
        return None
    if any(x.offset != row[0].offset + k * column for row in places for k, x in enumerate(row)):
        return None
    first = replace(places[0][0], offset=firsts[0])
    stored = StoredRows(entries[0][0].array, first, distance, column, has_offsets)
    return stored, [(row[0].offset - firsts[0]) // distance for row in places]


@dataclass(frozen=True)
class RowPlace:
    """The place of a row: its number in a table, and whether that has the opposite row."""

    number: int
    is_opposite: bool = False


@dataclass
class FactorTable:
    """The rows with as many factors for the same instances, which all loops share.

    columns: the numbers of a row; count: the instances, 1 if all have the same numbers; has_offsets: whether rows begin
    with a constant term.
    """

    name: str
    columns: int
    count: int
    has_offsets: bool
    rows: dict[tuple[Fraction, ...], int] = field(default_factory=dict)

    def place(self, values: tuple[Fraction, ...]) -> RowPlace:
        """The place of a row with these values, column by column, which is added if neither it nor its opposite is."""
        opposite = tuple(-value for value in values)
        if values not in self.rows and opposite in self.rows:
            return RowPlace(self.rows[opposite], True)
        return RowPlace(self.rows.setdefault(values, len(self.rows)))

    @property
    def array(self) -> ConstantArray:
        """The constant array of the table."""
        return ConstantArray(self.name, tuple(x for values in self.rows for x in values), False, self.count)

    def stored(self, instance: str) -> StoredRows:
        """The rows of an instance."""
        own = (IndexTerm(1, instance),) if self.count > 1 else ()
        return StoredRows(self.name, ElementIndex(0, own), self.count * self.columns, self.count, self.has_offsets)


class FactorTables:
    """The tables of a model, by the numbers of a row, of the instances, and by whether there are constant terms.

    columns: the rows of a body that is alone in its class, which lie beside each other.
    """

    def __init__(self) -> None:
        self.columns: dict[tuple[Values, ...], ConstantArray] = {}
        self.made: dict[tuple[int, int, bool], FactorTable] = {}
        self.symmetric: dict[MatrixKind, SymmetricTable] = {}

    def of(self, columns: int, count: int, has_offsets: bool) -> FactorTable:
        """The table for these numbers."""
        key = columns, count, has_offsets
        name = f"factors_of_modes_{len(self.made) + 1}"
        return self.made.setdefault(key, FactorTable(name, *key))

    def of_matrices(self, kind: MatrixKind) -> SymmetricTable:
        """The table of matrices of a kind."""
        name = f"symmetric_factors_of_modes_{len(self.symmetric) + 1}"
        return self.symmetric.setdefault(kind, SymmetricTable(name, kind))

    def in_columns(self, rows: Sequence[Values], has_offsets: bool) -> StoredRows:
        """The rows of one body beside each other, so that vectors have several of them; zeros fill the last vector."""
        width = -(-len(rows) // LANES) * LANES
        name = f"columns_of_factors_{len(self.columns) + 1}"
        values = (x for column in zip(*rows, strict=True) for x in (*column, *[Fraction(0)] * (width - len(rows))))
        array = self.columns.setdefault(tuple(rows), ConstantArray(name, tuple(values), False))
        return StoredRows(array.name, ElementIndex(), 1, width, has_offsets)

    @property
    def arrays(self) -> dict[str, ConstantArray]:
        """The constant arrays by their names."""
        of_rows = {table.name: table.array for table in self.made.values() if table.rows}
        of_matrices = {table.name: table.array for table in self.symmetric.values()}
        return of_rows | of_matrices | {array.name: array for array in self.columns.values()}
