"""What messages suggest in place of an unknown name."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from derive.errors import quoted


def unknown_key(key: str, known: Iterable[str]) -> str:
    """The message on an unknown key; `known` are the keys that are allowed there."""
    keys = list(known)
    return "unknown key" + did_you_mean(key, keys, f"the keys here are {', '.join(keys)}")


def did_you_mean(name: str, known: Iterable[str], otherwise: str) -> str:
    """The end of a sentence on an unknown name: the known name that resembles it, or `otherwise`."""
    lower = {name_known.lower(): name_known for name_known in known}
    near = difflib.get_close_matches(name[:40].lower(), lower, n=1)
    return f"; did you mean {quoted(lower[near[0]])}?" if near else f"; {otherwise}"
