"""Output on the terminal: a line of progress, tables, wrapped sentences."""

from __future__ import annotations

import sys
import textwrap
import time
from collections.abc import Iterable, Sequence

WIDTH = 116
"""The characters of a line of prose."""


def show_progress(text: str = "") -> None:
    """Replace the line of progress on stderr; an empty text removes it. Nothing is written where stderr is no tty."""
    if sys.stderr.isatty():
        sys.stderr.write(f"\r{text}\x1b[K")
        sys.stderr.flush()


def show_result(text: str) -> None:
    """Show the result of a step of a long command: as a line on stderr or, on a tty, as the line of progress."""
    if sys.stderr.isatty():
        show_progress(text)
    else:
        print(text, file=sys.stderr, flush=True)


class SimulationProgress:
    """The line of progress of a simulation: `label`, the time that it has reached, and the estimated remaining time.

    It changes ten times a second at most.
    """

    def __init__(self, label: str, duration: float) -> None:
        self._label, self._end, self._next = label, duration, 0.0
        self._first: tuple[float, float] | None = None
        show_progress(f"simulating {label}: compiling ...")

    def __call__(self, reached: float) -> None:
        """Show that the simulation has reached this time (s)."""
        now = time.monotonic()
        if self._first is None:
            self._first = now, reached
        if now >= self._next:
            self._next = now + 0.1
            reached = min(reached, self._end)
            remaining = self._remaining(now, reached)
            show_progress(f"simulating {self._label}: {reached:.4g} of {self._end:g} s{remaining}")

    def _remaining(self, now: float, reached: float) -> str:
        """The remaining time at the average speed since the first step; empty while it cannot be estimated."""
        assert self._first is not None
        began, at = self._first
        if now - began < 1.0 or not at < reached < self._end:
            return ""
        return f", about {duration_text((self._end - reached) / (reached - at) * (now - began))} left"

    def end(self) -> None:
        """Remove the line."""
        show_progress()


def duration_text(seconds: float) -> str:
    """A duration in words with one or two units: "8 s", "3 min 20 s", "2 h 5 min"."""
    whole = max(1, round(seconds))
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


def table(rows: Sequence[Sequence[str]], left: int = 1) -> list[str]:
    """The lines of a table: the first `left` columns left-aligned, the others right-aligned; rows may be short."""
    widths = [max(len(row[i]) for row in rows if i < len(row)) for i in range(max(map(len, rows)))]
    lines = (
        "  ".join(f"{c:<{w}}" if i < left else f"{c:>{w}}" for i, (c, w) in enumerate(zip(row, widths, strict=False)))
        for row in rows
    )
    return [f"  {line}".rstrip() for line in lines]


def wrapped(sentences: Iterable[str], indent: str = "") -> list[str]:
    """The lines of sentences, each of which starts on a new line."""
    return [
        line
        for sentence in sentences
        for line in textwrap.wrap(sentence, WIDTH, initial_indent=indent, subsequent_indent=f"{indent}  ")
    ]


def beam_count(pieces: int) -> str:
    """A number of beams in words: "1 beam", "3 beams"."""
    return f"{pieces} beam{'s' if pieces > 1 else ''}"


def magnitude(value: float) -> str:
    """A number with two significant digits, in exponential notation; "0" for zero."""
    return f"{value:.1e}" if value else "0"
