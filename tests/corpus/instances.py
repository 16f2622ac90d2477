"""Elements of a scene as tables with a count of one, with the index in references and numbers, here and there."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

from corpus.draft import Table
from corpus.draws import Draws
from derive.spec.model.instances import COUNTED, instance_name
from derive.spec.tables.instance_tables import instance_tables

SHARE = 0.4
"""The share of the elements of a scene that have a count, if some have."""
NAMES = ("joint", "spring", "beam", "cut", "drive", "over", "input")
"""The keys whose values are names of elements."""
NUMBERS = ("mass", "inertia", "length", "bending_stiffness", "stiffness")


def count_some(tables: Table, draws: Draws, probability: float) -> None:
    """With that probability, give elements of a specification a count, and the index where they are referred to."""
    if not draws.chance(probability):
        return
    counted = {name for section in COUNTED for name in draws.some(_single(tables.get(section, {})), SHARE)}
    for section, table in tables.items():
        if section in COUNTED:
            for name, element in table.items():
                own = name in counted
                table[name] = _referring(element, "", counted, draws, own) | ({"count": 1} if own else {})
        elif isinstance(table, dict):
            tables[section] = _referring(table, "", counted, draws, own=False)
    for name in counted & tables.get("outputs", {}).keys():
        _rename_columns(tables, name)


def _single(section: Table) -> list[str]:
    """The elements of a section that have no count of their own."""
    return [name for name, element in section.items() if "count" not in element]


def expanded(tables: Table) -> Table:
    """The tables with all instances, as a file may contain them."""
    result: Table = _in_toml(instance_tables(tables).data)
    return result


def _in_toml(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _in_toml(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_in_toml(item) for item in value]
    return str(value) if isinstance(value, Fraction) else value


def _referring(value: Any, key: str, counted: set[str], draws: Draws, own: bool) -> Any:
    """A value with the index in its references; `own`: in a table with a count, and so perhaps as a formula."""
    if isinstance(value, dict):
        return {name: _referring(item, name, counted, draws, own) for name, item in value.items()}
    if isinstance(value, list):
        return [_referring(item, key, counted, draws, own) for item in value]
    if own and key in NUMBERS and isinstance(value, float) and draws.chance(0.5):
        return f"{value!r}*(i + 1)"
    if not isinstance(value, str):
        return value
    name, dot, marker = value.partition(".")
    if name not in counted or not (dot or key in NAMES):
        return value
    index = draws.choice(["0", "i"]) if own else "0"
    return f"{name}[{index}]{dot}{marker}"


def _rename_columns(tables: Table, output: str) -> None:
    """Give the columns of an output in plots and conditions the names that they have with an index."""

    def renamed(text: str) -> str:
        return re.sub(rf"\b{output}(?=_|\b)", instance_name(output, 0), text)

    if "until" in tables.get("simulation", {}):
        tables["simulation"]["until"] = renamed(tables["simulation"]["until"])
    for plot in tables.get("plots", {}).values():
        for axis in ("x", "y"):
            if axis in plot:
                columns = plot[axis]
                plot[axis] = renamed(columns) if isinstance(columns, str) else [renamed(column) for column in columns]
