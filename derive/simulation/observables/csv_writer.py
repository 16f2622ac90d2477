"""Named columns of numbers, and their text as a CSV file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

NUMBER_WIDTH = 18
"""The largest number of bytes of a number and its comma in a CSV file."""


@dataclass(frozen=True, eq=False)
class Column:
    """A column of a table: its name, its unit, its values (n,)."""

    name: str
    unit: str
    values: NDArray[np.float64]


def csv(columns: Sequence[Column]) -> str:
    """The text of a CSV file: a line of names, then the numbers; units are in the record of the run.

    Numbers have eleven digits, so that the same numbers give the same bytes anywhere. The file is read by
    `pandas.read_csv(path)` and by `numpy.genfromtxt(path, names=True, delimiter=",")`: comments before the names would
    need further arguments.
    """
    rows = np.column_stack([column.values for column in columns]) + 0.0  # no -0
    return "\n".join(
        [
            ",".join(column.name for column in columns),
            *(",".join([f"{value:.10e}" for value in row]) for row in rows.tolist()),
            "",
        ]
    )
