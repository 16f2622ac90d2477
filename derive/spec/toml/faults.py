"""Faults of the data of a specification, collected while it is looked at."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import NamedTuple, TypeVar

from derive.errors import quoted
from derive.spec.toml.values import WrongValueError

Result = TypeVar("Result")
KeyPath = tuple[str | int, ...]


class Fault(NamedTuple):
    """What is wrong at a path of the data; the empty path is the whole of it."""

    path: KeyPath
    message: str


class Faults(list[Fault]):
    """The faults found so far."""

    @contextmanager
    def at(self, *path: str | int) -> Iterator[None]:
        """What is wrong within becomes a fault at the path, and the search goes on behind it."""
        try:
            yield
        except WrongValueError as error:
            self.append(Fault(path, str(error)))


def readable(reader: Callable[[object], Result], value: object) -> Result | None:
    """What a value means; None if it is faulty, which is said elsewhere."""
    try:
        return reader(value)
    except ValueError:
        return None


def unknown_key(key: str, known: Iterable[str]) -> str:
    """What to say of a key that nobody knows."""
    keys = list(known)
    return "unknown key" + did_you_mean(key, keys, f"the keys here are {', '.join(keys)}")


def did_you_mean(name: str, known: Iterable[str], otherwise: str) -> str:
    """The end of a sentence on a name that nobody knows: the one that is near it, or something else."""
    lower = {one.lower(): one for one in known}
    near = difflib.get_close_matches(name[:40].lower(), lower, n=1)
    return f"; did you mean {quoted(lower[near[0]])}?" if near else f"; {otherwise}"
