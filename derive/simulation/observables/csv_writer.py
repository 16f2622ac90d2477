"""Named columns of numbers, and their text as a CSV file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from derive.artifacts import MARK


@dataclass(frozen=True, eq=False)
class Column:
    """A column of a table: its name, its unit, its values (n,)."""

    name: str
    unit: str
    values: NDArray[np.float64]


def csv(title: str, columns: Sequence[Column]) -> str:
    """The text of a CSV file: two lines of comment with title and units, a line of names, then the numbers.

    Numbers have eleven digits, so that the same numbers give the same bytes anywhere. Read it with
    `pandas.read_csv(path, comment="#")` or `numpy.genfromtxt(path, delimiter=",", names=True, skip_header=2)`.
    """
    rows = np.column_stack([column.values for column in columns]) + 0.0  # no -0
    return "\n".join(
        [
            f"# {MARK}. {' '.join(title.split())}",
            f"# units: {','.join(column.unit for column in columns)}",
            ",".join(column.name for column in columns),
            *(",".join([f"{value:.10e}" for value in row]) for row in rows.tolist()),
            "",
        ]
    )
