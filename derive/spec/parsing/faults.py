"""Faults of the data of a specification: their paths, their collection, the lines of their keys, and suggestions."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import lru_cache
from typing import NamedTuple, TypeVar

from derive.errors import printable, quoted
from derive.spec.parsing.names import INDEX_PATTERN
from derive.spec.parsing.other_words import meant_name
from derive.spec.parsing.values import WrongValueError

Result = TypeVar("Result")
KeyPath = tuple[str | int, ...]

MAX_NAMES = 100
"""The largest number of names that a message lists."""


class Fault(NamedTuple):
    """A fault in the data, with its path; the empty path refers to the data as a whole."""

    path: KeyPath
    message: str


class Faults(list[Fault]):
    """The list of faults collected so far."""

    @contextmanager
    def at(self, *path: str | int) -> Iterator[None]:
        """Collect a fault that is raised in the context at a path, and continue behind the context."""
        try:
            yield
        except WrongValueError as error:
            self.append(Fault(path, str(error)))


def readable(reader: Callable[[object], Result], value: object) -> Result | None:
    """The result of `reader`; None if the value is faulty, which another check reports."""
    try:
        return reader(value)
    except ValueError:
        return None


def path_text(path: KeyPath) -> str:
    """A path as messages show it: beam.ansatz[2], beam.markers."left end"."""
    text = ""
    for part in path:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            key = printable(part[:60])
            plain = re.fullmatch(f"[A-Za-z0-9_-]+({INDEX_PATTERN})?", key)
            text += "." * bool(text) + (key if plain else f'"{key}"')
    return text


def line_of(path: KeyPath, lines: Mapping[KeyPath, int]) -> int | None:
    """The line of a key, or of the nearest key that encloses it; None if nothing does."""
    for length in range(len(path), 0, -1):
        if path[:length] in lines:
            return lines[path[:length]]
    return None


def unknown_key(key: str, known: Iterable[str]) -> str:
    """The message on an unknown key; `known` are the keys that are allowed in its table."""
    keys = list(known)
    return "unknown key" + similar_name(key, keys, f"the keys here are {', '.join(keys)}")


def similar_name(name: str, known: Collection[str], otherwise: str) -> str:
    """The hint on an unknown key or choice, like `did_you_mean`, which also knows other words for them."""
    meant = meant_name(name, known)
    return did_you_mean(name, known, otherwise) if meant is None else f"; did you mean {quoted(meant)}?"


@lru_cache(64)
def _close_matches(asked: str, known: tuple[str, ...]) -> list[str]:
    """Up to two known names that resemble one, which the instances of a table may all have in common."""
    return difflib.get_close_matches(asked, known, n=2)


def names_text(names: Iterable[str]) -> str:
    """Names in a message; of very many only the first and the last."""
    names = [*names]
    return ", ".join(names if len(names) <= MAX_NAMES else [*names[:3], "...", names[-1]])


def did_you_mean(name: str, known: Iterable[str], otherwise: str = "") -> str:
    """The hint on an unknown name: one or two known names that resemble it, or `otherwise`, if given."""
    lower = {name_known.lower(): name_known for name_known in known}
    asked = name[:40].lower()
    if near := _close_matches(asked, tuple(lower)):
        first, last = (difflib.SequenceMatcher(None, asked, match).ratio() for match in (near[0], near[-1]))
        alike = near if first - last < 0.03 else near[:1]  # `masss` is as near to `mass` as to `masses`
        return f"; did you mean {' or '.join(quoted(lower[match]) for match in alike)}?"
    return otherwise and f"; {otherwise}"
