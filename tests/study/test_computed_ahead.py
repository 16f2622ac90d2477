"""Results that processes compute ahead: they are those of one process, whatever happens to the processes."""

from __future__ import annotations

import gc
import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from conftest import ROOT
from derive.spec.model.scene import Scene
from derive.spec.toml.read import read
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.measurement import ModelVariant, preparation, prepared
from derive.study.computed_ahead import ComputedAhead

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="studies fork processes on Linux alone")

HERE = os.getpid()


def becomes_true(condition: Callable[[], bool]) -> bool:
    """Whether a condition is met within ten seconds."""
    end = time.monotonic() + 10
    while not condition() and time.monotonic() < end:
        time.sleep(0.01)
    return condition()


def test_what_is_expected_is_computed_elsewhere_and_the_rest_here() -> None:
    with ComputedAhead(lambda key: (key, os.getpid()), workers=2) as ahead:
        ahead.expect([1, 2, 1])
        assert ahead.waiting == 2
        for key in (2, 1):
            result, process = ahead.result(key)
            assert result == key and process != HERE
        assert ahead.waiting == 0 and ahead.result(3) == (3, HERE)
    ahead.expect([4])
    assert ahead.waiting == 0 and ahead.result(4) == (4, HERE), "a closed one computes all itself"


def test_the_search_for_unreachable_objects_pauses_while_results_are_made() -> None:
    with ComputedAhead(lambda _: (gc.isenabled(), os.getpid()), workers=2) as ahead:
        ahead.expect([1])
        searched, process = ahead.result(1)
        assert not searched and process != HERE
        assert ahead.result(2) == (False, HERE) and gc.isenabled()


def test_without_workers_nothing_is_computed_before_it_is_asked_for() -> None:
    asked: list[int] = []
    ahead = ComputedAhead(asked.append)
    ahead.expect([1])
    assert asked == [] and ahead.result(1) is None and asked == [1]


def test_what_fails_there_raises_here() -> None:
    def failing(key: int) -> int:
        raise ZeroDivisionError(os.getpid())

    with ComputedAhead(failing, workers=2) as ahead:
        ahead.expect([1])
        with pytest.raises(ZeroDivisionError, match=str(HERE)):
            ahead.result(1)


def test_a_worker_that_is_killed_loses_nothing() -> None:
    def killed(key: int) -> int:
        if os.getpid() != HERE:
            os.kill(os.getpid(), signal.SIGKILL)
        return key

    with ComputedAhead(killed, workers=2) as ahead:
        ahead.expect([1, 2])
        assert [ahead.result(1), ahead.result(2)] == [1, 2]
        ahead.expect([3])
        assert ahead.result(3) == 3


def test_the_end_stops_what_is_computed_and_removes_its_temporary_folders(tmp_path: Path) -> None:
    def slow(key: int) -> None:
        with TemporaryDirectory(dir=tmp_path):
            (tmp_path / "process").write_text(str(os.getpid()))
            time.sleep(600)

    with ComputedAhead(slow, workers=2) as ahead:
        ahead.expect([1])
        assert becomes_true(lambda: len(list(tmp_path.iterdir())) == 2)
    process = int((tmp_path / "process").read_text())
    assert becomes_true(lambda: not Path(f"/proc/{process}").exists())
    assert [path.name for path in tmp_path.iterdir()] == ["process"]


def test_nothing_is_computed_after_waiting(tmp_path: Path) -> None:
    """Computations that run are finished, and those that have not begun are left out."""

    def marking(key: int) -> int:
        (tmp_path / f"begun {key}").touch()
        time.sleep(0.03)
        (tmp_path / f"done {key}").touch()
        return key

    with ComputedAhead(marking, workers=2) as ahead:
        ahead.expect(range(16))
        assert becomes_true(lambda: any(tmp_path.iterdir()))
        ahead.wait()
        names = sorted(path.name for path in tmp_path.iterdir())
        begun, done = ({name.split()[1] for name in names if name.startswith(kind)} for kind in ("begun", "done"))
        assert begun == done and 0 < len(done) < 12
        assert [ahead.result(key) for key in range(16)] == list(range(16))


def test_models_that_are_prepared_ahead_are_those_of_one_process() -> None:
    scene = read(ROOT / "scenes" / "crank_slider_3.toml")
    assert isinstance(scene, Scene)
    variant = ModelVariant(LadderModel(Shapes.SINES, 1))
    with preparation(scene, workers=2) as ahead:
        ahead.expect([variant])
        there, here = ahead.result(variant), prepared(scene, variant)
    assert (there.variant, there.files, there.own) == (here.variant, here.files, here.own)
    assert there.code == here.code and np.array_equal(there.start.q, here.start.q)
