"""Tables of symmetric and antisymmetric matrices of factors, of which each instance has the entries on one side.

S_i = C4_i + sum_j C5_ij alpha_j has a symmetric C5 for each component, and d3_i = sum_j c7_ij alpha_j an antisymmetric
c7. Rows of linear forms in as many elements as there are rows are such matrices if their factors are equal across the
diagonal for all instances, or opposite. Numbers come from memory more slowly than they are multiplied: each is read
once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import reduce

from derive.ir.expressions import Element, Expr, Operation, Operator, ScalarRef
from derive.ir.indices import ElementIndex, IndexTerm, constant
from derive.ir.kernel import ConstantArray
from derive.ir.statements import ForEach, StoreElement

MATRIX = "matrix"
"""The variable of the loops over matrices."""
FEWEST_MATRICES = 3
"""The matrices from which on a loop is worth it: one has the text of all its rows."""

Values = tuple[Fraction, ...]
"""The numbers of a row, column by column for all instances."""


@dataclass(frozen=True)
class MatrixRow:
    """A row of one of some matrices: its number among the rows that were given, and whether that is the opposite."""

    number: int
    is_opposite: bool = False


Matrix = list[MatrixRow]


def _entry(row: Values, column: int, count: int) -> Values:
    return row[count * column : count * (column + 1)]


def _opposite(values: Values) -> Values:
    return tuple(-value for value in values)


def signed(rows: Sequence[Values], row: MatrixRow) -> Values:
    """The numbers of a row of a matrix."""
    return _opposite(rows[row.number]) if row.is_opposite else rows[row.number]


def symmetric(rows: Sequence[Values], size: int, count: int, has_offsets: bool) -> list[Matrix]:
    """The most symmetric matrices that rows begin with: first the first rows of all matrices, then the second ones."""
    start = 1 if has_offsets else 0

    def entry(row: int, column: int) -> Values:
        return _entry(rows[row], start + column, count)

    for number in range(len(rows) // size, FEWEST_MATRICES - 1, -1):
        pairs = ((i, j, m) for i in range(size) for j in range(i) for m in range(number))
        if all(entry(i * number + m, j) == entry(j * number + m, i) for i, j, m in pairs):
            return [[MatrixRow(i * number + m) for i in range(size)] for m in range(number)]
    return []


def antisymmetric(rows: Sequence[Values], size: int, count: int) -> list[Matrix]:
    """The antisymmetric matrices of rows without constant terms, whatever their order and signs are.

    Matrices of rows in another order, or with other signs, are the same ones.
    """
    zero = (Fraction(0),) * count
    on_diagonal: list[list[MatrixRow]] = [[] for _ in range(size)]
    for number, row in enumerate(rows):
        zeros = [j for j in range(size) if _entry(row, j, count) == zero]
        if len(zeros) == 1:
            on_diagonal[zeros[0]] += [MatrixRow(number, False), MatrixRow(number, True)]
    result: list[Matrix] = []
    used: set[int] = set()
    first_rows = (row for row in on_diagonal[0] if next(filter(None, signed(rows, row)), 0) > 0)
    for first in sorted(first_rows, key=lambda row: signed(rows, row)):
        matrix = [first]
        for i in range(1, size):
            column = [_opposite(_entry(signed(rows, above), i, count)) for above in matrix]
            matrix += [
                row
                for row in on_diagonal[i]
                if row.number not in used and [_entry(signed(rows, row), j, count) for j in range(i)] == column
            ][:1]
            if len(matrix) == i:
                break
        else:
            result.append(matrix)
            used |= {row.number for row in matrix}
    return result if len(result) >= FEWEST_MATRICES else []


@dataclass
class SymmetricTable:
    """The matrices of one size for the same instances, one after the other.

    size: the rows of a matrix; count: the instances, 1 if all have the same numbers; has_offsets: whether each matrix
    begins with a constant term of each row; is_antisymmetric: whether entries across the diagonal are opposite, and
    those on it zero.
    """

    name: str
    size: int
    count: int
    has_offsets: bool
    is_antisymmetric: bool = False
    made: dict[tuple[tuple[Values, ...], ...], int] = field(default_factory=dict)

    @property
    def columns(self) -> int:
        """The numbers of a matrix."""
        return self._packed(self.size, 0) + (self.size if self.has_offsets else 0)

    def _packed(self, i: int, j: int) -> int:
        """The place of an entry below the diagonal, or on it where that is not zero."""
        return i * (i - 1) // 2 + j if self.is_antisymmetric else i * (i + 1) // 2 + j

    def place(self, matrices: Sequence[Sequence[Values]]) -> int:
        """The number of the first of some matrices, which are added if they are not there."""
        key = tuple(tuple(rows) for rows in matrices)
        if key not in self.made:
            self.made[key] = sum(map(len, self.made))
        return self.made[key]

    @property
    def array(self) -> ConstantArray:
        """The constant array of the table."""
        values = tuple(x for matrices in self.made for rows in matrices for x in self._numbers(rows))
        return ConstantArray(self.name, values, False, self.count)

    def _numbers(self, rows: Sequence[Values]) -> Iterator[Fraction]:
        start = 1 if self.has_offsets else 0
        for row in rows:
            yield from row[: self.count * start]
        for i, row in enumerate(rows):
            stop = i if self.is_antisymmetric else i + 1
            yield from row[self.count * start : self.count * (start + stop)]

    def loop(self, first: int, number: int, to: Element, instance: str, names: Sequence[str]) -> ForEach:
        """The loop over some matrices for an instance, whose values go to an array from an element on, row by row.

        names: those of the elements.
        """

        def entry(k: int) -> Expr:
            own = (IndexTerm(1, instance),) if self.count > 1 else ()
            terms = IndexTerm(self.count * self.columns, MATRIX), *own
            return Element(self.name, ElementIndex(self.count * (k + first * self.columns), terms))

        def times(i: int, j: int) -> Expr:
            low, high = sorted((i, j))
            return Operation(Operator.MUL, (entry(start + self._packed(high, low)), ScalarRef(names[j])))

        start = self.size if self.has_offsets else 0
        assert to.index
        body = []
        for i in range(self.size):
            before = [times(i, j) for j in range(i if self.is_antisymmetric else self.size)]
            behind = [times(i, j) for j in range(i + 1, self.size)] if self.is_antisymmetric else []
            total = _total([*([entry(i)] if start else []), *before], behind)
            index = ElementIndex(to.index.offset + i * number, (IndexTerm(1, MATRIX),))
            body.append(StoreElement(Element(to.array, index), total))
        return ForEach(MATRIX, constant(0), constant(number), tuple(body))


def _total(added: Sequence[Expr], subtracted: Sequence[Expr]) -> Expr:
    """The sum of some numbers, of which there is at least one, less some others."""
    begun = added or [Operation(Operator.NEG, (subtracted[0],))]
    total = reduce(lambda a, b: Operation(Operator.ADD, (a, b)), begun)
    return reduce(lambda a, b: Operation(Operator.SUB, (a, b)), subtracted if added else subtracted[1:], total)
