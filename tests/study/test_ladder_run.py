"""The runs of a ladder: what cannot matter is left out, what there is survives Ctrl-C, a pipe gets a line per model."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.cli.main import main
from derive.simulation.observables.plots import PlotCurve
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.scene import Scene
from derive.spec.toml.read import read
from derive.study.accuracy import ladder_run
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.ladder_run import LadderRun
from derive.study.accuracy.measurement import (
    CompiledLadderModel,
    Line,
    Point,
    PreparedModel,
    compiled,
    measured,
    opened,
    retimed,
)
from derive.study.accuracy.reference import Reference, undeformed_note

SCENE = ROOT / "scenes" / "crank_slider_3.toml"
FIRST, TRUNCATED = DisplacementOrder.FIRST_ORDER, DisplacementOrder.TRUNCATED


@pytest.fixture(scope="module")
def scene() -> Scene:
    result = read(SCENE)
    assert isinstance(result, Scene)
    return result


def ladder_run_of(scene: Scene, *lines: Line) -> LadderRun:
    """A ladder of which these lines have run, with a reference that is right to 0.1 %."""
    result = LadderRun(scene, Reference(scene.plots[:1], "made", 1e-3), (1e-3,))
    result.lines += lines
    return result


def polynomials(count: int, order: DisplacementOrder, error: float, operations: int) -> Line:
    point = Point(1e-3, error, error, (1e-3,) * 3, 1000, operations)
    return Line(LadderModel(Shapes.POLYNOMIALS, count, order), 3 + count, (point,))


def test_a_model_cannot_matter_that_is_dearer_than_what_is_as_good_as_the_reference(scene: Scene) -> None:
    dear = LadderModel(Shapes.POLYNOMIALS, 6, TRUNCATED)
    assert "within that of the reference" in ladder_run_of(scene, polynomials(2, TRUNCATED, 9e-4, 10**5)).dispensable(
        dear
    )
    assert ladder_run_of(scene, polynomials(2, TRUNCATED, 2e-3, 10**5)).dispensable(dear) == ""
    assert ladder_run_of(scene, polynomials(2, TRUNCATED, 9e-4, 10**10)).dispensable(dear) == ""
    assert ladder_run_of(scene, polynomials(2, TRUNCATED, 9e-4, 10**5)).dispensable(LadderModel(Shapes.RIGID)) == ""


def test_a_model_cannot_matter_whose_kind_no_longer_improves_where_a_cheaper_one_is_better(scene: Scene) -> None:
    """Two shapes more have to change nothing: one alone may be odd where an even one is missing."""
    stays = tuple(polynomials(n, FIRST, 0.12, n * 10**6) for n in (2, 3, 4))
    better = polynomials(2, TRUNCATED, 0.01, 10**6)
    more = LadderModel(Shapes.POLYNOMIALS, 6, FIRST)
    assert "more shapes of its kind stay at 12 %" in ladder_run_of(scene, *stays, better).dispensable(more)
    assert ladder_run_of(scene, *stays).dispensable(more) == ""
    assert ladder_run_of(scene, *stays[:2], better).dispensable(more) == ""
    improves = polynomials(4, FIRST, 0.05, 4 * 10**6)
    assert ladder_run_of(scene, *stays[:2], improves, better).dispensable(more) == ""
    assert ladder_run_of(scene, *stays, better).dispensable(LadderModel(Shapes.POLYNOMIALS, 6, TRUNCATED)) == ""


def test_second_order_is_left_out_where_it_has_changed_two_models_by_less_than_is_known(scene: Scene) -> None:
    """The reference is right to 0.1 %; a model without its sibling of first order is run."""

    def pair(count: int, change: float) -> tuple[Line, Line]:
        x = np.linspace(0.0, 1.0, 11)
        curves = [(PlotCurve("", x, y, None),) for y in (np.ones(11), np.full(11, 1 + change))]
        first, second = (polynomials(count, order, 0.1, 10**6) for order in (FIRST, TRUNCATED))
        return replace(first, curves=curves[0]), replace(second, curves=curves[1])

    first = replace(polynomials(6, FIRST, 0.01, 10**6), curves=pair(6, 0.0)[0].curves)
    ladder = ladder_run_of(scene, *pair(2, 1e-4), *pair(3, 9e-4), first)
    models = "1 beam, P2, P3, truncated; 1 beam, P2 to P4, truncated: by less than the error of the reference"
    finer = LadderModel(Shapes.POLYNOMIALS, 6, TRUNCATED)
    assert ladder.dispensable(finer) == f"second order changed the plot by at most 0.09 % in {models}"
    assert ladder.dispensable(LadderModel(Shapes.POLYNOMIALS, 7, TRUNCATED)) == ""
    assert ladder_run_of(scene, *pair(2, 1e-4), *pair(3, 2e-3), first).dispensable(finer) == ""
    assert ladder_run_of(scene, *pair(3, 1e-4), first).dispensable(finer) == ""


def test_a_run_that_is_timed_once_runs_alone(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    """Others are timed again after the ladder."""
    calls: list[str] = []
    rigid = compiled(scene, LadderModel(Shapes.RIGID))
    measured(rigid, scene.plots[:1], (1e-3,), lambda: calls.append("short"))
    monkeypatch.setattr("derive.study.accuracy.measurement.LONG", 1e-9)
    measured(rigid, scene.plots[:1], (1e-3,), lambda: calls.append("long"))
    assert calls == ["long"]


def test_tolerances_beyond_the_error_of_the_model_are_left_out(scene: Scene) -> None:
    rigid = compiled(scene, LadderModel(Shapes.RIGID))
    line = measured(rigid, scene.plots[:1], (1e-3, 1e-4, 1e-6, 1e-8))
    assert [p.tolerance for p in line.points] == [1e-3, 1e-4]  # a rigid rod is 47 % off, whatever the steps
    (again,) = retimed([line], {rigid.model: rigid}, 3, lambda _: None)
    assert [(p.rms, p.operations) for p in again.points] == [(p.rms, p.operations) for p in line.points]
    assert all(least <= middle <= most for middle, least, most in (p.seconds for p in again.points))


ASKED = [
    "--shapes",
    "2",
    "--pieces",
    "1",
    "--sines",
    "1",
    "--orders",
    "first",
    "--tolerances",
    "1e-3,1e-4",
    "--runs",
    "1",
]


def test_an_interruption_leaves_what_there_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(of: PreparedModel) -> CompiledLadderModel:
        if of.variant.model.shapes is not Shapes.RIGID:
            raise KeyboardInterrupt
        return opened(of)

    monkeypatch.setattr(ladder_run, "opened", interrupted)
    assert main(["study", "accuracy", str(SCENE), *ASKED, "--out", str(tmp_path)]) == 130
    text = capsys.readouterr()
    assert "interrupted: 2 models were not run" in text.out
    assert "3 models, about " in text.err and "model 1 of 3: rigid: 47 % in " in text.err
    rows = list(csv.DictReader((tmp_path / "accuracy.csv").read_text().splitlines()))
    assert {row["model"] for row in rows} == {"rigid"}
    data = json.loads((tmp_path / "accuracy.json").read_text())
    assert data["notes"] == ["interrupted: 2 models were not run"] and " -O1 " in data["machine"]
    assert (tmp_path / "accuracy.svg").exists()
    assert "interrupted: 2 models were not run" in (tmp_path / "accuracy.html").read_text()


def test_what_there_is_is_written_meanwhile(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Before the second model runs, the files have the first."""
    seen: list[list[str]] = []

    def watching(of: PreparedModel) -> CompiledLadderModel:
        record = tmp_path / "accuracy.json"
        if record.exists():
            data = json.loads(record.read_text())
            seen.append([*(line["model"] for line in data["models"]), *data["notes"]])
        return opened(of)

    monkeypatch.setattr("derive.study.accuracy.study.BETWEEN", 0.0)
    monkeypatch.setattr(ladder_run, "opened", watching)
    assert main(["study", "accuracy", str(SCENE), *ASKED, "--out", str(tmp_path)]) == 0
    assert seen[0] == ["rigid", "unfinished: more models are being run"]
    assert "unfinished" not in (tmp_path / "accuracy.json").read_text()


