"""Tables of symmetric matrices of factors, of which each instance has the entries on and below the diagonal.

S_i = C4_i + sum_j C5_ij alpha_j has a symmetric C5 for each component. Rows of linear forms in as many elements as
there are rows are such matrices if their factors are equal across the diagonal for all instances. Their numbers come
from memory faster than they are multiplied if each is read once.
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


def packed(i: int, j: int) -> int:
    """The place of an entry on or below the diagonal, or of the one across it."""
    low, high = sorted((i, j))
    return high * (high + 1) // 2 + low


def matrices(rows: Sequence[Values], size: int, count: int, has_offsets: bool) -> int:
    """The most symmetric matrices that rows begin with: first the first rows of all matrices, then the second ones."""
    start = 1 if has_offsets else 0

    def entry(row: int, column: int) -> Values:
        first = count * (start + column)
        return rows[row][first : first + count]

    for number in range(len(rows) // size, FEWEST_MATRICES - 1, -1):
        pairs = ((i, j, m) for i in range(size) for j in range(i) for m in range(number))
        if all(entry(i * number + m, j) == entry(j * number + m, i) for i, j, m in pairs):
            return number
    return 0


@dataclass
class SymmetricTable:
    """The matrices of one size for the same instances, one after the other.

    size: the rows of a matrix; count: the instances, 1 if all have the same numbers; has_offsets: whether each matrix
    begins with a constant term of each row.
    """

    name: str
    size: int
    count: int
    has_offsets: bool
    made: dict[tuple[Values, ...], int] = field(default_factory=dict)

    @property
    def columns(self) -> int:
        """The numbers of a matrix."""
        return packed(self.size - 1, self.size - 1) + 1 + (self.size if self.has_offsets else 0)

    def place(self, rows: Sequence[Values]) -> int:
        """The number of the first of some matrices, which are added if they are not there."""
        key = tuple(rows)
        if key not in self.made:
            self.made[key] = sum(len(of) // self.size for of in self.made)
        return self.made[key]

    @property
    def array(self) -> ConstantArray:
        """The constant array of the table."""
        values = tuple(x for rows in self.made for number in self._matrices(rows) for x in number)
        return ConstantArray(self.name, values, False, self.count)

    def _matrices(self, rows: Sequence[Values]) -> Iterator[list[Fraction]]:
        number = len(rows) // self.size
        start = 1 if self.has_offsets else 0
        for m in range(number):
            own = [rows[i * number + m] for i in range(self.size)]
            result = [x for row in own for x in row[: self.count * start]]
            for i, row in enumerate(own):
                result += row[self.count * start : self.count * (start + i + 1)]
            yield result

    def loop(self, first: int, number: int, array: str, instance: str, names: Sequence[str]) -> ForEach:
        """The loop over some matrices for an instance, whose values go to the beginning of an array, row by row.

        names: those of the elements.
        """

        def entry(k: int) -> Expr:
            own = (IndexTerm(1, instance),) if self.count > 1 else ()
            terms = IndexTerm(self.count * self.columns, MATRIX), *own
            return Element(self.name, ElementIndex(self.count * (k + first * self.columns), terms))

        start = self.size if self.has_offsets else 0
        body = []
        for i in range(self.size):
            products = [
                Operation(Operator.MUL, (entry(start + packed(i, j)), ScalarRef(name))) for j, name in enumerate(names)
            ]
            total = reduce(lambda a, b: Operation(Operator.ADD, (a, b)), [*([entry(i)] if start else []), *products])
            to = Element(array, ElementIndex(i * number, (IndexTerm(1, MATRIX),)))
            body.append(StoreElement(to, total))
        return ForEach(MATRIX, constant(0), constant(number), tuple(body))
