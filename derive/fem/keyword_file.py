"""Input files of keywords, as CalculiX and Abaqus read them: `*KEYWORD, PARAMETER=VALUE`, and data in lines below."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from derive.errors import Problem, SpecError, quoted
from derive.spec.files.file_content import regular_file_start, unreadable

MAX_BYTES = 2_000_000_000
MAX_INCLUDES = 20
"""The depth to which files may include others."""


@dataclass(frozen=True)
class Card:
    """A keyword in capital letters, its parameters by their names in capital letters, and its lines of data.

    line: the line of the keyword in `source`, from 1.
    """

    keyword: str
    parameters: dict[str, str]
    line: int
    source: str
    included: bool = False
    lines: list[str] = field(default_factory=list)

    def fault(self, message: str) -> Problem:
        """A fault of this card; one of an included file names this file."""
        if self.included:
            return Problem(f"{self.source}:{self.line}: *{self.keyword}", message)
        return Problem(f"*{self.keyword}", message, self.line)


def read_text(path: Path) -> str:
    """The text of a file. Raises OSError and ValueError with a reason that `unreadable` words."""
    content = regular_file_start(path, MAX_BYTES + 1)
    if len(content) > MAX_BYTES:
        raise ValueError(f"it has more than {MAX_BYTES // 10**9} GB")
    return content.decode("utf-8", errors="replace")


def text_or_fault(path: Path, problems: list[Problem], where: str) -> str | None:
    """The text of a file; None, and a fault with the place that it is shown at, if it cannot be read."""
    try:
        return read_text(path)
    except (OSError, ValueError) as error:
        problems.append(Problem(where, unreadable(error)))
        return None


def required_text(path: Path) -> str:
    """The text of a file that a command names. Raises SpecError."""
    problems: list[Problem] = []
    text = text_or_fault(path, problems, "")
    if text is None:
        raise SpecError(tuple(problems), str(path))
    return text


def read_cards(path: Path, problems: list[Problem]) -> list[Card]:
    """The cards of a file and of those that it includes; files that cannot be read are faults."""
    text = text_or_fault(path, problems, "")
    return [] if text is None else list(_cards(text, path.name, path.parent, problems, 0))


def _cards(text: str, name: str, folder: Path, problems: list[Problem], depth: int) -> Iterator[Card]:
    lines = text.splitlines()
    card: Card | None = None
    number = 0
    while number < len(lines):
        line = lines[number].strip()
        number += 1
        if not line or line.startswith("**"):
            continue
        if not line.startswith("*"):
            if card is not None:
                card.lines.append(line)
            continue
        if card is not None:
            yield card
        first = number
        while line.endswith(",") and number < len(lines):  # parameters go on in the next line
            line += lines[number].strip()
            number += 1
        card = _card(line, first, name, depth > 0)
        if card.keyword == "INCLUDE":
            yield from _included(card, folder, problems, depth)
            card = None
    if card is not None:
        yield card


def _card(line: str, number: int, source: str, included: bool) -> Card:
    keyword, *parameters = (part.strip() for part in line[1:].split(","))
    pairs = (parameter.partition("=") for parameter in parameters if parameter)
    given = {name.strip().upper(): value.strip().strip('"') for name, _, value in pairs}
    return Card(" ".join(keyword.upper().split()), given, number, source, included)


def _included(card: Card, folder: Path, problems: list[Problem], depth: int) -> Iterator[Card]:
    name = card.parameters.get("INPUT")
    if not name:
        problems.append(card.fault("the file is missing: *INCLUDE, INPUT=mesh.inp"))
    elif depth == MAX_INCLUDES:
        problems.append(card.fault(f"files include each other more than {MAX_INCLUDES} times; end the circle"))
    else:
        try:
            text = read_text(folder / name)
        except (OSError, ValueError) as error:
            problems.append(card.fault(unreadable(error, name)))
            return
        yield from _cards(text, name, folder, problems, depth + 1)


def numbers_of(card: Card, problems: list[Problem]) -> NDArray[np.float64] | None:
    """All numbers of the data of a card, one after the other; None after a fault."""
    text = ",".join(line.rstrip(", ") for line in card.lines)
    try:
        return np.array(text.split(","), dtype=np.float64) if text else np.zeros(0)
    except ValueError:
        return _each_number(card, problems)


def _each_number(card: Card, problems: list[Problem]) -> NDArray[np.float64] | None:
    """The numbers with exponents of Fortran as well, and with fields that are empty as zeros."""
    result: list[float] = []
    for line in card.lines:
        for text in line.rstrip(", ").split(","):
            try:
                result.append(float(text.strip().upper().replace("D", "E") or 0))
            except ValueError:
                problems.append(card.fault(f"a number is needed in {quoted(line)}, not {quoted(text.strip())}"))
                return None
    return np.array(result)
