"""The places of the entries of square matrices that are packed for vectors, in blocks of four rows."""

from __future__ import annotations

from dataclasses import dataclass

from derive.ir.indices import LANES, ElementIndex, IndexTerm, Of, padded


@dataclass(frozen=True)
class Packing:
    """Square matrices of one size in one array, in groups that are read together, each in order from its first element.

    A group has blocks of four rows, in them the columns j, in them its matrices, in them the four rows. Rows and
    columns are padded with zeros to a multiple of four.
    """

    array: str
    count: int
    groups: tuple[tuple[str, ...], ...]

    @property
    def tables(self) -> tuple[str, ...]:
        """All matrices, in their order."""
        return tuple(table for group in self.groups for table in group)

    @property
    def padded(self) -> int:
        """The number of rows of a column, padded."""
        return padded(self.count)

    @property
    def size(self) -> int:
        """The number of elements of the array."""
        return len(self.tables) * self.padded**2

    def first(self, table: str) -> int:
        """The index of the first entry of a matrix."""
        before = 0
        for group in self.groups:
            if table in group:
                return before * self.padded**2 + group.index(table) * LANES
            before += len(group)
        raise KeyError(table)

    def stride(self, table: str) -> int:
        """The distance of the columns of a matrix in a block of rows."""
        return LANES * next(len(group) for group in self.groups if table in group)

    def block(self, table: str) -> int:
        """The distance of the blocks of rows of a matrix."""
        return self.stride(table) * self.padded

    def entry(self, table: str, i: str = "i", j: str = "j") -> ElementIndex:
        """The index of entry (i, j) of a matrix in the array."""
        return ElementIndex(self.first(table), (*self.column(table, i, j).terms, IndexTerm(1, i, Of.LANE)))

    def before(self, table: str, i: str = "i") -> ElementIndex:
        """The index of the first element of the block of row i of a matrix."""
        return ElementIndex(self.first(table), (IndexTerm(self.block(table), i, Of.BLOCK),))

    def column(self, table: str, i: str = "i", j: str = "j") -> ElementIndex:
        """The index of the first of the four entries of column j in that block."""
        return ElementIndex(self.first(table), (*self.before(table, i).terms, IndexTerm(self.stride(table), j)))

    def in_block(self, table: str, i: str = "i", j: str = "j") -> ElementIndex:
        """The index of entry (i, j) of a matrix, counted from the first element of the block."""
        return ElementIndex(0, (IndexTerm(self.stride(table), j), IndexTerm(1, i, Of.LANE)))
