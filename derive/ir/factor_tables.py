"""Tables of the factors of linear forms, row by row for each instance, and the loops over their rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import reduce

from derive.ir.expressions import Element, Expr, Operation, Operator, ScalarRef
from derive.ir.indices import ElementIndex, IndexTerm, constant
from derive.ir.kernel import ConstantArray
from derive.ir.statements import ForEach, StoreElement
from derive.ir.symmetric_tables import SymmetricTable

ROW = "row"
"""The variable of the loops over the rows of a table."""


@dataclass(frozen=True)
class RowPlace:
    """The place of a row: its number in a table, and whether that has the opposite row."""

    number: int
    is_opposite: bool


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
        return RowPlace(self.rows.setdefault(values, len(self.rows)), False)

    @property
    def array(self) -> ConstantArray:
        """The constant array of the table."""
        return ConstantArray(self.name, tuple(x for values in self.rows for x in values), False, self.count)

    def loop(self, first: int, stop: int, to: Element, instance: str, names: Sequence[str]) -> ForEach:
        """The loop over some rows for an instance, whose values go to an array from an element on.

        names: those of the elements of the window.
        """

        def entry(k: int) -> Expr:
            own = (IndexTerm(1, instance),) if self.count > 1 else ()
            terms = IndexTerm(self.count * self.columns, ROW), *own
            return Element(self.name, ElementIndex(self.count * (k + first * self.columns), terms))

        start = 1 if self.has_offsets else 0
        parts = [Operation(Operator.MUL, (entry(start + k), ScalarRef(name))) for k, name in enumerate(names)]
        total = reduce(lambda a, b: Operation(Operator.ADD, (a, b)), [*([entry(0)] if start else []), *parts])
        assert to.index
        body = StoreElement(replace(to, index=ElementIndex(to.index.offset, (IndexTerm(1, ROW),))), total)
        return ForEach(ROW, constant(0), constant(stop - first), (body,))


class FactorTables:
    """The tables of a model, by the numbers of a row, of the instances, and by whether there are constant terms."""

    def __init__(self) -> None:
        self.made: dict[tuple[int, int, bool], FactorTable] = {}
        self.symmetric: dict[tuple[int, int, bool], SymmetricTable] = {}

    def of(self, columns: int, count: int, has_offsets: bool) -> FactorTable:
        """The table for these numbers."""
        key = columns, count, has_offsets
        name = f"factors_of_modes_{len(self.made) + 1}"
        return self.made.setdefault(key, FactorTable(name, columns, count, has_offsets))

    def of_matrices(self, size: int, count: int, has_offsets: bool) -> SymmetricTable:
        """The table of symmetric matrices for these numbers."""
        key = size, count, has_offsets
        name = f"symmetric_factors_of_modes_{len(self.symmetric) + 1}"
        return self.symmetric.setdefault(key, SymmetricTable(name, size, count, has_offsets))

    @property
    def arrays(self) -> dict[str, ConstantArray]:
        """The constant arrays by their names."""
        of_rows = {table.name: table.array for table in self.made.values()}
        return of_rows | {table.name: table.array for table in self.symmetric.values()}