def test_a_file_as_the_reference_does_not_change_with_the_scene(tmp_path: Path) -> None:
    """A rod of other stiffness was compared with the file of the first one, without a line on it."""
    asked = [*ASKED, "--set", "bodies.rod.bending_stiffness=30", "--set", "simulation.duration=0.01"]
    for more, noted in (([], True), (["--own-reference"], False)):
        assert main(["study", "accuracy", str(SCENE), *asked, *more, "--out", str(tmp_path)]) == 0
        page = (tmp_path / "accuracy.html").read_text()
        assert ("is that of the scene before these changes" in page) is noted and "12.7234502 -&gt; 30" in page


def test_a_plot_that_shows_no_deformation_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """The place of a ball that flies beside a beam: all models have the same curve."""
    few = tuple(LadderModel(Shapes.POLYNOMIALS, n, TRUNCATED) for n in (2, 3))
    monkeypatch.setattr("derive.study.accuracy.reference.refinements", lambda scene: few)
    scene = derive.scene(
        "beside",
        bodies={
            "rod": {"mass": 1, "length": 1, "bending_stiffness": 20},
            "ball": {"mass": 1, "inertia": 1, "start": {"velocity": [1, 0]}},
        },
        plots={"path": {"y": "ball_c1"}},
        simulation={"duration": 0.1, "output": 0.01},
    )
    study = derive.study_accuracy(
        scene, orders=["first"], shapes=[2], pieces=[], sines=[], tolerances=[1e-3], runs=1, progress=False
    )
    note = "path has the same curve in all models of the reference: no deformation shows; see --plot"
    assert study.notes[0] == note == undeformed_note(["path"], study.reference.error)[0]
    assert not undeformed_note(["path"], 1e-9) and not undeformed_note(["path"], None)
