"""Rows on the instances of a specification: successive instances that differ in their index alone are one row."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from derive.enumerations import enumeration
from derive.spec.model.instances import InstanceName, instance_name, instance_parts, skeleton, text_of_instances

Row = Sequence[str]
DIFFERENT = "..."


def merged_rows(rows: Sequence[Row]) -> list[list[str]]:
    """The rows with one for successive instances that differ in their index alone, which is i there.

    The first cell of a row is the name.
    """
    result: list[list[str]] = []
    for (table, _), group in groupby(rows, key=_form):
        alike = list(group)
        result += _merged(alike) if table else map(list, alike)
    return result


def enumeration_of_instances(names: Sequence[str]) -> str:
    """Names as in a sentence, with one text for successive instances: link[1] to link[99] and last."""
    parts: list[str] = []
    for (table, _), group in groupby(enumerate(map(instance_parts, names)), key=_run):
        run = [names[k] for k, _ in group]
        parts += [f"{run[0]} to {run[-1]}"] if table and len(run) > 2 else run
    return enumeration(parts)


def _run(numbered: tuple[int, InstanceName]) -> tuple[str, int]:
    """The key of a run of successive instances of a table; that of another name is its own."""
    place, name = numbered
    return ("", place) if name.index is None or name.ending else (name.table, name.index - place)


def _form(row: Row) -> tuple[str, tuple[str, ...]]:
    parts = instance_parts(row[0])
    return ("" if parts.ending else parts.table), tuple(map(skeleton, row[1:]))


def _merged(rows: Sequence[Row]) -> list[list[str]]:
    """The rows of instances of a table whose cells differ in numbers at most."""
    names = [instance_parts(row[0]) for row in rows]
    first, count = names[0].index or 0, len(rows)
    cells = [text_of_instances([row[k] for row in rows], first) for k in range(1, len(rows[0]))]
    successive = [name.index for name in names] == [*range(first, first + count)]
    if count == 1 or not successive or any(DIFFERENT in cell for cell in cells):
        return [[*row] for row in rows]
    table = names[0].table
    return [[f"{instance_name(table, 'i')}, i = {first} to {first + count - 1}", *cells]]
