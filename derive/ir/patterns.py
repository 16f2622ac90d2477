"""Sparsity: the compressed columns of a matrix, and groups of equal columns whose size is the number of modes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import accumulate
from typing import TYPE_CHECKING, assert_never

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from scipy.sparse import csc_array


class RowSetKind(Enum):
    """The dependence of the rows of a column on its index in a group; the values are those of the generated Python."""

    ROW = "row"
    DIAGONAL = "diagonal"
    RANGE = "range"
    TRIANGLE = "triangle"


@dataclass(frozen=True)
class RowSet:
    """Rows that each column j of a group has.

    ROW is the row `first`, DIAGONAL the row first + j, RANGE are `count` rows from `first` on, TRIANGLE those of a
    lower triangle, first + j to first + count - 1.
    """

    kind: RowSetKind
    first: int
    count: int = 1

    def rows(self, j: int) -> range:
        """The rows in column j of the group."""
        match self.kind:
            case RowSetKind.ROW:
                return range(self.first, self.first + 1)
            case RowSetKind.DIAGONAL:
                return range(self.first + j, self.first + j + 1)
            case RowSetKind.RANGE:
                return range(self.first, self.first + self.count)
            case RowSetKind.TRIANGLE:
                return range(self.first + j, self.first + self.count)
            case _:
                assert_never(self.kind)


@dataclass(frozen=True)
class ColumnGroup:
    """`count` columns that are alike, with their pieces from the first row to the last."""

    count: int
    pieces: tuple[RowSet, ...]


@dataclass(frozen=True)
class Pattern:
    """Compressed columns of a sparse matrix; of a symmetric one the lower triangle is stored.

    `groups` describes it in a few words where it has blocks whose size is the number of shapes.
    """

    rows: int
    cols: int
    colptr: tuple[int, ...]
    rowidx: tuple[int, ...]
    symmetric: bool
    groups: tuple[ColumnGroup, ...] = ()

    @cached_property
    def entries(self) -> tuple[tuple[int, int], ...]:
        """(row, column) of each stored value, in the order of the values."""
        return tuple((self.rowidx[k], j) for j in range(self.cols) for k in range(self.colptr[j], self.colptr[j + 1]))

    @property
    def full_nnz(self) -> int:
        """The number of structural non-zeros of the whole matrix, both triangles counted."""
        return len(self.rowidx) + sum(i != j for i, j in self.entries if self.symmetric)

    def dense(self, values: ArrayLike) -> NDArray[np.float64]:
        """The matrices (..., rows, cols) of `values` (..., nnz), both triangles of a symmetric pattern.

        Raises ValueError if the last axis of `values` does not have one element for each entry.
        """
        numbers = self._checked(values)
        full = np.zeros((*numbers.shape[:-1], self.rows, self.cols))
        rows, cols = self._indices()
        full[..., rows, cols] = numbers
        if self.symmetric:
            full[..., cols, rows] = numbers
        return full

    def sparse(self, values: ArrayLike) -> csc_array:
        """The matrix (rows, cols) of `values` (nnz,) in SciPy's compressed columns, both triangles of a symmetric one.

        All structural non-zeros are stored, also those whose value is 0. Raises ValueError as `dense`, and if `values`
        is not one vector.
        """
        from scipy.sparse import csc_array  # generating code does not need it, whose import takes a tenth of a second

        numbers = self._checked(values)
        if numbers.ndim != 1:
            raise ValueError(f"a sparse matrix takes one vector of values, not an array of shape {numbers.shape}")
        rows, cols = self._indices()
        if self.symmetric:
            below = rows != cols
            rows, cols = np.concatenate([rows, cols[below]]), np.concatenate([cols, rows[below]])
            numbers = np.concatenate([numbers, numbers[below]])
        return csc_array((numbers, (rows, cols)), shape=(self.rows, self.cols))

    def among(self, first: int, columns: int) -> Pattern:
        """The pattern of a matrix with so many columns, of which those from `first` on are the columns of this one."""
        before, after = (0,) * first, (len(self.rowidx),) * (columns - first - self.cols)
        return Pattern(self.rows, columns, (*before, *self.colptr, *after), self.rowidx, symmetric=False)

    def _checked(self, values: ArrayLike) -> NDArray[np.float64]:
        numbers = np.asarray(values, dtype=np.float64)
        if numbers.ndim == 0 or numbers.shape[-1] != len(self.rowidx):
            raise ValueError(f"this pattern has {len(self.rowidx)} entries; the values have shape {numbers.shape}")
        return numbers

    def _indices(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Row and column (nnz,) of each stored value."""
        cols = np.repeat(np.arange(self.cols, dtype=np.intp), np.diff(self.colptr))
        return np.array(self.rowidx, dtype=np.intp), cols


def pattern(rows: int, cols: int, entries: set[tuple[int, int]], symmetric: bool = False) -> Pattern:
    """The compressed columns of a set of (row, column)."""
    columns: list[list[int]] = [[] for _ in range(cols)]
    for i, j in entries:
        columns[j].append(i)
    colptr = tuple(accumulate(map(len, columns), initial=0))
    return Pattern(rows, cols, colptr, tuple(i for column in columns for i in sorted(column)), symmetric)


def block_pattern(rows: int, groups: tuple[ColumnGroup, ...], symmetric: bool = False) -> Pattern:
    """The compressed columns of groups of columns."""
    columns = [[i for piece in g.pieces for i in piece.rows(j)] for g in groups for j in range(g.count)]
    colptr = tuple(accumulate(map(len, columns), initial=0))
    return Pattern(rows, len(columns), colptr, tuple(i for c in columns for i in c), symmetric, groups)
