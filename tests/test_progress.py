"""Long work reports its progress on a terminal, in one line that disappears; in a pipe it is silent."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from html import escape
from pathlib import Path
from types import SimpleNamespace

import pytest

from conftest import ROOT
from derive.cli.main import main
from derive.durations import duration_text
from derive.errors import TisserandError
from derive.notebook_line import in_notebook
from derive.progress_line import show_progress
from derive.remaining_time import RemainingTime, remaining_seconds
from derive.terminal import DelayedLine, SampleProgress, SimulationProgress, progress_of

BEAM = str(ROOT / "scenes/free_beam_mean.toml")
SLIDER = str(ROOT / "scenes/crank_slider_3.toml")
STAGES = ["reading the specification", "deriving the equations", "lowering to kernels", "emitting C"]


def arguments(command: str, folder: Path) -> tuple[list[str], list[str]]:
    """A command, and what its line of progress says, in this order."""
    build = ["loading", *(f"{BEAM}: {stage}" for stage in STAGES)]
    return {
        "build": (["build", BEAM, "--out", str(folder)], build),
        "compare": (["compare", BEAM], [*build, "free_beam_mean: compiling the C"]),
        "pivots": (
            ["study", "pivots", SLIDER, "--pieces", "1", "--states", "9", "--numberings", "1"],
            [
                "loading",
                "mean frame: deriving and compiling",
                "mean frame: simulating",
                "point frame: numbering 1 of 1",
            ],
        ),
    }[command]


@pytest.mark.parametrize("command", ["build", "compare", "pivots"])
def test_progress(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given, stages = arguments(command, tmp_path)
    assert main(given) == 0
    assert capsys.readouterr().err == ""
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    assert main(given) == 0
    text = capsys.readouterr().err
    places = [text.find(stage) for stage in stages]
    assert -1 not in places and places == sorted(places)
    assert "\n" not in text and text.endswith("\r\x1b[K")


def test_an_error_replaces_the_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def failing(path: Path, announce: Callable[[str], None], *options: object) -> None:
        announce("lowering to kernels")
        raise TisserandError("the message")

    monkeypatch.setattr("derive.pipeline.build", failing)
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    assert main(["build", BEAM, "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err.endswith("lowering to kernels ...\x1b[K\r\x1b[Kthe message\n")


def test_the_remaining_time_follows_from_the_speed_since_the_first_step(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The run goes from 0.1 s to 0.6 s in 10 s of the clock: the remaining 1.4 s take 28 s, whatever compiling took."""
    clock = iter([1000.0, 1010.0, 1010.05, 1020.0])
    monkeypatch.setattr("derive.terminal.time.monotonic", lambda: next(clock))
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    progress = SimulationProgress("pendulum", 2.0)
    for reached in (0.1, 0.6, 0.7, 2.0):
        progress(reached)
    lines = capsys.readouterr().err.split("\r")
    assert [line.removesuffix("\x1b[K") for line in lines[2:]] == [
        "simulating pendulum: 0.1 of 2 s",
        "simulating pendulum: 0.6 of 2 s, about 28 s left",
        "simulating pendulum: 2 of 2 s",
    ]


def test_the_remaining_time_of_steps_follows_from_those_before(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is stated at first; after three of eight steps in 12 s, five take 20 s."""
    clock = iter([100.0, 100.0, 100.1, 110.0, 112.0, 200.0, 200.0])
    monkeypatch.setattr("derive.remaining_time.time.monotonic", lambda: next(clock))
    remaining = RemainingTime(8)
    texts = [remaining.named("model") for _ in range(4)]
    assert texts == [
        "model (1 of 8)",
        "model (2 of 8)",
        "model (3 of 8, about 30 s left)",
        "model (4 of 8, about 20 s left)",
    ]
    assert RemainingTime(1).named("model") == "model"


def test_the_first_short_steps_do_not_decide_the_estimate_alone() -> None:
    """A step predicted as 1 s of 20 s that takes 6 s, mostly of the start, does not make 114 s of the other 19 s."""
    assert 19 < remaining_seconds(19.0, 1.0, 6.0, 6.0) < 40
    assert remaining_seconds(10.0, 10.0, 20.0, 0.0) == 20.0


@pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo-terminals")
def test_several_specifications_are_counted_on_a_terminal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A real pseudo-terminal gets one line, which is removed at the end."""
    block = str(ROOT / "scenes/block.toml")
    main_end, terminal = os.openpty()
    with os.fdopen(terminal, "w") as stderr:
        monkeypatch.setattr("sys.stderr", stderr)
        assert main(["build", BEAM, block, "--out", str(tmp_path)]) == 0
        stderr.flush()
        text = os.read(main_end, 100_000).decode()
    os.close(main_end)
    lines = [line.removesuffix("\x1b[K") for line in text.split("\r")]
    counted = [line for line in lines if "deriving the equations" in line]  # repeated with its time if it is long
    assert list(dict.fromkeys(line.split(")")[0].split(",")[0] for line in counted)) == [
        f"{BEAM} (1 of 2",
        f"{block} (2 of 2",
    ]
    assert "\n" not in text and lines[-1] == ""


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.2, "1 s"), (59.4, "59 s"), (59.6, "1 min 0 s"), (200, "3 min 20 s"), (7500, "2 h 5 min")]
)
def test_durations_in_words(seconds: float, text: str) -> None:
    assert duration_text(seconds) == text


