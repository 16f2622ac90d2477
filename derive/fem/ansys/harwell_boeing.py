"""Matrices in the format of Harwell and Boeing (TOMS 15, 1989): columns with the rows and values of their entries."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from scipy.sparse import csc_array, csr_array

from derive.errors import Problem
from derive.fem.entries import symmetric_from
from derive.fem.keyword_file import text_or_fault
from derive.fem.model import Array

_FORMAT = re.compile(r"(\d*)[IEDFG](\d+)", re.IGNORECASE)
"""How many numbers a line holds, and how wide each is, in a format of Fortran such as (10I8) or (1P,4D20.12)."""


def read_harwell_boeing(path: Path, problems: list[Problem]) -> csr_array | None:
    """The real matrix of a file, with both of its halves; None after a fault."""
    text = text_or_fault(path, problems, path.name)
    if text is None:
        return None
    lines = text.splitlines()
    try:
        counts = [int(lines[1][k : k + 14] or 0) for k in range(0, 70, 14)]
        kind, sizes = lines[2][:3].upper(), [int(lines[2][k : k + 14]) for k in (14, 28, 42)]
        formats = [lines[3][k : k + width] for k, width in ((0, 16), (16, 16), (32, 20))]
    except (IndexError, ValueError):
        problems.append(Problem(path.name, "the first four lines are not those of a matrix of Harwell and Boeing"))
        return None
    if kind not in ("RSA", "RUA") or sizes[0] != sizes[1]:
        text = f"the matrix has the type {kind} and the size {sizes[0]} x {sizes[1]}"
        problems.append(Problem(path.name, f"{text}; a real, assembled, square one is needed (RSA or RUA)"))
        return None
    first, parts = 5 if counts[4] else 4, []
    try:
        for length, layout in zip(counts[1:4], formats, strict=True):
            parts.append(_numbers(lines[first : first + length], layout))
            first += length
    except ValueError:
        problems.append(Problem(path.name, "a number of the matrix cannot be read; write it again with the form ASCII"))
        return None
    pointers, rows, values = parts[0].astype(np.int64) - 1, parts[1].astype(np.int64) - 1, parts[2]
    n = sizes[0]
    if len(pointers) != n + 1 or len(rows) != len(values) or pointers[-1] != len(rows) or rows.max(initial=0) >= n:
        problems.append(Problem(path.name, f"the file holds fewer entries than the {sizes[2]} it announces"))
        return None
    entries = csc_array((values, rows, pointers), shape=(n, n)).tocoo()
    return symmetric_from(entries.row.astype(np.int64), entries.col.astype(np.int64), entries.data, n)


def _numbers(lines: list[str], layout: str) -> Array:
    """The numbers of lines in a format of Fortran. Raises ValueError."""
    found = _FORMAT.search(layout)
    if found is None:
        raise ValueError(layout)
    width = int(found[2])
    words = [line[k : k + width] for line in lines for k in range(0, len(line.rstrip()), width)]
    return np.array([word.replace("D", "E").replace("d", "e") for word in words], dtype=np.float64)
