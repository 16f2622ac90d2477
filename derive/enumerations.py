"""Names in sentences."""

from __future__ import annotations

from collections.abc import Sequence


def enumeration(names: Sequence[str], most: int | None = None) -> str:
    """Names in a sentence: "a, b and c"; of more than `most`, the first of them and a number: "a, b and 7 more"."""
    if most is not None and len(names) > most:
        names = [*names[:most], f"{len(names) - most} more"]
    return " and ".join(filter(None, (", ".join(names[:-1]), *names[-1:])))
