"""Two columns of a CSV file: curves that plots are compared with, and tables; none of it is trusted."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping
from pathlib import Path

from derive.errors import quoted
from derive.spec.files.file_content import file_content
from derive.spec.parsing.faults import Faults, KeyPath, did_you_mean
from derive.spec.parsing.values import WrongValueError

MAX_BYTES = 5_000_000
LARGEST = 1e60
"""The largest absolute value of a number, as in a specification: products of larger ones overflow doubles."""
_NUMBER = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?")
_NEARLY_A_NUMBER = re.compile(r"[-+.,_eE0-9]{1,24}|[-+]?(nan|inf|infinity)", re.IGNORECASE)
"""A pattern of cells that messages may show: a reference may be any file, whose text must not appear in messages."""

Rows = tuple[tuple[float, float], ...]


def references(data: Mapping[str, object], folder: Path, known: Mapping[str, Rows]) -> tuple[dict[str, Rows], Faults]:
    """The curves of the plots that have a reference, and the faults of their files.

    Files are relative to `folder`; those of plots whose numbers are `known` are not read.
    """
    rows: dict[str, Rows] = {name: of for name, of in known.items() if of}
    faults = Faults()
    plots = data.get("plots")
    for name, plot in plots.items() if isinstance(plots, Mapping) else ():
        reference = plot.get("reference") if isinstance(plot, Mapping) else None
        if not isinstance(reference, Mapping) or name in rows:
            continue
        numbers = curve(reference, folder, ("plots", str(name), "reference"), faults)
        if numbers is not None:
            rows[str(name)] = numbers
    return rows, faults


def curve(table: Mapping[str, object], folder: Path, path: KeyPath, faults: Faults) -> Rows | None:
    """The columns `x` and `y` of the `file` of a table at `path`; None with faults, or if a key is missing."""
    file, columns = table.get("file"), [table.get(key) for key in ("x", "y")]
    if not isinstance(file, str) or not file:
        return None
    lines: list[tuple[int, list[str]]] = []
    with faults.at(*path, "file"):
        lines = csv_rows(file_content(file, folder, MAX_BYTES, ", the most that is read"), quoted(file))
    columns_found = []
    for key, column in zip(("x", "y"), columns, strict=True):
        with faults.at(*path, key):
            if lines and isinstance(column, str):
                columns_found.append(csv_column(column, lines, quoted(file)))
    if len(columns_found) == 2:
        with faults.at(*path, "file"):
            x, y = ([csv_number(row, column, at, quoted(file)) for at, row in lines[1:]] for column in columns_found)
            return tuple(zip(x, y, strict=True))
    return None


def csv_rows(content: bytes, file: str, noun: str = "curve", least: int = 2) -> list[tuple[int, list[str]]]:
    """The rows of a file with their line numbers, the header first, without comments and empty lines.

    file: its name in messages; noun, least: what is missing if there are fewer rows below the header.
    """
    try:
        lines = content.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise WrongValueError(f"{file} is not UTF-8 text; save it as a CSV file in UTF-8") from None
    kept = [(number, line) for number, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    try:
        rows = csv.reader((line for _, line in kept), strict=True)
        table = [(number, [cell.strip() for cell in next(rows)]) for number, _ in kept]
    except (csv.Error, StopIteration) as error:
        raise WrongValueError(f"{file} is no CSV file: {error}") from None
    if len(table) < least + 1:
        rows_needed = f"{('a row', 'two rows')[least - 1]} {('is', 'are')[least - 1]} needed"
        raise WrongValueError(f"{file} has no {noun}: a line with the names of the columns and {rows_needed}")
    return table


def csv_column(name: str, table: list[tuple[int, list[str]]], file: str) -> int:
    """The position of a column. Names of other columns are shown only if the file contains curves."""
    header = table[0][1]
    if header.count(name) > 1:
        raise WrongValueError(f"{file} has more than one column {quoted(name)}; rename one of them")
    if name not in header:
        numeric = [all(len(row) > i and _NUMBER.fullmatch(row[i]) for _, row in table[1:]) for i in range(len(header))]
        if sum(numeric) < 2:
            raise WrongValueError(
                f"{file} has no column {quoted(name)}, and no two columns of numbers; below a line with the names of "
                "the columns, rows of numbers are needed"
            )
        columns = f"its columns are {', '.join(quoted(column) for column in header[:20])}"
        raise WrongValueError(f"{file} has no column {quoted(name)}{did_you_mean(name, header, columns)}")
    return header.index(name)


def csv_number(row: list[str], column: int, line: int, file: str) -> float:
    """The number in a column of a row. Raises WrongValueError if it is none, or too large."""
    cell = row[column] if column < len(row) else ""
    value = float(cell) if _NUMBER.fullmatch(cell) else math.nan
    if not math.isfinite(value):
        shown = quoted(cell) if _NEARLY_A_NUMBER.fullmatch(cell) else f"the text in column {column + 1}"
        fault = f"{shown} is no finite number" if cell else f"there is no number in column {column + 1}"
        raise WrongValueError(f"line {line} of {file}: {fault}")
    if abs(value) > LARGEST:
        raise WrongValueError(
            f"line {line} of {file}: {quoted(cell)} is too large; numbers are at most {LARGEST:g} in size"
        )
    return value
