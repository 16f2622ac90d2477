"""Changes of the unknowns of a symmetric system, in the entries of its matrix by rows and in its right-hand side."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

Entries = dict[tuple[int, int], ca.SX]
"""The entries of the lower triangle of a symmetric matrix."""
Columns = dict[int, dict[int, ca.SX]]
"""All entries of a symmetric matrix, by rows."""


def columns_of(entries: Mapping[tuple[int, int], ca.SX]) -> Columns:
    """All entries of a matrix, by rows, from those of its lower triangle."""
    columns: Columns = {}
    for (i, j), value in entries.items():
        columns.setdefault(i, {})[j] = value
        columns.setdefault(j, {})[i] = value
    return columns


def lower_triangle(columns: Columns) -> Entries:
    """The entries of the lower triangle."""
    return {(i, j): x for i, of in columns.items() for j, x in of.items() if i >= j}


@dataclass(frozen=True)
class AddedRow:
    """The row `source`, times a factor unless that is 1, added to the row `target`, and so the columns.

    The unknown of `source` then is its difference from `factor` times that of `target`.
    """

    source: int
    target: int
    factor: ca.SX | None = None

    def times(self, value: ca.SX) -> ca.SX:
        """The factor times a value."""
        return value if self.factor is None else self.factor * value

    def change(self, columns: Columns) -> None:
        """Change the entries of a matrix."""
        added = {j: self.times(x) for j, x in columns[self.source].items()}
        to = columns.setdefault(self.target, {})
        once = added.pop(self.target, None)
        for j, x in added.items():
            to[j] = columns[j][self.target] = to[j] + x if j in to else x
        again = self.times(to[self.source]) if self.source in to else None
        for part in (once, again):
            if part is not None:
                to[self.target] = to[self.target] + part if self.target in to else part

    def change_right(self, right: list[ca.SX]) -> None:
        """Change the right-hand side."""
        right[self.target] = right[self.target] + self.times(right[self.source])

    def recover(self, solution: list[ca.SX]) -> None:
        """Change the solution to that of the system before."""
        solution[self.source] = solution[self.source] + self.times(solution[self.target])
