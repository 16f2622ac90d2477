"""The durations of earlier stages of this user, kept in the cache: from them follows how long the next one takes.

A stage is known by the text of its line of progress, which names the specification. The C compiler, which also sees
texts that are new, is known by the time per byte that it took last.
"""

from __future__ import annotations

import json
from functools import cache as once

from derive import cache

NAME = cache.key("durations")
MOST = 1000
"""The number of durations that are kept: those of the last stages."""


def earlier(stage: str) -> float | None:
    """The time (s) that a stage took last time, or per unit of its size; None if it is not known."""
    return _known().get(_key(stage))


def keep(stage: str, seconds: float) -> None:
    """Keep the time of a stage, in place of that of last time."""
    known = {**_read(), _key(stage): seconds}
    cache.write(NAME, json.dumps(dict(list(known.items())[-MOST:])).encode())
    _known.cache_clear()


@once
def _known() -> dict[str, float]:
    """The durations by the keys of the stages; read once, since the line of progress asks for them each second."""
    return _read()


def _read() -> dict[str, float]:
    data = cache.read(NAME)
    return {} if data is None else dict(json.loads(data))


def _key(stage: str) -> str:
    return cache.key(stage)[:16]


def duration_text(seconds: float) -> str:
    """A duration in words with one or two units: "8 s", "3 min 20 s", "2 h 5 min"."""
    whole = max(1, round(seconds))
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
