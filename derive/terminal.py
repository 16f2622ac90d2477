"""Output on the terminal: a line of progress, which notebooks show as well, tables, wrapped sentences."""

from __future__ import annotations

import textwrap
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TypeVar

from derive.durations import duration_text
from derive.notebook_line import in_notebook
from derive.progress_line import PATIENCE, show_progress, show_result, timed_stages

WIDTH = 116
"""The characters of a line of prose."""


class SimulationProgress:
    """The line of progress of a simulation: `label`, the time that it has reached, and the estimated remaining time.

    It changes ten times a second at most. after: the time (s) for which nothing is shown.
    """

    def __init__(self, label: str, duration: float, after: float = 0.0) -> None:
        self._label, self._end, self._next = label, duration, 0.0
        self._first: tuple[float, float] | None = None
        self._line = DelayedLine(after)
        self._line.show(f"simulating {label}: preparing the run ...")

    def __call__(self, reached: float) -> None:
        """Show that the simulation has reached this time (s)."""
        now = time.monotonic()
        if self._first is None:
            self._first = now, reached
        if now >= self._next:
            self._next = now + 0.1
            reached = min(reached, self._end)
            remaining = self._remaining(now, reached)
            self._line.show(f"simulating {self._label}: {reached:.4g} of {self._end:g} s{remaining}")

    def _remaining(self, now: float, reached: float) -> str:
        """The remaining time at the average speed since the first step; empty while it cannot be estimated."""
        assert self._first is not None
        began, at = self._first
        if now - began < 1.0 or not at < reached < self._end:
            return ""
        return f", about {duration_text((self._end - reached) / (reached - at) * (now - began))} left"

    def end(self) -> None:
        """Remove the line."""
        self._line.end()


class DelayedLine:
    """A line of progress of which nothing is seen for the time `after` (s), so that short work shows none."""

    def __init__(self, after: float) -> None:
        self._text, self._since = "", time.perf_counter()
        self._visible, self._lock = after <= 0.0, threading.Lock()
        self._timer = threading.Timer(after, self._begin)
        self._timer.daemon = True
        if not self._visible:
            self._timer.start()

    def show(self, text: str) -> None:
        """Replace the text."""
        with self._lock:
            self._text, self._since = text, time.perf_counter()
            if self._visible:
                show_progress(text)

    def _begin(self) -> None:
        with self._lock:
            self._visible = True
            show_progress(self._text, self._since)

    def end(self) -> None:
        """Remove the line, if it is there."""
        self._timer.cancel()
        with self._lock:
            if self._visible:
                show_progress()
            self._visible, self._text = False, ""


class SampleProgress:
    """The line of progress of a sweep `name`: finished samples, and the estimated remaining time.

    after: the time (s) for which nothing is shown.
    """

    def __init__(self, name: str, after: float = 0.0) -> None:
        self._name, self._began = name, time.monotonic()
        self._first: int | None = None
        self._line = DelayedLine(after)

    def __call__(self, finished: int, total: int) -> None:
        """Show that `finished` of `total` samples are finished."""
        if self._first is None:
            self._first, self._began = finished, time.monotonic()
        passed, own = time.monotonic() - self._began, finished - self._first
        left = f", about {duration_text((total - finished) / own * passed)} left" if own and finished < total else ""
        self._line.show(f"{self._name}: {finished} of {total} samples{left}")

    def end(self) -> None:
        """Remove the line."""
        self._line.end()


Reporter = TypeVar("Reporter", SimulationProgress, SampleProgress)
Reported = TypeVar("Reported", bound=Callable[..., object])


@contextmanager
def progress_of(given: Reported | bool | None, line: Callable[[], Reporter]) -> Iterator[Reported | Reporter | None]:
    """The function to which work reports its progress: the given one, or that of a line, which is removed at the end.

    given: a function; True for a line of progress; None for one in a notebook alone; False for none.
    """
    if given is True or (given is None and in_notebook()):
        shown = line()
        try:
            with timed_stages():
                yield shown
        finally:
            shown.end()
    else:
        yield None if isinstance(given, bool) else given


Report = Callable[[str], None]
"""A function that takes a line of text on work that goes on."""


@contextmanager
def reports_of(given: Report | bool | None, of: str) -> Iterator[tuple[Report, Report]]:
    """The functions to which a study reports what it does, and the results of its steps.

    given: one function for both; True for a line of progress, beside which results are lines of their own where stderr
    is no tty; None for a line in a notebook alone, after a while; False for none. The line is removed at the end.
    of: the scene that is studied, which the texts do not name.
    """
    if callable(given):
        yield given, given
    elif given or (given is None and in_notebook()):
        line = DelayedLine(0.0 if given else PATIENCE)
        try:
            with timed_stages(of):
                yield line.show, show_result if given else line.show
        finally:
            line.end()
    else:
        yield _silent, _silent


def _silent(_: str) -> None:
    """Report nothing."""


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
