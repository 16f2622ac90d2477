"""The drawing of a mechanism: everything has its name, and joints are closed at t = 0."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from derive.report.writers.picture import inline
from derive.spec.model.scene import Scene
from derive.spec.toml.read import read
from derive.visual.mechanism import mechanism_picture
from derive.visual.undeformed_poses import initial_poses, position

SCENES = Path(__file__).parents[3] / "scenes"
NAMES = ("crank_slider_3", "four_bar", "double_pendulum", "spinning_beam", "spun_up_cantilever")


def scene(name: str) -> Scene:
    found = read(SCENES / f"{name}.toml")
    assert isinstance(found, Scene)
    return found


@pytest.mark.parametrize("name", NAMES)
def test_bodies_joints_drives_and_loads_have_labels(name: str) -> None:
    spec, picture = scene(name), mechanism_picture(scene(name))
    texts = [e.text for e in ElementTree.fromstring(picture).iter() if e.tag.endswith("}text")]
    named = (*spec.bodies, *spec.joints, *spec.drives, *spec.forces, *spec.torques, *spec.springs)
    assert sorted(one.name for one in named) == sorted(filter(None, texts))
    assert "picture-1" in inline(picture, "picture-1", "a mechanism")


@pytest.mark.parametrize("name", NAMES)
def test_joints_are_closed(name: str) -> None:
    """The guess of the four-bar is off by millimetres."""
    spec = scene(name)
    poses = initial_poses(spec)
    for joint in spec.joints:
        apart = position(spec, joint.second, poses) - position(spec, joint.first, poses)
        if joint.kind == "translational":
            axis = np.array([float(a) for a in joint.axis])
            assert abs(axis[0] * apart[1] - axis[1] * apart[0]) < 1e-9
        else:
            assert np.abs(apart).max() < 1e-9, joint.name


@pytest.mark.long
def test_a_mechanism_that_cannot_be_closed_is_drawn_as_guessed() -> None:
    spec = scene("four_bar")
    apart = replace(spec, ground=tuple(replace(p, x=5 * p.x) for p in spec.ground))
    guess = {b.name: (*b.start.position, b.start.angle) for b in spec.bodies}
    poses = initial_poses(apart)
    assert all(tuple(poses[name]) == pose for name, pose in guess.items())
    assert abs(initial_poses(spec)["coupler"][0] - guess["coupler"][0]) > 1e-5


@pytest.mark.parametrize("name", NAMES)
def test_the_picture_is_as_wide_as_what_is_drawn(name: str) -> None:
    root = ElementTree.fromstring(mechanism_picture(scene(name)))
    left, _, width, _ = map(float, root.get("viewBox", "").split())
    edges = []
    for e in root.iter():
        if e.tag.endswith("}text"):
            half = 3.3 * len(e.text or "")
            edges += [float(e.get("x", 0)) - half, float(e.get("x", 0)) + half]
        edges += [float(pair.split(",")[0]) for pair in e.get("points", "").split()]
    assert left <= min(edges) and max(edges) <= left + width
    assert min(edges) - left < 40 and left + width - max(edges) < 40


def test_labels_do_not_cover_each_other() -> None:
    root = ElementTree.fromstring(mechanism_picture(scene("crank_slider_3")))
    boxes = []
    for e in root.iter():
        if e.tag.endswith("}text"):
            wide = 6.6 * len(e.text or "")
            boxes.append((float(e.get("x", 0)) - wide / 2, float(e.get("y", 0)), wide))
    for k, (x, y, wide) in enumerate(boxes):
        for other, above, room in boxes[:k]:
            assert abs(y - above) >= 14 or x + wide <= other or other + room <= x


def test_of_many_instances_the_first_and_the_last_have_labels() -> None:
    """Labels of a hundred bodies and joints would cover each other."""
    picture = mechanism_picture(read(Path(__file__).parents[3] / "examples" / "chain_100.toml"))
    shown = {name for name in ("hinge", "link[0]", "link[99]", "weld[0]", "weld[98]") if f">{name}<" in picture}
    assert len(shown) == 5 and picture.count("link[") == 2
