"""Run-time inputs in studies follow the functions that the specification gives them, as in a simulation."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from derive.cli.main import main
from derive.study.accuracy import reference
from derive.study.accuracy.models import refinements

SCENE = """
name = "pushed"

[ground.markers]
o = [0, 0]

[bodies.rod]
mass = 1
length = 1
bending_stiffness = 20
markers = { left = -1, middle = 0, right = 1 }

[bodies.rod.start]
angle = 0.1
guess = true

[joints.pin]
kind = "revolute"
between = ["ground.o", "rod.left"]

[drives.motor]
joint = "pin"
motion = %s

[forces.push]
at = "rod.right"
components = [0, %s]
frame = "body"

%s

[simulation]
duration = 0.2
output = 0.01

[plots.bend]
deflection = "rod.middle"
chord = ["rod.left", "rod.right"]
"""
PUSH, TURN = "sin(20*t)", "0.2 + t^2"
INPUTS = f'[inputs.u]\nvalue = "{PUSH}"\n\n[inputs.w]\nvalue = "{TURN}"\nunit = "rad"\n'


@pytest.fixture
def both(tmp_path: Path) -> list[Path]:
    """The scene with inputs, and with their functions in their places."""
    texts = SCENE % ('{ input = "w" }', '{ input = "u" }', INPUTS), SCENE % (f'"{TURN}"', f'"{PUSH}"', "")
    paths = [tmp_path / name / "pushed.toml" for name in ("inputs", "functions")]
    for path, text in zip(paths, texts, strict=True):
        path.parent.mkdir()
        path.write_text(text)
    return paths


@pytest.mark.parametrize(
    "arguments",
    [
        pytest.param(
            ["study", "accuracy", "--own-reference", "--shapes", "2", "--pieces", "1", "--tolerances", "1e-4"],
            marks=pytest.mark.long,
        ),
        pytest.param(["study", "methods", "--steps", "100", "--states", "5"], marks=pytest.mark.long),
        ["study", "pivots", "--pieces", "1", "--states", "5"],
    ],
)
def test_a_study_moves_as_a_simulation_does(
    arguments: list[str],
    both: list[Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(reference, "refinements", lambda scene: refinements(scene)[:2])  # two beams are enough here

    def numbers(path: Path) -> Any:
        capsys.readouterr()
        assert main([*arguments[:2], str(path), *arguments[2:], "--json"]) == 0
        return _without_times(json.loads(capsys.readouterr().out))

    by_inputs, by_functions = map(numbers, both)
    assert by_inputs == by_functions


TIMED = {"cpu_s", "cpu_least_s", "cpu_most_s", "recommended", "cheaper", "better", "files"}
"""The keys of results that depend on a clock, and of names of files."""


def _without_times(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _without_times(value) for key, value in data.items() if key not in TIMED}
    return [_without_times(value) for value in data] if isinstance(data, list) else data


def test_a_report_shows_the_start_that_inputs_prescribe(both: list[Path], tmp_path: Path) -> None:
    starts = []
    for path in both:
        page = tmp_path / f"{path.parent.name}.html"
        assert main(["report", str(path), "--out", str(page)]) == 0
        text = re.sub("<[^>]*>", " ", page.read_text().rpartition("Initial state<")[2])
        starts.append(re.findall(r"rod.start.angle\s+(\S+)\s+(\S+)", text))
    assert starts == [[("0.1", "0.2")]] * 2
