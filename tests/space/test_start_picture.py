"""The drawing of a scene in space at t = 0, which notebooks show, needs no compiled model and closes its joints."""

from __future__ import annotations

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.simulation.space.marker_frames import MarkerFrame
from derive.visual.spatial_mechanism import JointSymbol
from derive.visual.spatial_scene_picture import joint_marks, undeformed_picture
from derive.visual.undeformed_spatial_poses import initial_spatial_poses, spatial_frame
from explicit_motion import moved
from strict_html import Page

RIGID = ROOT / "examples/spatial_crank_slider_rigid.toml"
VALUES = {"distance": {"distance": 0.5}, "screw": {"pitch": 0.1}, "general": {"removes": ["x", "rx"]}}
SYMBOLS = {
    "fixed": JointSymbol.WELD,
    "revolute": JointSymbol.HINGE,
    "screw": JointSymbol.GUIDE_THAT_TURNS,
    "prismatic": JointSymbol.GUIDE,
    "cylindrical": JointSymbol.GUIDE_THAT_TURNS,
    "universal": JointSymbol.UNIVERSAL,
    "spherical": JointSymbol.BALL,
    "planar": JointSymbol.GUIDE_THAT_TURNS,
    "point_on_line": JointSymbol.GUIDE_THAT_TURNS,
    "general": JointSymbol.GUIDE_THAT_TURNS,
}


def scene_with(kind: str) -> derive.SpatialScene:
    """A body whose guess is off, on a joint to the ground."""
    joint = {"kind": kind, "between": ["ground.base", "body.end"], **VALUES.get(kind, {})}
    start = {"position": [0.3, 0.4, 0.2], "rotation": {"axis": [1, 1, 0], "angle": 0.2}, "guess": True}
    body = {"mass": 1, "inertia": [1, 1, 1, 0, 0, 0], "markers": {"end": [0, 0, 0.1]}, "start": start}
    return derive.spatial_scene("one", ground={"base": [0, 0, 0]}, bodies={"body": body}, joints={"joint": joint})


def closed(scene: derive.SpatialScene) -> list[tuple[MarkerFrame, MarkerFrame]]:
    """Both frames of each joint."""
    poses = initial_spatial_poses(scene)
    first, second = (
        [spatial_frame(scene, end, poses) for end in ends]
        for ends in zip(*((joint.first, joint.second) for joint in scene.joints), strict=True)
    )
    return list(zip(first, second, strict=True))


@pytest.mark.parametrize("kind", SPATIAL_JOINTS)
def test_each_joint_is_closed_and_has_the_symbol_of_what_it_leaves(kind: str) -> None:
    scene = scene_with(kind)
    ((first, second),) = closed(scene)
    apart, turned = first.axes.T @ (second.position - first.position), first.axes.T @ second.axes
    removed = SPATIAL_JOINTS[kind].removed(scene.joints[0])
    assert all(abs(apart["xyz".index(name)]) < 1e-9 for name in removed if name in "xyz")
    if {"rx", "ry"} <= {*removed}:
        assert turned[:, 2] == pytest.approx([0, 0, 1], abs=1e-9)
    if kind == "distance":
        assert np.linalg.norm(apart) == pytest.approx(0.5, abs=1e-9)
        assert "tie" in Page(undeformed_picture(scene)).values("class")
    else:
        (mark,) = joint_marks(scene, initial_spatial_poses(scene))
        assert mark.symbol is SYMBOLS[kind] and mark.at == pytest.approx(second.position)
        assert f"joint: {kind}" in Page(undeformed_picture(scene)).words["title"]


def test_the_drawing_of_a_loop_is_where_a_simulation_starts() -> None:
    scene = derive.read(RIGID)
    poses = initial_spatial_poses(scene)
    for joint, (first, second) in zip(scene.joints, closed(scene), strict=True):
        if joint.kind in ("revolute", "spherical", "universal"):
            assert second.position == pytest.approx(first.position, abs=1e-9), joint.name
    motion = moved(scene, duration=0.01, output=0.01)
    for body in scene.bodies:
        assert motion.motion.pose(body.name)[0, :3] == pytest.approx(poses[body.name][0], abs=1e-6), body.name


def test_a_notebook_shows_the_drawing() -> None:
    page = Page(derive.read(RIGID)._repr_html_())
    assert page.faults == [] and page.count("svg") == 1
    assert {"bearing: revolute", "ball: spherical", "yoke: universal", "guide: prismatic"} <= {*page.words["title"]}
    assert page.values("class").count("stand") == 2  # both markers of the ground


def test_no_label_is_cut_off_at_the_right_edge() -> None:
    """The slider is at the right, and the markers of three bodies share its place."""
    scene = derive.read(ROOT / "examples/spatial_crank_slider_beam.toml")
    assert isinstance(scene, derive.SpatialScene)
    svg = undeformed_picture(scene)
    width = float(svg.split('viewBox="0 0 ')[1].split()[0])
    start = float(svg.split(">yoke, pin, shoe<")[0].rsplit('x="', 1)[1].split('"')[0])
    assert start + 6.5 * len("yoke, pin, shoe") <= width
