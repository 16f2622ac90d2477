"""The command `study stability`: its table, the reasons that it gives, and arguments that are wrong."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_stability_of_models import COLUMN, EULER, FIRST, SECOND, SPIN, SPINNING, lost_at, polynomials

import derive
from derive.cli.main import main
from derive.cli.specifications import read_scene
from derive.simulation.errors import SimulationError
from derive.spec.set_values import with_values
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.stability.ladder_stability import LadderStability, study_stability
from derive.study.stability.model_path import ModelPath, PathPoint
from derive.study.stability.parameter import ParameterRange, studied
from derive.study.stability.table import gap_sentences, stability_data


@pytest.fixture
def coarse_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    """A reference that is quick to derive, and good to 0.06 %."""
    models = (polynomials(2, SECOND, pieces=2), polynomials(4, SECOND))
    monkeypatch.setattr("derive.study.stability.ladder_stability.refinements", lambda _: models)


def test_keys_that_are_no_parameters_are_refused_with_what_to_name() -> None:
    with pytest.raises(derive.SpecError, match="nor an initial value; name a mass, a stiffness"):
        studied(read_scene(COLUMN), ParameterRange("simulation.tolerance", 1e-8, 1e-7, 3))


@pytest.mark.long
@pytest.mark.usefixtures("coarse_reference")
def test_the_command_marks_wrong_verdicts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["study", "stability", str(COLUMN), "--parameter", "P=0:30:16", "--orders", "first", "--shapes", "2"]
    asked += ["--pieces", "2", "--sines", "1", "--out", str(tmp_path)]
    assert main([*asked, "--exact", "9.8696044", "--json"]) == 0
    said = capsys.readouterr()
    assert "loses its stability at" in said.err
    data = json.loads(said.out)
    models = {model["model"]: model for model in data["models"]}
    never = [name for name, model in models.items() if model["loss"] is None]
    assert never == ["rigid", "1 sine, first", "1 beam, P2, P3, first"]
    for name in never:
        assert models[name]["wrong"] == [{"from": 9.8696044, "to": 30.0, "stable": True}]
    late = models["2 beams, P2, P3, first"]
    assert late["distance_to_exact"] == pytest.approx(0.21888, abs=1e-5)
    assert late["wrong"] == [{"from": 9.8696044, "to": late["loss"], "stable": True}]
    assert data["reference"]["model"] == "1 beam, P2 to P5, truncated"
    assert data["reference"]["loss"] == pytest.approx(1.00056 * EULER, rel=1e-5)
    assert data["reference"]["error"] == pytest.approx((1.00752 - 1.00056) * EULER, rel=1e-2)
    assert [Path(name).name for name in data["files"]] == ["stability.svg", "stability.csv", "stability.json"]
    rows = list(csv.DictReader((tmp_path / "stability.csv").read_text().splitlines()))
    growing = {row["model"] for row in rows if row["grows"] == "True"}
    assert growing == {"2 beams, P2, P3, first", "1 beam, P2 to P5, truncated"}
    at_rest = [row for row in rows if row["model"] == "1 beam, P2, P3, first" and float(row["parameter"]) == 0]
    assert min(float(row["frequency_rad_s"]) for row in at_rest) == pytest.approx(np.sqrt(120), rel=1e-6)
    svg = (tmp_path / "stability.svg").read_text()
    assert (
        svg.count("wrong: stable</text>") == 3
        and "truth: given" in svg
        and "http" not in svg.replace("http://www.w3.org", "")
    )
    assert "<title>2 beams, P2, P3, first, 11 coordinates\n0 -&gt; 1 growing modes at 12.02985" in svg
    assert main(asked) == 0  # over its own files, and with the richest model as the truth
    text = capsys.readouterr().out
    assert "2 beams, P2, P3, truncated differs by 6.9e-02" in " ".join(text.split())
    assert any(line.split()[-5:] == ["stable", "from", "9.875098", "to", "30"] for line in text.splitlines())
    assert (tmp_path / "stability.svg").read_text() != svg


def test_after_three_models_without_steady_motion_no_other_is_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = []

    def falling(_: object, model: LadderModel) -> ModelPath:
        tried.append(model)
        return ModelPath(model, coordinates=len(tried) - 1, failure="it falls")  # the first has no motion of its own

    monkeypatch.setattr("derive.study.stability.ladder_stability.model_path", falling)
    pushed, _ = with_values(read_scene(SPINNING), {"forces.knock.components": "[0, 1]"})
    with pytest.raises(
        SimulationError, match=r"no model has a steady motion:\n  it falls\n7 finer models of the ladder"
    ):
        study_stability(pushed, (SPIN, 0, 40, 3))
    assert len(tried) == 4 and tried[0].shapes is Shapes.RIGID


def test_a_reason_that_models_share_is_said_once_and_advice_behind_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reasons differ by amounts, such as that of the rigid model; the advice on them is the same."""
    told: list[str] = []

    def falling(_: object, model: LadderModel) -> ModelPath:
        reason = f"it falls by {1 if model.shapes is Shapes.RIGID else 2} m/s"
        return ModelPath(model, coordinates=1, failure=reason, advice="hold it")

    monkeypatch.setattr("derive.study.stability.ladder_stability.model_path", falling)
    pushed, _ = with_values(read_scene(SPINNING), {"forces.knock.components": "[0, 1]"})
    message = r"steady motion:\n  it falls by 1 m/s\n  it falls by 2 m/s\nadvice: hold it\n8 finer models"
    with pytest.raises(SimulationError, match=message):
        study_stability(pushed, (SPIN, 0, 40, 3), progress=told.append)
    assert [" ".join(told).count(f"it falls by {i} m/s") for i in (1, 2)] == [1, 1]
    assert "it fails as 1 sine, first does" in told[-1]


