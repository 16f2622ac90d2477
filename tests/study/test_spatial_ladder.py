"""The ladder of a scene in space: its rungs, its references, several specifications in a chart, and a small study."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import derive
from conftest import ROOT
from derive.cli.main import main
from derive.errors import SpecError
from derive.spec.model.plots import ReferenceCurve
from derive.spec.model.spatial_scene import SpatialScene
from derive.study.accuracy.beside import beside, ladders
from derive.study.accuracy.chart import accuracy_svg
from derive.study.accuracy.chart_labels import colour_names
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.models import ladder, model_scene, refinements
from derive.study.accuracy.spatial_ladder import linear_reference
from derive.study.accuracy.table import accuracy_text
from derive.study.stability.model_path import model_path
from derive.study.stability.parameter import ParameterRange, studied
from derive.study.study_options import LadderRange

FEW = LadderRange(("first", "truncated"), ("mean",), (3,), (2,), (1,), component_counts=(2,))


def example(name: str) -> SpatialScene:
    scene = derive.read(ROOT / "examples" / f"{name}.toml")
    assert isinstance(scene, SpatialScene)
    return scene


FINITE, BEAM = example("spatial_crank_slider"), example("spatial_crank_slider_beam")


def test_a_finite_element_body_has_the_modes_of_its_files_free_ones_and_those_of_its_interface() -> None:
    """Craig-Bampton modes come without vibrations as well: six static ones of two ends that are sets of nodes."""
    labels = [model.label for model in ladder(FEW, FINITE)]
    assert labels == [
        "rigid",
        "2 free modes",
        "6 modes of the files",
        "Craig-Bampton + no vibration",
        "Craig-Bampton + 2 vibrations",
    ]


def test_modes_of_files_are_taken_in_growing_numbers_where_there_is_no_stiffness_matrix() -> None:
    rod: Any = FINITE.bodies[1]
    alone = replace(rod, body=replace(rod.body, data=replace(rod.body.data, stiffness=None)))
    labels = [model.label for model in ladder(FEW, replace(FINITE, bodies=(alone,), joints=()))]
    assert labels == ["rigid", "2 modes of the files", "6 modes of the files"]


def test_a_beam_in_space_has_shapes_in_both_planes_and_pieces_with_few_and_with_many() -> None:
    labels = [model.label for model in ladder(FEW, BEAM)]
    of_first = ["1 sine", "1 beam, P2 to P4", "2 beams, P2, P3", "2 beams, P2 to P5"]
    assert labels == ["rigid", *(f"{text}, {order}" for text in of_first for order in ("first", "truncated"))]
    twisted = ladder(replace(FEW, torsion=(0, 2), orders=("first",), pieces=()), BEAM)
    assert [model.label for model in twisted if model.shapes is Shapes.SINES] == [
        "1 sine, no twist, first",
        "1 sine, 2 twists, first",
    ]


def test_references_refine_beams_by_pieces_and_finite_elements_by_vibrations() -> None:
    pieces = [model.pieces for model in refinements(BEAM)]
    assert pieces == [1, 2, 3, 4, 6, 8]
    assert [model.label for model in refinements(FINITE)][::3] == [f"Craig-Bampton + {n} vibrations" for n in (6, 30)]
    assert "the reference of rod is of first order" in linear_reference(FINITE)[0] and not linear_reference(BEAM)
    both = refinements(replace(FINITE, bodies=(*FINITE.bodies, replace(BEAM.bodies[1], name="other"))))
    assert (both[1].of("rod").shapes, both[1].of("other").pieces) == (Shapes.CRAIG_BAMPTON, 2)


def test_models_of_another_specification_that_are_the_same_have_its_name() -> None:
    """Of the rigid models there is that of the first specification alone."""
    other = beside(replace(FINITE, name="twin"), FINITE)
    first, second = ladders((FINITE, other), FEW)
    assert [model.label for model in second] == [f"twin: {model.label}" for model in first[1:]]
    _, beams = ladders((FINITE, beside(BEAM, FINITE)), FEW)
    assert beams == ladder(FEW, BEAM)[1:]


def test_another_specification_without_a_model_of_the_orders_is_refused() -> None:
    """`--orders truncated` left component modes out, and the study ended without them and without a word."""
    text = (
        r"spatial_crank_slider has no model of order truncated .* modes are of first order where a file has no elements"
    )
    with pytest.raises(SpecError, match=text):
        ladders((BEAM, beside(FINITE, BEAM)), replace(FEW, orders=("truncated",)))


def test_another_specification_has_to_have_the_plotted_markers() -> None:
    markers = tuple(marker for marker in BEAM.bodies[1].markers if marker.name != "middle")
    without = replace(BEAM, bodies=(BEAM.bodies[0], replace(BEAM.bodies[1], markers=markers), BEAM.bodies[2]), plots=())
    with pytest.raises(SpecError, match=r"in spatial_crank_slider_beam: .*middle"):
        beside(without, FINITE)


def test_colours_tell_orders_of_beams_and_kinds_of_component_modes() -> None:
    models = [LadderModel(Shapes.RIGID), LadderModel(Shapes.FREE, 2), LadderModel(Shapes.POLYNOMIALS, 2)]
    assert list(colour_names(models)) == ["first order", "free modes"]
    assert list(colour_names(models[:2])) == ["free modes"]


ARM = {
    "ground": {"hub": (0, 0, 0)},
    "bodies": {
        "arm": {
            **{"length": 1, "mass": 1, "bending_stiffness": 20, "rotary_inertia": "0.001"},
            "markers": {"root": -1, "tip": 1},
        }
    },
    "joints": {"hub": {"kind": "revolute", "between": ["ground.hub", "arm.root"]}},
    "outputs": {"tip": {"kind": "position", "marker": "arm.tip"}},
    "plots": {"height": {"y": "tip_2"}},
    "simulation": {"duration": 0.1, "output": 0.01},
}


def arm(**changes: Any) -> SpatialScene:
    """A beam that falls about the hinge at its end."""
    return derive.spatial_scene("arm", gravity=(0, "-9.81", 0), **{**ARM, **changes})


@pytest.mark.parametrize(
    "output", [{"kind": "deflection", "marker": "arm.tip"}, {"kind": "bending_moment", "section": "arm.root"}]
)
def test_a_plot_of_what_a_rigid_body_does_not_have_is_named(output: dict[str, str]) -> None:
    """Stability needs no plot, so that its rigid models are tried."""
    scene = derive.spatial_scene("bent", **ARM | {"outputs": {"bent": output}, "plots": {"p": {"y": ["bent_2"]}}})
    with pytest.raises(SpecError, match=f"bodies.arm: as a rigid body it has no {output['kind']} at arm"):
        model_scene(scene, LadderModel(Shapes.RIGID))
    stiffness = studied(scene, ParameterRange("bodies.arm.bending_stiffness", 10, 20, 2))
    assert not model_path(stiffness, LadderModel(Shapes.RIGID)).failure


def test_a_study_in_space_has_errors_costs_and_a_chart() -> None:
    """The reference falls as a rigid arm does, 3 g/2 at the tip at first."""
    scene = arm()
    rows = tuple((t / 100, -0.75 * 9.81 * (t / 100) ** 2) for t in range(11))
    (plot,) = scene.plots
    known = replace(scene, plots=(replace(plot, reference=ReferenceCurve("made.csv", "t", "y", rows)),))
    few: dict[str, Any] = {"orders": ["first"], "shapes": [1], "pieces": [], "sines": [], "runs": 1}
    study = derive.study_accuracy(known, **few, tolerances=[1e-4], error=0.01)
    rigid, beam = study.lines
    assert (rigid.label, beam.label) == ("rigid", "1 beam, P2, first")
    assert rigid.best < 0.01 < beam.best < 1
    assert study.headline.recommended is not None and study.headline.recommended.line is rigid
    assert "arm" in study.shown
    assert "1 beam, P2, first" in accuracy_text(study) and "first order" in accuracy_svg(study)


@pytest.mark.parametrize(
    ("scene", "message"),
    [
        ({"plots": {}}, "plots: a ladder compares a plot"),
        (
            {
                "bodies": {"arm": {"mass": 1, "inertia": [1, 1, 1, 0, 0, 0], "markers": {"root": (0, 0, 0)}}},
                "outputs": {},
                "plots": {},
            },
            "there is no beam and no finite-element body here",
        ),
    ],
    ids=["plot", "flexible"],
)
def test_a_scene_that_cannot_be_studied_says_what_is_missing(scene: dict[str, Any], message: str) -> None:
    with pytest.raises(SpecError, match=message):
        derive.study_accuracy(arm(**scene))


@pytest.mark.long
def test_component_modes_of_the_joints_beat_free_modes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Two vibrations beside six static modes are better than eight free modes; the time that is set is that of runs."""
    spec = str(ROOT / "examples" / "spatial_crank_slider.toml")
    options = ["--component-counts", "2,8", "--tolerances", "1e-5", "--runs", "1", "--error", "0.05", "--json"]
    asked = [*options, "--out", str(tmp_path), "--set", "simulation.duration=0.05"]
    assert main(["study", "accuracy", spec, *asked]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["set"] == ["simulation.duration: 0.2 -> 0.05"] == data["notes"][:1]
    assert data["set"][0].replace(">", "&gt;") in (tmp_path / "accuracy.html").read_text()
    errors = {model["model"]: model["runs"][-1]["rms_error"] for model in data["models"]}
    assert errors["Craig-Bampton + 2 vibrations"] < 0.5 * errors["8 free modes"]
    assert errors["Craig-Bampton + 8 vibrations"] < 0.05
