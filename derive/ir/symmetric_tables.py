"""Tables of symmetric and antisymmetric matrices of factors, of which each instance has the entries on one side.

S_i = C4_i + sum_j C5_ij alpha_j has a symmetric C5 for each component, and d3_i = sum_j c7_ij alpha_j an antisymmetric
c7. Rows of linear forms in as many elements as there are rows are such matrices if their factors are equal across the
diagonal for all instances, or opposite. The constant terms may be the factors of one more row, as C4 are those of the
moments of inertia. Numbers come from memory more slowly than they are multiplied: each is read once.
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


@dataclass(frozen=True)
class MatrixKind:
    """A kind of matrices, of which a table has one.

    size: the rows of a matrix; count: the instances, 1 if all have the same numbers; has_offsets: whether each matrix
    begins with a constant term of each row; has_row_of_offsets: whether there is one more row, whose factors these are;
    is_antisymmetric: whether entries across the diagonal are opposite, and those on it zero.
    """

    size: int
    count: int
    has_offsets: bool
    has_row_of_offsets: bool = False
    is_antisymmetric: bool = False

    def packed(self, i: int, j: int) -> int:
        """The place of an entry below the diagonal, or on it where that is not zero."""
        return i * (i - 1) // 2 + j if self.is_antisymmetric else i * (i + 1) // 2 + j

    @property
    def offsets(self) -> int:
        """The constant terms of a matrix."""
        return (self.size if self.has_offsets else 0) + self.has_row_of_offsets

    @property
    def columns(self) -> int:
        """The numbers of a matrix."""
        return self.packed(self.size, 0) + self.offsets


Matrix = list[MatrixRow]


def matrices(
    rows: Sequence[Values], size: int, count: int, has_offsets: bool
) -> Iterator[tuple[MatrixKind, list[Matrix]]]:
    """The matrices that some rows have, by their kinds, which have at least `FEWEST_MATRICES` each."""
    found = symmetric(rows, size, count, has_offsets)
    if found:
        whole = with_rows_of_offsets(found, rows, count) if has_offsets else found
        yield MatrixKind(size, count, has_offsets, len(whole[0]) > size), whole
    elif not has_offsets:
        opposite = antisymmetric(rows, size, count)
        if opposite:
            yield MatrixKind(size, count, has_offsets, is_antisymmetric=True), opposite


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


def with_rows_of_offsets(matrices: list[Matrix], rows: Sequence[Values], count: int) -> list[Matrix]:
    """The matrices, each with the row that has its constant terms as factors; without these if one is missing.

    Nor do matrices with the same constant terms get them, as those of a body of revolution: a row belongs to one.
    """
    by_factors = {row[count:]: number for number, row in enumerate(rows)}
    offsets = [sum((rows[row.number][:count] for row in matrix), start=()) for matrix in matrices]
    if len({*offsets}) < len(offsets) or any(of not in by_factors for of in offsets):
        return matrices
    return [[*matrix, MatrixRow(by_factors[of])] for matrix, of in zip(matrices, offsets, strict=True)]


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
    """Matrices of one kind for the same instances, one after the other."""

    name: str
    kind: MatrixKind
    made: dict[tuple[tuple[Values, ...], ...], int] = field(default_factory=dict)

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
        return ConstantArray(self.name, values, False, self.kind.count)

    def _numbers(self, rows: Sequence[Values]) -> Iterator[Fraction]:
        count, start = self.kind.count, 1 if self.kind.has_offsets else 0
        for row in rows:
            yield from row[: count * start]
        for i, row in enumerate(rows[: self.kind.size]):
            stop = i if self.kind.is_antisymmetric else i + 1
            yield from row[count * start : count * (start + stop)]

    def loop(self, first: int, number: int, to: Element, instance: str, names: Sequence[str]) -> ForEach:
        """The loop over some matrices for an instance, whose values go to an array from an element on, row by row.

        names: those of the elements.
        """
        kind = self.kind

        def entry(k: int) -> Expr:
            own = (IndexTerm(1, instance),) if kind.count > 1 else ()
            terms = IndexTerm(kind.count * kind.columns, MATRIX), *own
            return Element(self.name, ElementIndex(kind.count * (k + first * kind.columns), terms))

        def times(k: int, j: int) -> Expr:
            return Operation(Operator.MUL, (entry(k), ScalarRef(names[j])))

        def factor(i: int, j: int) -> Expr:
            low, high = sorted((i, j))
            return times(kind.offsets + kind.packed(high, low), j)

        totals = []
        for i in range(kind.size):
            before = [factor(i, j) for j in range(i if kind.is_antisymmetric else kind.size)]
            behind = [factor(i, j) for j in range(i + 1, kind.size)] if kind.is_antisymmetric else []
            totals.append(_total([*([entry(i)] if kind.has_offsets else []), *before], behind))
        if kind.has_row_of_offsets:
            totals.append(_total([entry(kind.size), *(times(j, j) for j in range(kind.size))], []))
        assert to.index
        body = []
        for i, total in enumerate(totals):
            index = ElementIndex(to.index.offset + i * number, (IndexTerm(1, MATRIX),))
            body.append(StoreElement(Element(to.array, index), total))
        return ForEach(MATRIX, constant(0), constant(number), tuple(body))


def _total(added: Sequence[Expr], subtracted: Sequence[Expr]) -> Expr:
    """The sum of some numbers, of which there is at least one, less some others."""
    begun = added or [Operation(Operator.NEG, (subtracted[0],))]
    total = reduce(lambda a, b: Operation(Operator.ADD, (a, b)), begun)
    return reduce(lambda a, b: Operation(Operator.SUB, (a, b)), subtracted if added else subtracted[1:], total)
