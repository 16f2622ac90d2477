"""Stages without a count state the time so far, or what is left by the time that they took before."""

from __future__ import annotations

import io
import os
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace

import pytest

from derive import durations
from derive.cache import no_cache
from derive.errors import TisserandError
from derive.progress_line import show_progress, sized_work, timed_stages, timed_task


class Terminal(io.StringIO):
    """A text that is a terminal."""

    seen = True

    def isatty(self) -> bool:
        """Whether it is one."""
        return self.seen


@pytest.fixture
def terminal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Terminal:
    """A terminal with quick seconds and an empty cache."""
    result = Terminal()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr("derive.progress_line.SECOND", 0.02)
    monkeypatch.setattr("derive.progress_line.PATIENCE", 0.04)
    monkeypatch.setattr("derive.progress_line.sys", SimpleNamespace(stderr=result, exc_info=sys.exc_info))
    durations._known.cache_clear()
    return result


def lines(terminal: Terminal) -> list[str]:
    """The texts of the line."""
    return [line.removesuffix("\x1b[K") for line in terminal.getvalue().split("\r")[1:]]


def run(*stages: str, seconds: float = 0.1) -> None:
    """Work in stages."""
    with timed_stages():
        for text in stages:
            show_progress(text)
            time.sleep(seconds)
        show_progress()


def test_a_long_stage_states_the_time_so_far(terminal: Terminal) -> None:
    """A line that ends with dots gets its time; others stay."""
    run("deriving ...", "simulating: 3 of 4 s")
    texts = list(dict.fromkeys(lines(terminal)))
    assert texts[:2] == ["deriving ...", "deriving, 1 s so far ..."]
    assert texts[-2:] == ["simulating: 3 of 4 s", ""]


def test_a_pipe_sees_nothing(terminal: Terminal) -> None:
    terminal.seen = False
    run("deriving ...")
    assert lines(terminal) == []


def test_a_stage_states_what_is_left_by_the_time_of_last_time(terminal: Terminal) -> None:
    durations.keep("deriving ...", 75.0)
    run("deriving ...", "lowering ...", seconds=0.5)
    texts = lines(terminal)
    assert texts[0] == "deriving, about 1 min 15 s left (1 min 15 s last time) ..."
    assert "lowering, 1 s so far ..." in texts
    assert 0.1 <= (durations.earlier("deriving ...") or 0.0) < 10.0  # that of this time, and not of the other stage


def test_a_stage_that_takes_longer_than_last_time_says_so(terminal: Terminal) -> None:
    durations.keep("deriving ...", 0.03)
    run("deriving ...", seconds=0.2)
    assert lines(terminal)[-2] == "deriving, 1 s so far (1 s last time) ..."


def test_short_stages_and_those_that_an_error_ends_are_not_kept(terminal: Terminal) -> None:
    run("short ...", seconds=0.0)
    with suppress(TisserandError):
        try:
            show_progress("wrong ...")
            time.sleep(0.1)
            raise TisserandError
        finally:
            show_progress()
    with no_cache():
        run("without the cache ...")
    assert [durations.earlier(f"{name} ...") for name in ("short", "wrong", "without the cache")] == [None] * 3


def test_a_task_states_its_own_time_in_place_of_that_of_its_stages(terminal: Terminal) -> None:
    durations.keep("choosing", 75.0)
    with timed_task("choosing"):
        run("model 1 ...", "model 2 ...")
    assert "model 2, about 1 min 15 s left (1 min 15 s last time) ..." in lines(terminal)
    assert (durations.earlier("choosing") or 75.0) < 10.0


def test_stages_of_one_name_in_two_scenes_are_told_apart(terminal: Terminal) -> None:
    for scene in ("pendulum", "crank"):
        with timed_stages(scene):
            show_progress("model 1 ...")
            time.sleep(0.1)
            show_progress()
    assert not [text for text in lines(terminal) if "last time" in text]


def test_a_new_text_is_known_by_the_compilers_time_per_byte(terminal: Terminal) -> None:
    """1000 bytes in 0.1 s: 60000 bytes take about 6 s, with the same options alone."""
    for size, kind in ((1_000, "-O2"), (60_000, "-O2"), (60_000, "-O0")):
        with timed_stages():
            show_progress(f"{size} bytes {kind} ...")
            with sized_work("compiling", kind, size):
                time.sleep(0.1)
            show_progress()
    left = [text for text in lines(terminal) if "of compiling left" in text]
    assert left and {text.split(",")[0] for text in left} == {"60000 bytes -O2"}
    assert all(5 <= int(text.split("about ")[1].split(" s")[0]) <= 30 for text in left)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no forks")
def test_no_thread_runs_beside_a_fork(terminal: Terminal) -> None:
    """In the child there is none, and in the parent it goes on."""
    with timed_stages():
        show_progress("forking ...")
        child = os.fork()
        if child == 0:
            os._exit(len(sys._current_frames()) - 1)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
        assert threading.active_count() > 1
        time.sleep(0.1)
        show_progress()
    assert "forking, 1 s so far ..." in lines(terminal)
