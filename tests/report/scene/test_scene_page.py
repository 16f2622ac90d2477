"""The page of a scene: bodies, joints, what was left out, the KKT matrix, results."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from pathlib import Path

import pytest

from derive.cli.main import main
from derive.lowering.elimination_orders import fill_in
from derive.pipeline import Built, build
from derive.report.document.anchors import faults
from derive.report.document.page import Page
from derive.report.scene_page import ResultPicture, scene_page
from derive.report.sections.files import SpecificationText
from derive.report.writers.html import html
from derive.simulation.run_record import recorded_warnings
from derive.visual.kkt_matrix import factor_entries, kkt_picture

SCENES = Path(__file__).parents[3] / "scenes"
DRAWING = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9"><rect width="9" height="9"/></svg>'


@cache
def built(name: str) -> Built:
    return build(SCENES / f"{name}.toml")


@cache
def page(name: str) -> Page:
    text = (SCENES / f"{name}.toml").read_text()
    return scene_page(built(name), SpecificationText(f"{name}.toml", text), [ResultPicture("deflection", DRAWING)])


def missing(names: Iterable[str], text: str) -> list[str]:
    return [name for name in names if name not in text]


@pytest.mark.parametrize("name", ["crank_slider_3", "spinning_beam", "spun_up_cantilever"])
def test_every_body_joint_and_multiplier_is_there(name: str) -> None:
    made, text = built(name), html(page(name))
    spec, model = made.spec, made.model
    assert not missing((body.name for body in spec.bodies), text)
    assert not missing((joint.name for joint in spec.joints), text)
    assert not missing((m.name for m in model.multipliers), text)
    assert not missing((out.reason for out in model.eliminated), text)
    assert len(text) < 300_000


@pytest.mark.parametrize("name", ["crank_slider_3", "spinning_beam", "spun_up_cantilever"])
def test_links_lead_somewhere(name: str) -> None:
    assert faults(page(name)) == ()


def test_the_picture_of_the_kkt_matrix_has_all_that_is_filled_in() -> None:
    model = built("crank_slider_3").model
    assert model.kkt is not None
    own, filled = factor_entries(model.kkt)
    assert len(filled) == model.kkt.fill == fill_in(model.kkt.pattern, model.kkt.order)
    assert len(own) == sum(i != j for i, j in model.kkt.pattern.entries)
    names = (*(row.name for row in model.equations), *(m.name for m in model.multipliers))
    picture = kkt_picture(model.kkt, names)
    assert picture.count('class="fill"') == model.kkt.fill
    assert picture.count("pivot of") == len(names)


def test_every_zero_of_the_mass_matrix_has_its_reason() -> None:
    text = html(page("crank_slider_3"))
    assert "the mass matrix is block-diagonal" in text
    assert text.count("condition (17) (no mean displacement)") >= 3


def test_results_that_are_there_are_shown() -> None:
    assert "Results" in html(page("crank_slider_3"))
    text = (SCENES / "crank_slider_3.toml").read_text()
    assert 'id="results"' not in html(scene_page(built("crank_slider_3"), SpecificationText("x.toml", text)))


def test_what_a_run_of_this_scene_warns_of_is_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Warnings are shown with the results; a record of another specification, or a file that is none, is ignored."""
    monkeypatch.chdir(tmp_path)
    scene = tmp_path / "fast.toml"
    text = (
        (SCENES / "spinning_beam.toml")
        .read_text()
        .replace("spin = 25", "spin = 20")
        .replace("duration = 2", "duration = 0.2")
    )
    scene.write_text(text)
    assert main(["simulate", str(scene)]) == 0
    assert main(["report", str(scene)]) == 0
    report = tmp_path / "results" / "spinning_beam" / "spinning_beam.report.html"
    assert "Warning of the run: beam in 1 beam: its axial force changes" in report.read_text()
    scene.write_text(text.replace("spin = 20", "spin = 2"))
    assert main(["report", str(scene)]) == 0
    assert "The run warns" not in report.read_text()
    assert recorded_warnings(scene, built("spinning_beam").spec) == ()


def test_a_body_is_no_scene() -> None:
    body = build(SCENES / "free_beam_mean.toml")
    with pytest.raises(TypeError):
        scene_page(body, SpecificationText("x.toml", ""))
