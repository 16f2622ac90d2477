"""Files of matrices by their entries: lines with a row, a column and a value, read at once."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array, csr_array

from derive.errors import Problem
from derive.fem.keyword_file import text_or_fault
from derive.fem.model import Array, Indices


def read_rows(path: Path, columns: int, problems: list[Problem], content: str | None = None) -> Array | None:
    """The numbers of a text file with so many in each line, (lines, columns); None after a fault.

    content: the text of the file, if it has been read.
    """
    text = text_or_fault(path, problems, path.name) if content is None else content
    if text is None:
        return None
    if not text.strip():
        problems.append(Problem(path.name, "the file is empty; the program has not finished, or stopped with an error"))
        return None
    try:
        rows = np.loadtxt(io.StringIO(text), dtype=np.float64, comments=None, ndmin=2)
    except ValueError:
        rows = np.zeros((0, 0))
    if rows.shape[1] != columns:
        problems.append(Problem(path.name, f"line {_other_line(text, columns)} does not hold {columns} numbers"))
        return None
    if not np.isfinite(rows).all():
        line = int(np.flatnonzero(~np.isfinite(rows).all(axis=1))[0]) + 1
        problems.append(Problem(path.name, f"line {line} holds a number that is NaN or infinite"))
        return None
    return rows


def _other_line(text: str, columns: int) -> int:
    """The first line, from 1, that does not hold so many numbers."""
    for number, line in enumerate(text.splitlines(), 1):
        parts = line.split()
        try:
            count = len([float(part) for part in parts])
        except ValueError:
            return number
        if parts and count != columns:
            return number
    return 1


def indices_of(rows: Array, path: Path, size: int, problems: list[Problem]) -> tuple[Indices, Indices] | None:
    """The rows and columns, counted from 0, of entries whose files count from 1; None after a fault.

    size: that of the matrix.
    """
    pairs = rows[:, :2]
    bad = (pairs != np.floor(pairs)) | (pairs < 1) | (pairs > size)
    if bad.any():
        line = int(np.flatnonzero(bad.any(axis=1))[0])
        row, column = (f"{value:.15g}" for value in pairs[line])
        text = f"line {line + 1} is an entry in row {row} and column {column}, and the matrix has the size {size}"
        problems.append(Problem(path.name, text))
        return None
    return pairs[:, 0].astype(np.int64) - 1, pairs[:, 1].astype(np.int64) - 1


def from_triangle(row: Indices, column: Indices, value: Array, size: int) -> csr_array:
    """The symmetric matrix (size, size) of the entries of one of its halves, without those that are zero."""
    kept = value != 0
    half = coo_array((value[kept], (row[kept], column[kept])), shape=(size, size))
    beside = half.row != half.col
    rows, columns = np.concatenate([half.row, half.col[beside]]), np.concatenate([half.col, half.row[beside]])
    return csr_array(coo_array((np.concatenate([half.data, half.data[beside]]), (rows, columns)), shape=(size, size)))


def symmetric_from(row: Indices, column: Indices, value: Array, size: int) -> csr_array:
    """The matrix (size, size) of entries of which there is one half, or of all of them."""
    if (row > column).any() and (row < column).any():
        return csr_array(coo_array((value, (row, column)), shape=(size, size)))
    return from_triangle(row, column, value, size)
