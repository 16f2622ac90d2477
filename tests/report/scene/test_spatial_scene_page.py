"""The page of a scene in space: its drawing, bodies, joints, marker frames and constraints."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.cli.main import main
from derive.pipeline import Built, build
from derive.report.document.anchors import faults
from derive.report.document.page import Page
from derive.report.scene_page import scene_page
from derive.report.sections.files import SpecificationText
from derive.report.writers.html import html
from derive.report.writers.latex import latex
from derive.simulation.observables.body_surface import Surface
from derive.simulation.observables.spatial_player_data import BodyPath, DrawnBody, Tie
from derive.spec.model.spatial_scene import SpatialScene
from derive.visual.spatial_mechanism import spatial_picture
from derive.visual.spatial_scene_picture import undeformed_picture
from svg_text import text_boxes

EXAMPLE = ROOT / "examples/spatial_crank_slider_rigid.toml"


@pytest.fixture(scope="module")
def built() -> Built:
    return build(EXAMPLE)


@pytest.fixture(scope="module")
def page(built: Built) -> Page:
    return scene_page(built, SpecificationText(EXAMPLE.name, EXAMPLE.read_text()))


def test_every_body_joint_and_multiplier_is_there(built: Built, page: Page) -> None:
    text = html(page)
    names = [body.name for body in built.spec.bodies] + [joint.name for joint in built.spec.joints]
    assert not [name for name in (*names, *(m.name for m in built.model.multipliers)) if name not in text]
    assert not [out.reason for out in built.model.eliminated if out.reason not in text]
    assert "else in components of the frame of marker 1" in text and "2\u00a0kg; 0.001\u00a0kg" in text
    assert faults(page) == ()
    assert "angular velocity of the floating frame in components of the inertial frame" in latex(page)


def test_the_command_draws_the_initial_configuration(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    assert main(["report", str(EXAMPLE), "--out", str(page)]) == 0
    text = page.read_text()
    assert "The mechanism at t = 0 with its bodies crank, rod and slider" in text
    assert 'class="face rigid"' in text and ">hub, bearing</text>" in text


def test_near_faces_hide_far_ones_and_points_are_to_scale() -> None:
    """Two squares across e2, seen from -e2: the far one is drawn first, and e1 points to the right, e3 upwards."""
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]])
    still = BodyPath(np.zeros((1, 3)), np.array([[1.0, 0, 0, 0]]), np.zeros((1, 0)))
    moved = BodyPath(np.array([[0.0, 5.0, 0]]), np.array([[1.0, 0, 0, 0]]), np.zeros((1, 1)))
    near = DrawnBody("near", square, np.zeros((0, 4, 3)), Surface(((0, 1, 2, 3),), ()), 1.0, (("corner", 2),))
    far = DrawnBody("far", square, np.zeros((1, 4, 3)), Surface(((0, 1, 2, 3),), ()), 1.0)
    ties = [Tie(False, ((0, 0), (-1, 0)))]
    drawn = spatial_picture("two squares", [near, far], [still, moved], [("origin", np.zeros(3))], ties)
    assert drawn.index('class="face flexible"') < drawn.index('class="face rigid"')
    place = r'cx="(\S+)" cy="(\S+)" r="2.5"/>\n.*>'
    corner, origin = (re.search(f"{place}{name}<", drawn) for name in ("corner", "origin"))
    assert corner and origin
    assert 'class="tie" d="M{} {}L{} {}"'.format(*corner.groups(), *origin.groups()) in drawn
    assert {"corner", "origin", "e1", "e2", "e3"} <= {box.text for box in text_boxes(drawn)}


def test_the_axes_are_within_the_picture_and_markers_at_one_place_have_one_label() -> None:
    path = ROOT / "examples/whirling_shaft.toml"
    scene = derive.read(path)
    assert isinstance(scene, SpatialScene)
    svg = undeformed_picture(scene)
    _, _, width, height = map(float, re.findall(r'viewBox="([^"]*)"', svg)[0].split())
    tips = re.findall(r'class="axis" d="M\S+ [^L]*L(\S+) ([^"]*)"', svg)
    assert len(tips) == 3 and all(0 < float(x) < width and 0 < float(y) < height for x, y in tips)
    assert svg.count("left</text>") == 1
