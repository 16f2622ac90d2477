"""Bulk data of Nastran: cards in free fields, fields of 8 columns, and fields of 16 columns with an asterisk."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

SMALL, LARGE, FIRST = 8, 16, 8
"""The widths of fields, and that of the first field of a line."""

_EXPONENT = re.compile(r"(?<=[\d.])([+-]\d+)$")
"""The exponent of a number without the letter E, such as 2.1+11."""


@dataclass(frozen=True)
class BulkCard:
    """The name of a card in capital letters, its fields behind it ("" if empty), and its line, from 1."""

    name: str
    fields: tuple[str, ...]
    line: int

    def field(self, number: int) -> str:
        """A field by its number, where 2 is the one behind the name; "" beyond the last."""
        return self.fields[number - 2] if number - 2 < len(self.fields) else ""


def real(text: str) -> float:
    """A number, also with an exponent without a letter or with that of Fortran. Raises ValueError."""
    return float(_EXPONENT.sub(r"e\1", text.upper().replace("D", "E")))


def bulk_cards(text: str, wanted: Iterable[str]) -> Iterator[BulkCard]:
    """Yield the cards of the wanted names, from BEGIN BULK on if that is there."""
    names = frozenset(wanted)
    lines = text.splitlines()
    start = next((n for n, line in enumerate(lines) if " ".join(line.upper().split()).startswith("BEGIN BULK")), -1)
    name, fields, first = "", list[str](), 0
    for number, line in enumerate(lines[start + 1 :], start + 2):
        line = line.split("$", 1)[0].rstrip()  # noqa: PLW2901
        if not line:
            continue
        if line[0] in "+* ,":
            if name in names:
                fields += _padded(_fields(line))
            continue
        if name in names:
            yield BulkCard(name, tuple(fields), first)
        own = _fields(line)
        name = _name(line)
        fields, first = (_padded(own) if name in names else []), number
        if name == "ENDDATA":
            return
    if name in names:
        yield BulkCard(name, tuple(fields), first)


def _name(line: str) -> str:
    head = line.split(",", 1)[0] if "," in line[: FIRST + 1] else line[:FIRST]
    return head.strip().rstrip("*").strip().upper()


def _fields(line: str) -> list[str]:
    """The fields of a line behind the first, without that of the continuation."""
    if "," in line:
        return [field.strip() for field in line.split(",")[1:9]]
    if "*" in line[:FIRST]:
        return [line[k : k + LARGE].strip() for k in range(FIRST, FIRST + 4 * LARGE, LARGE)]
    return [line[k : k + SMALL].strip() for k in range(FIRST, FIRST + 8 * SMALL, SMALL)]


def _padded(fields: list[str]) -> list[str]:
    """The fields of a line with the empty ones at its end: 8, or 4 of 16 columns."""
    return fields + [""] * (-len(fields) % 4)
