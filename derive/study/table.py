"""The table of all studies: columns that are declared once, and values, from which text, CSV, data and HTML follow.

HTML is made by the template `study/table.html.jinja` from `head`, `cells` and `footnotes`.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from enum import Enum
from math import isfinite
from typing import Any

import numpy as np

from derive.terminal import table, wrapped

Row = tuple[Any, ...]
"""A value for each column; None where there is none."""


@dataclass(frozen=True)
class StudyColumn:
    """A column: `name` is its key in CSV and plain data, `format` makes the text of a value.

    head: the heading in text and HTML, which is `name` by default. unit: printed below the heading. doc: the meaning of
    the column, printed below the table.
    """

    name: str
    format: Callable[[Any], str] = str
    head: str | None = None
    unit: str = ""
    doc: str = ""

    @property
    def heading(self) -> str:
        """The heading in text and HTML."""
        return self.name if self.head is None else self.head


@dataclass(frozen=True)
class StudyTable:
    """Columns and rows of values with a title above and notes below; the first `left` columns are left-aligned."""

    columns: tuple[StudyColumn, ...]
    rows: tuple[Row, ...]
    title: str = ""
    left: int = 1
    notes: tuple[str, ...] = ()

    @property
    def head(self) -> tuple[str, ...]:
        """The headings of the columns."""
        return tuple(column.heading for column in self.columns)

    @property
    def cells(self) -> list[list[str]]:
        """The texts of all values; empty where there is none."""
        return [
            ["" if value is None else column.format(value) for column, value in zip(self.columns, row, strict=True)]
            for row in self.rows
        ]

    @property
    def footnotes(self) -> tuple[str, ...]:
        """The meaning of the columns in a sentence, and the notes."""
        docs = "; ".join(f"{column.heading}: {column.doc}" for column in self.columns if column.doc)
        return (*([docs] if docs else []), *self.notes)

    @property
    def text(self) -> list[str]:
        """The lines for a terminal."""
        units = [[column.unit for column in self.columns]] if any(column.unit for column in self.columns) else []
        lines = table([list(self.head), *units, *self.cells], self.left)
        return [*([self.title] if self.title else []), *lines, *wrapped(self.footnotes, "  ")]

    @property
    def csv(self) -> str:
        """The CSV text: the names of the columns, and a line for each row with all digits."""
        stream = io.StringIO()
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(column.name for column in self.columns)
        writer.writerows(self.rows)
        return stream.getvalue()

    @property
    def data(self) -> list[dict[str, Any]]:
        """The rows as plain data, by the names of the columns."""
        return [named(self.columns, row) for row in self.rows]

    @property
    def reversed(self) -> StudyTable:
        """The table with its rows in reverse order."""
        return replace(self, rows=self.rows[::-1])

    def only(self, names: Sequence[str]) -> StudyTable:
        """The table with some of its columns, by their names, in the order of `names`."""
        at = {column.name: number for number, column in enumerate(self.columns)}
        rows = tuple(tuple(row[at[name]] for name in names) for row in self.rows)
        return replace(self, columns=tuple(self.columns[at[name]] for name in names), rows=rows)


def named(columns: Sequence[StudyColumn], row: Row) -> dict[str, Any]:
    """The values of a row as plain data, by the names of the columns."""
    return {column.name: plain(value) for column, value in zip(columns, row, strict=True)}


def columns(*heads: str, format: Callable[[Any], str] = str) -> tuple[StudyColumn, ...]:
    """Columns with these headings, which are their names as well, and one format."""
    return tuple(StudyColumn(head, format) for head in heads)


def fixed(digits: int) -> Callable[[float], str]:
    """The format with a number of digits behind the point; empty for a number that is not finite."""
    return lambda value: f"{value:.{digits}f}" if isfinite(value) else ""


def general(digits: int) -> Callable[[float], str]:
    """The format with a number of significant digits; empty for a number that is not finite."""
    return lambda value: f"{value:.{digits}g}" if isfinite(value) else ""


def plain(value: Any) -> Any:
    """A value of frozen types and arrays as plain data; a number that is not finite becomes None."""
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, dict):
        return {key: plain(x) for key, x in value.items()}
    if is_dataclass(value):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, np.ndarray | list | tuple):
        return [plain(x) for x in value]
    return None if isinstance(value, float) and not isfinite(value) else value
