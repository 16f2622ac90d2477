"""The display of objects in notebooks: a higher layer registers a function, so that no lower layer imports it."""

from __future__ import annotations

from collections.abc import Callable

_functions: list[Callable[[object], str]] = []


def register(function: Callable[[object], str]) -> None:
    """Let a function write objects as HTML; the last one registered is used."""
    _functions.append(function)


def html(shown: object) -> str:
    """An object as HTML. Raises LookupError when no function is registered."""
    if not _functions:
        raise LookupError("no function that writes HTML is registered; `import derive` registers one")
    return _functions[-1](shown)
