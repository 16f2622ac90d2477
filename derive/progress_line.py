"""The line of progress on a terminal or in a notebook, and the times that it adds to stages without a count."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import copy_context

from derive import durations
from derive.durations import duration_text
from derive.notebook_line import LINE, in_notebook

PATIENCE = 2.0
"""The time (s) from which a stage is long: its time is stated and kept, and functions of Python show their progress."""

SECOND = 1.0
"""The time (s) between two texts of `timed_stages`."""

UNFINISHED = " ..."
"""The end of the text of a stage whose duration is not known: `timed_stages` adds a time to it."""


def show_progress(text: str = "", since: float | None = None) -> None:
    """Replace the line of progress; an empty text removes it.

    It is an output of the cell in a notebook, and a line on stderr otherwise; nothing is written where stderr is no
    tty. The duration of a stage that ends without an error is kept, if it is long, for the remaining time of the next
    one. since: when the stage of this text began (s), if that is not now.
    """
    now = time.perf_counter()
    with _STAGE.lock:
        ended, passed = _STAGE.text, now - _STAGE.since
        _STAGE.text, _STAGE.since = text, now if since is None else since
        _write_progress(text)
    if ended.endswith(UNFINISHED):
        _keep(_STAGE.of + ended, passed)


def _keep(name: str, passed: float) -> None:
    """Keep the time of a stage or a task, if it is long and no error has ended it."""
    if passed >= PATIENCE and sys.exc_info()[0] is None:
        durations.keep(name, passed)


def _write_progress(text: str) -> None:
    """Write a text where it is seen, that of an unfinished stage with its time."""
    if not _is_seen():
        return
    if text.endswith(UNFINISHED) and (added := _time_of_stage(time.perf_counter())):
        text = f"{text.removesuffix(UNFINISHED)}, {added}{UNFINISHED}"
    if in_notebook():
        LINE.show(text)
    else:
        sys.stderr.write(f"\r{text}\x1b[K")
        sys.stderr.flush()


def _is_seen() -> bool:
    return in_notebook() or sys.stderr.isatty()


def show_result(text: str) -> None:
    """Show the result of a step of long work: as the line of progress, or as a line on stderr if that is no tty."""
    if _is_seen():
        show_progress(text)
    else:
        print(text, file=sys.stderr, flush=True)


class _Stage:
    """The line of progress that is there: its text, and when it began.

    of: what the stages belong to, with which their times are kept. task: a task of several stages whose time is stated
    in place of theirs, and when it began. work: work whose duration follows from its size, when it began, and how long
    it takes (s).
    """

    def __init__(self) -> None:
        self.text, self.since, self.lock = "", time.perf_counter(), threading.RLock()
        self.of = ""
        self.task: tuple[str, float] | None = None
        self.work: tuple[str, float, float] | None = None
        self.ticker: tuple[threading.Event, threading.Thread] | None = None


_STAGE = _Stage()


@contextmanager
def timed_stages(of: str = "") -> Iterator[None]:
    """Meanwhile a line of progress that ends with " ..." states each second the remaining time, or the time so far.

    The remaining time follows from how long the same stage took last time; it is for stages without a count, such as a
    derivation. It needs a thread, which rests while a process is forked. Nothing is done where no line is seen.

    of: what the stages belong to, such as a specification that their texts do not name.
    """
    if _STAGE.ticker is not None or not _is_seen():
        yield
        return
    _STAGE.of = of
    _start_ticker()
    try:
        yield
    finally:
        _stop_ticker()
        _STAGE.ticker, _STAGE.of = None, ""


@contextmanager
def timed_task(name: str) -> Iterator[None]:
    """A task whose number of stages is not known: the line states its time in place of that of its stages."""
    began = time.perf_counter()
    _STAGE.task = name, began
    try:
        yield
    finally:
        _STAGE.task = None
    _keep(name, time.perf_counter() - began)


def _start_ticker() -> None:
    ended = threading.Event()
    thread = threading.Thread(target=copy_context().run, args=(_state_times, ended), daemon=True)
    _STAGE.ticker = ended, thread
    thread.start()


def _stop_ticker() -> None:
    """End the thread; the stage keeps it, so that it begins again after a fork."""
    if _STAGE.ticker is not None:
        ended, thread = _STAGE.ticker
        ended.set()
        thread.join()


def _resume_ticker() -> None:
    if _STAGE.ticker is not None:
        _start_ticker()


def _forget_ticker() -> None:
    _STAGE.ticker = None


if hasattr(os, "register_at_fork"):  # not on Windows, which has no forks
    os.register_at_fork(before=_stop_ticker, after_in_parent=_resume_ticker, after_in_child=_forget_ticker)


def _state_times(ended: threading.Event) -> None:
    """Write a line of an unfinished stage again each second, with its time, until the event."""
    while not ended.wait(SECOND):
        with _STAGE.lock:
            if _STAGE.text.endswith(UNFINISHED):
                _write_progress(_STAGE.text)


def _time_of_stage(now: float) -> str:
    """The remaining time, if the stage or its present work are known, or the time so far; empty in a short stage."""
    name, since = _STAGE.task or (_STAGE.of + _STAGE.text, _STAGE.since)
    passed, before = now - since, durations.earlier(name)
    if before is not None:
        left = f"about {duration_text(before - passed)} left" if passed < before else f"{duration_text(passed)} so far"
        return f"{left} ({duration_text(before)} last time)"
    if _STAGE.work is not None:
        work, began, expected = _STAGE.work
        if now < began + expected:
            return f"about {duration_text(began + expected - now)} of {work} left"
    return f"{duration_text(passed)} so far" if passed >= PATIENCE else ""


@contextmanager
def sized_work(name: str, kind: str, size: float) -> Iterator[None]:
    """Work whose duration is about proportional to its size; the line of progress states how much of it is left.

    The time per unit of size is that of the last work of this name and kind that took long.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    began, rate = time.perf_counter(), durations.earlier(f"{name} {kind}")
    if rate is not None:
        _STAGE.work = name, began, rate * size
    try:
        yield
    finally:
        _STAGE.work = None
    if (passed := time.perf_counter() - began) >= SECOND:
        durations.keep(f"{name} {kind}", passed / size)