class FakeHandle:
    """An output of a cell, as IPython returns it: the texts that it has shown."""

    def __init__(self, data: dict[str, str]) -> None:
        self.texts = [data["text/plain"]]
        assert data["text/html"] == f"<pre>{escape(data['text/plain'])}</pre>"

    def update(self, data: dict[str, str], raw: bool) -> None:
        assert raw
        assert data["text/html"] or not data["text/plain"]
        self.texts.append(data["text/plain"])


@pytest.fixture
def notebook(monkeypatch: pytest.MonkeyPatch) -> list[FakeHandle]:
    """A process that a notebook runs; the outputs of its cells."""
    outputs: list[FakeHandle] = []

    def display(data: dict[str, str], raw: bool, display_id: bool) -> FakeHandle:
        assert raw and display_id
        outputs.append(FakeHandle(data))
        return outputs[-1]

    shell = SimpleNamespace(kernel=object())
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    monkeypatch.setitem(sys.modules, "IPython.display", SimpleNamespace(display=display))
    return outputs


def test_a_notebook_shows_the_line_as_one_output_of_its_cell(
    notebook: list[FakeHandle], capsys: pytest.CaptureFixture[str]
) -> None:
    for text in ("", "first", "second", "", "third", ""):
        show_progress(text)
    assert [output.texts for output in notebook] == [["first", "second", ""], ["third", ""]]
    assert capsys.readouterr().err == ""


def test_an_ipython_without_a_kernel_is_a_terminal(notebook: list[FakeHandle], monkeypatch: pytest.MonkeyPatch) -> None:
    assert in_notebook()
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=SimpleNamespace))
    assert not in_notebook()
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: None))
    assert not in_notebook()


def test_short_work_shows_no_line(notebook: list[FakeHandle]) -> None:
    progress = SimulationProgress("pendulum", 2.0, after=60.0)
    progress(1.0)
    progress.end()
    assert notebook == []


def test_long_work_shows_its_line_while_it_waits(notebook: list[FakeHandle]) -> None:
    line = DelayedLine(after=0.01)
    line.show("compiling ...")
    line._timer.join(5.0)  # nothing else happens meanwhile
    assert [output.texts for output in notebook] == [["compiling ..."]]
    line.show("1 of 2 s")
    line.end()
    line.end()
    assert [output.texts for output in notebook] == [["compiling ...", "1 of 2 s", ""]]


def test_functions_show_a_line_in_notebooks_or_where_they_are_asked_to(
    notebook: list[FakeHandle], monkeypatch: pytest.MonkeyPatch
) -> None:
    def line() -> SimulationProgress:
        return SimulationProgress("pendulum", 2.0)

    for given, kind in ((None, SimulationProgress), (True, SimulationProgress), (False, type(None))):
        with progress_of(given, line) as report:
            assert isinstance(report, kind)
    with progress_of(print, line) as report:
        assert report is print
    monkeypatch.delitem(sys.modules, "IPython")
    with progress_of(None, line) as report:
        assert report is None


def test_a_sweep_reports_finished_samples_and_the_remaining_time(
    notebook: list[FakeHandle], monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = iter([0.0, 0.0, 0.0, 10.0, 20.0, 30.0])
    monkeypatch.setattr("derive.terminal.time.monotonic", lambda: next(clock))
    progress = SampleProgress("bar")
    for finished in (2, 4, 10):
        progress(finished, 10)
    progress.end()
    assert notebook[0].texts == [
        "bar: 2 of 10 samples",
        "bar: 4 of 10 samples, about 30 s left",
        "bar: 10 of 10 samples",
        "",
    ]
