"""Every command and the physics on a sample of the corpus; `pytest -m long` runs twenty, `run.py` more."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from corpus.commands import Finding, Outcome, findings, other_integrator, other_motions
from corpus.generator import corpus_scene
from corpus.python_kernels import TOLERANCE
from corpus.refusals import REFUSALS, refusal
from corpus.run import LIMIT, limit
from corpus.scene_check import check_scene, quick_compiler
from corpus.summed_terms import Summed, of_function, worst

SAMPLE = (1, 2005, *(pytest.param(seed, marks=pytest.mark.long) for seed in (21, 23, 2000, 2007, 2008, 2016)))
"""A few scenes of different linkages, which take about 5 s each."""


@pytest.fixture(autouse=True, scope="module")
def compiler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CC", quick_compiler(tmp_path_factory.mktemp("compiler")))
        yield


@pytest.mark.parametrize("seed", SAMPLE)
def test_a_sample_of_scenes(seed: int) -> None:
    result = check_scene(seed)
    assert not result.findings, "\n".join(f"{f.command}: {f.cause}\n{f.text}" for f in result.findings)


@pytest.mark.long
def test_twenty_scenes(tmp_path: Path) -> None:
    """Before a release `python tests/corpus/run.py --seeds 60:360` runs fifteen times as many."""
    command = [sys.executable, str(Path(__file__).with_name("run.py")), "--seeds", "60:80", "--jobs", "2"]
    done = subprocess.run([*command, "--store", str(tmp_path / "store.jsonl")], capture_output=True, check=False)
    assert done.returncode == 0, done.stdout.decode()


# ---- the checks themselves ----


def outcome(code: int | None, out: str = "done", error: str = "", **more: object) -> Outcome:
    return Outcome(["modes", "/tmp/scene.toml"], code, out, error, 0.0, **more)  # type: ignore[arg-type]


def judged(result: Outcome, folder: Path) -> list[Finding]:
    return [*findings(corpus_scene(3), result, folder)]


def test_a_busy_machine_gives_scenes_more_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """A scene of two minutes was a finding after a quarter of an hour, with ten processes on two processors."""
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    for load, factor in ((0.5, 1), (10, 5)):
        monkeypatch.setattr("os.getloadavg", lambda load=load: (load, load, load))
        assert limit(3) == 3 * factor * LIMIT


def test_outcomes_that_are_findings(tmp_path: Path) -> None:
    (tmp_path / "table.csv").write_text("t,x\n0,nan\n")
    (tmp_path / "record.json").write_text('{"x": NaN}')
    wrong = [
        outcome(None, exception="KeyError", cause="KeyError in modes"),
        outcome(1, error="it failed"),
        outcome(0, error="RuntimeWarning: divide by zero", files=["table.svg"]),
        outcome(2, error="an unknown complaint"),
        outcome(2, error="there is no beam here", files=["record.json"]),
        outcome(2, error=""),
        outcome(0, out=""),
        outcome(0, files=["table.csv"]),
        outcome(0, files=["record.json"]),
    ]
    (tmp_path / "table.svg").write_text("<svg/>")
    assert all(judged(result, tmp_path) for result in wrong)
    assert judged(outcome(2, out="", error="there is no beam here"), tmp_path) == []
    (tmp_path / "good.csv").write_text("t,x\n0,1\n")
    assert judged(outcome(0, files=["good.csv"]), tmp_path) == []


def test_refusals_are_patterns_with_reasons() -> None:
    assert all(reason and pattern for pattern, reason in REFUSALS.items())
    assert refusal("scene.toml:3: bodies: there is no beam here, and nothing to choose")
    assert refusal("the program has failed") is None


def test_terms_are_summed_through_cancellation_and_functions() -> None:
    a, b = Summed(1e8, 1e8), Summed(-1e8, 1e8)
    assert a + b == Summed(0.0, 2e8) and (a + b) * 3 == Summed(0.0, 6e8) and 1 - a / a == Summed(0.0, 2.0)
    turned = of_function(math.sin, Summed(0.5, 10.0))
    assert turned.size == pytest.approx(math.sin(0.5) + 10 * math.cos(0.5), rel=1e-5)
    assert worst([1.0, 0.0], [1.0, 1e-7], np.array([1.0, 1e8])) == pytest.approx(1e-15)
    assert worst([1.0], [1.0 + 1e-13], np.array([1.0])) > TOLERANCE
    assert worst([math.nan], [1.0], np.array([1.0])) == worst([0.0], [1e-300], np.array([0.0])) == math.inf


def test_a_run_that_notes_its_coarse_step_is_no_other_motion(tmp_path: Path) -> None:
    seed = 3034  # with the generalised-alpha method
    runs = {"simulate": ("0.0", []), other_integrator(seed): ("0.1", ["step: 1 s is too coarse: ..."])}
    for name, (position, notes) in runs.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "run.csv").write_text(f"t,rod_c1\n1.0,{position}\n")
        (tmp_path / name / "run.json").write_text(json.dumps({"notes": notes}))
    assert not list(other_motions(seed, tmp_path))
    (tmp_path / other_integrator(seed) / "run.json").write_text("{}")
    (finding,) = other_motions(seed, tmp_path)
    assert finding.cause == "not the motion of the default"