def test_models_with_the_same_gaps_share_a_sentence() -> None:
    at = PathPoint(40.0, None, failure="it is far away", advice="start nearer")
    paths = [replace(lost_at(polynomials(n, FIRST), None), points=(at,)) for n in (2, 3)]
    of = LadderStability("rod", ParameterRange("P", 1, 2, 3), tuple(paths), paths[1], paths[0])
    both = "; ".join(path.model.label for path in paths)
    assert gap_sentences(of) == [f"{both}: no steady motion at 40: it is far away", "advice: start nearer"]
    told = [model["without_steady_motion"] for model in stability_data(of)["models"]]
    assert told == [[{"value": 40.0, "reason": "it is far away; start nearer"}]] * 2


def test_where_a_model_has_no_steady_motion_it_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    models = (LadderModel(Shapes.RIGID), polynomials(2, FIRST))
    monkeypatch.setattr("derive.study.stability.ladder_stability.refinements", lambda _: models)
    asked = ["--orders", "first", "--shapes", "2", "--pieces", "1", "--sines", "1", "--out", str(tmp_path)]
    assert main(["study", "stability", str(SPINNING), "--parameter", f"{SPIN}=0:40:3", *asked]) == 2
    assert "these functions of time never come to rest: forces.knock.components;" in capsys.readouterr().err
    pushed = ["--set", "forces.knock.components=[0, 1]"]
    assert main(["study", "stability", str(SPINNING), "--parameter", f"{SPIN}=0:40:3", *asked, *pushed]) == 2
    assert "no model has a steady motion" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (["--parameter", "Q=0:3:4"], '--parameter: "Q" is no parameter and no key'),
        (["--parameter", "P=3:0:4"], "A is less than B"),
        (["--parameter", "P=0:3:1"], "N is between 2 and 10000"),
        (["--parameter", "bodies.rod.markers.left=-1:-0.9:3"], "neither a number that can be a run-time parameter nor"),
        (["--parameter", "P"], "expected NAME=A:B:N"),
        (["--parameter", "bodies.rod.order=1:2:2"], "bodies.rod.order"),
        (["--parameter", "simulation.duration=1:2:2", "--exact", "x"], "expected a number, or none"),
        (["--parameter", "P=0:3:4", "--set", "P=1", "--set", "P=2"], "P has several values"),
        (["--parameter", "P=0:3:4", "--out", f"{COLUMN}/x"], "this is a file, not a folder"),
    ],
)
def test_wrong_arguments(asked: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    try:
        code = main(["study", "stability", str(COLUMN), *asked])
    except SystemExit as stopped:
        code = int(str(stopped.code))
    assert code == 2 and message in capsys.readouterr().err
