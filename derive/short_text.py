"""Short texts of objects for `__repr__`: one to five lines of 100 characters at most; the rest is counted."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from fractions import Fraction
from typing import Any

WIDTH, LINES = 100, 5
"""The largest numbers of characters of a line and of lines of a text."""
MORE = " ..."
"""The end of a text that is shortened."""
MOST_ELEMENTS, MOST_LETTERS, MOST_DIGITS = 6, 48, 12
"""The most elements of a sequence, letters of a text and digits of an exact number that are shown."""


def summary(head: str, rows: Mapping[str, str] | None = None) -> str:
    """The text of an object: a line, and below it labelled rows, without those that are empty."""
    shown = {label: text for label, text in (rows or {}).items() if text}
    width = max(map(len, shown), default=0)
    lines = [head, *(f"  {label:<{width}}  {text}" for label, text in shown.items())]
    if len(lines) > LINES:
        lines = [*lines[: LINES - 1], f"  and {', '.join(list(shown)[LINES - 2 :])}"]
    return "\n".join(_shortened(line) for line in lines)


def _shortened(line: str) -> str:
    """A line that is cut between two words where it is too long."""
    line = " ".join(line.splitlines())
    if len(line) <= WIDTH:
        return line
    cut = line[: WIDTH - len(MORE)]
    return (cut[: cut.rindex(" ")] if " " in cut.strip() else cut).rstrip(" ,;") + MORE


def listed(names: Iterable[str], width: int = WIDTH - 20) -> str:
    """Names in a row, as many as there is room for, with the number of the others: "a, b and 12 more"."""
    every = list(names)
    room = width - len(f" and {len(every)} more")
    shown, size = 0, 0
    for name in every:
        size += len(name) + 2
        if size > room + 2:
            break
        shown += 1
    if shown == len(every):
        return ", ".join(every)
    return f"{', '.join(every[:shown])} and {len(every) - shown} more" if shown else f"{len(every)} of them"


def counted(count: int, noun: str, plural: str = "") -> str:
    """A number of things in words: "1 body", "3 bodies"."""
    return f"{count} {noun if count == 1 else plural or f'{noun}s'}"


def record_text(record: Any) -> str:
    """The text of a frozen type: its name, and its fields that differ from their defaults, in the form of a call."""
    shown = ((name, short_text(value)) for name, value in changed_fields(record))
    parts = [text if name == "name" else f"{name}={text}" for name, text in shown]
    text = f"{type(record).__name__}({', '.join(parts)})"
    lines = textwrap.wrap(
        text, WIDTH, subsequent_indent="  ", max_lines=LINES, placeholder=MORE, break_on_hyphens=False
    )
    return "\n".join(lines)


def changed_fields(record: Any) -> Iterator[tuple[str, Any]]:
    """The fields of a frozen type that differ from their defaults, with their values."""
    for field in fields(record):
        value = getattr(record, field.name)
        default = field.default_factory() if field.default_factory is not MISSING else field.default
        if default is MISSING or value is not default and not _equal(value, default):
            yield field.name, value


def _equal(value: Any, default: Any) -> bool:
    """Whether a value is its default; arrays, whose comparison is an array, have none."""
    return isinstance(value, type(default)) and bool(value == default)


def short_text(value: Any) -> str:
    """A value in a few words: exact numbers as decimals, arrays by their shape, sequences by their first elements."""
    match value:
        case Fraction():
            return number_text(value)
        case Enum():
            return str(value.value)
        case bool() | None | int():
            return repr(value)
        case float():
            return f"{value:.6g}"
        case str():
            return repr(value if len(value) <= MOST_LETTERS else f"{value[: MOST_LETTERS - 3]}...")
        case Mapping():
            return f"{{{_elements([f'{key}: {short_text(item)}' for key, item in value.items()])}}}"
        case tuple() | list():
            return f"({_elements([_element(item) for item in value])})"
    shape = getattr(value, "shape", None)
    if isinstance(shape, tuple):
        return f"<array {' x '.join(map(str, shape))}>"
    head, *more = (str(value) if is_dataclass(value) else repr(value)).splitlines()
    return f"<{head}>" if more and not head.endswith(",") else " ".join([head, *map(str.strip, more)])


def vector_text(values: Iterable[float]) -> str:
    """The elements of a vector with four digits, as many as there is room for."""
    return f"[{listed(f'{value:.4g}' for value in values)}]"


def _element(item: Any) -> str:
    """An element of a sequence: its name if it has one."""
    name = getattr(item, "name", None)
    return name if isinstance(name, str) and is_dataclass(item) else short_text(item)


def _elements(texts: Sequence[str]) -> str:
    if len(texts) <= MOST_ELEMENTS:
        return ", ".join(texts)
    return f"{', '.join(texts[: MOST_ELEMENTS - 1])}, ... {len(texts)} in all"


def number_text(value: Fraction) -> str:
    """An exact number: whole, as a decimal or as a fraction where that is short, else rounded to six digits."""
    decimal = f"{float(value):.6g}"
    if Fraction(decimal) == value or len(str(value)) > MOST_DIGITS:
        return decimal
    return str(value)


def full_text(value: Any) -> str:
    """All fields of frozen types as text, whatever their `__repr__` leaves out: equal values have equal texts."""
    if is_dataclass(value) and not isinstance(value, type):
        items = (f"{field.name}={full_text(getattr(value, field.name))}" for field in fields(value))
        return f"{type(value).__name__}({', '.join(items)})"
    if isinstance(value, tuple | list):
        return f"[{', '.join(map(full_text, value))}]"
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{full_text(key)}: {full_text(item)}' for key, item in value.items())}}}"
    return repr(value)
