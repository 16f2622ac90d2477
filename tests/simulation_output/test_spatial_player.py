"""`tisserand simulate` of a single body in space: its files, and the page that plays it in three dimensions."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import derive
from browser import CHROMIUM, browsed
from conftest import ROOT
from derive.artifacts import MARK
from derive.cli.main import main
from derive.simulation.observables.spatial_player_data import MAX_NODES, Tie, rigid_drawing, spatial_player_data
from derive.simulation.observables.spatial_scene_player import drawn_bodies, ties
from derive.simulation.trajectory import Trajectory
from derive.spec.model.beam_pieces import in_pieces
from derive.spec.model.specification import SpatialScene
from derive.spec.toml.read import parse
from derive.visual.player import spatial_player_page
from docs.gallery.pages import FITTING

START = derive.SpatialStart(
    position=(0.1, 0.0, 0.0),
    quaternion=(0.6, 0.0, 0.0, 0.8),
    velocity=(3.0, 0.0, 1.0),
    angular_velocity=(5.0, 40.0, 20.0),
    amplitudes=(1e-3,),
)


@pytest.fixture(scope="module")
def trajectory() -> Trajectory:
    block = replace(derive.read(ROOT / "scenes/block.toml"), modes=1, start=START)
    return derive.simulate(block, duration=0.02, output=1e-3, tolerance=1e-6)


def decoded(channel: dict) -> np.ndarray:
    return np.cumsum(channel["values"]) * channel["step"]


def node_positions(data: dict, instant: int) -> np.ndarray:
    """(nodes, 3): x = c + Q (X + Phi alpha) of the first body of the data of a page, at an instant."""
    body, path = data["bodies"][0], data["paths"][0]

    def now(channels: list[dict]) -> np.ndarray:
        values = [decoded(channel) for channel in channels]
        return np.array([v[instant if len(v) > 1 else 0] for v in values])

    c, e, alpha = now(path["position"]), now(path["quaternion"]), now(path["amplitudes"])
    w, r = np.array(body["nodes"]) + np.tensordot(alpha, np.array(body["shapes"]), 1), e[1:]
    return c + w + 2 * np.cross(r, np.cross(r, w) + e[0] * w)


def test_nodes_of_the_page_are_where_the_model_has_its_markers(trajectory: Trajectory) -> None:
    data = spatial_player_data(trajectory.body, trajectory.t, trajectory.q)
    for instant in (0, 7, 20):
        x = node_positions(data, instant)
        for marker in data["bodies"][0]["markers"]:
            q, v = trajectory.q[instant], trajectory.v[instant]
            wanted = trajectory.motion.native.marker(marker["name"], q, v, trajectory.motion.k)[0]
            np.testing.assert_allclose(x[marker["node"]], wanted, atol=3e-6)  # m


def test_a_body_of_many_nodes_is_drawn_as_a_box(trajectory: Trajectory, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = spatial_player_data(trajectory.body, trajectory.t, trajectory.q)
    assert len(whole["bodies"][0]["nodes"]) == 210 + 3 <= MAX_NODES  # those of the surface, and the markers
    monkeypatch.setattr("derive.simulation.observables.spatial_player_data.MAX_NODES", 209)
    box = spatial_player_data(trajectory.body, trajectory.t, trajectory.q)
    (body,) = box["bodies"]
    assert len(body["nodes"]) == 8 + 3 and len(body["edges"]) == 12 and len(body["faces"]) == 6
    assert sides_of(body) == {tuple(sorted(edge)) for edge in body["edges"]}
    corners = node_positions(whole, 9)[[0, 209]]
    found = node_positions(box, 9)[[0, 7]]
    np.testing.assert_allclose(found, corners, atol=1e-6)


def sides_of(body: dict) -> set[tuple[int, int]]:
    """The edges of the faces of a body, each with the smaller number first."""
    faces = body["faces"]
    return {tuple(sorted((face[i - 1], face[i]))) for face in faces for i in range(len(face))}  # type: ignore[misc]


def test_the_colours_measure_the_largest_displacement(trajectory: Trajectory) -> None:
    data = spatial_player_data(trajectory.body, trajectory.t, trajectory.q)
    largest = np.abs(trajectory.q[:, 7]).max()
    shape = np.linalg.norm(np.array(data["bodies"][0]["shapes"][0]), axis=1).max()
    assert data["displacement"] == pytest.approx(largest * shape, rel=1e-4)


def test_a_rigid_body_is_the_box_of_its_inertia_and_lines_to_its_markers() -> None:
    """A homogeneous box of 2 kg with sides of 0.2, 0.4 and 0.6 m, about its centre of mass, turned about e3."""
    sides, turned = np.array([0.2, 0.4, 0.6]), np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]])
    inertia = 2 / 12 * ((sides**2).sum() * np.eye(3) - np.diag(sides**2))
    centre = np.array([0.1, 0, 0])
    drawn = rigid_drawing("crate", 2.0, centre, turned @ inertia @ turned.T, [("hook", np.array([1.0, 0, 0]))])
    corners = np.sort(np.abs((drawn.x[:8] - centre) @ turned), axis=0)
    np.testing.assert_allclose(corners, np.tile(sides / 2, (8, 1)), atol=1e-12)
    assert drawn.links == ((8, 9),) and drawn.markers == (("hook", 9),) and drawn.radius == 1
    lines = rigid_drawing("frame", 0.0, centre, np.zeros((3, 3)), [("a", np.zeros(3)), ("b", np.ones(3))])
    assert lines.links == ((0, 1),) and not lines.surface.faces


HUNG = """
name = "hung"
scene = { gravity = [0, 0, -9.81] }
ground.markers = { beam = [0, 0, 1], hook = [0, 1, 1] }
bodies.lamp = { mass = 1, inertia = [1, 1, 1, 0, 0, 0], markers = { side = [1, 0, 0], eye = [0, 1, 0] } }
joints.rope = { kind = "distance", between = ["lamp.eye", "ground.hook"], distance = 1 }
joints.ball = { kind = "spherical", between = ["lamp.eye", "ground.hook"] }
simulation = { duration = 1, output = 0.1 }
[springs]
cord = { kind = "linear", between = ["ground.beam", "lamp.side"], stiffness = 1 }
wire = { kind = "rotational", between = ["ground.beam", "lamp.side"], stiffness = 1 }
"""


def test_springs_along_a_line_and_distances_are_lines_between_markers() -> None:
    scene = parse(HUNG)
    assert isinstance(scene, SpatialScene)
    assert ties(scene) == [Tie(True, ((-1, 0), (0, 0))), Tie(False, ((0, 1), (-1, 1)))]


def test_the_markers_at_which_pieces_are_welded_are_not_shown() -> None:
    text = """
name = "rod"
scene = { gravity = [0, 0, -9.81] }
ground.markers.o = [0, 0, 0]
simulation = { duration = 1, output = 0.1 }
[bodies.rod]
length = 1
mass = 1
bending_stiffness = 1
rotary_inertia = 1e-3
pieces = 3
markers = { root = -1, tip = 1 }
[joints.root]
kind = "spherical"
between = ["ground.o", "rod.root"]
"""
    scene = parse(text)
    assert isinstance(scene, SpatialScene)
    drawn = drawn_bodies(in_pieces(scene))
    assert [[name for name, _ in body.markers] for body in drawn] == [["root"], [], ["tip"]]


def test_the_page_needs_nothing_from_outside(trajectory: Trajectory) -> None:
    text = spatial_player_page(spatial_player_data(trajectory.body, trajectory.t, trajectory.q))
    assert MARK in text[:1000] and "prefers-color-scheme: dark" in text
    assert set(re.findall(r"https?://[^\s\"'`]+", text)) == {"http://www.w3.org/2000/svg"}  # the name of SVG
    assert not re.search(r"<link|@import|url\(|fetch\(|import\(|src=", text)
    assert len(text.encode()) < 300_000


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here")
def test_a_page_with_a_player_in_a_frame_shows_all_of_it(trajectory: Trajectory, tmp_path: Path) -> None:
    player = spatial_player_page(spatial_player_data(trajectory.body, trajectory.t, trajectory.q))
    (tmp_path / "player.html").write_text(player)
    page = tmp_path / "page.html"
    page.write_text(
        f'<!doctype html><body>{FITTING}<iframe class="gallery-motion" width="700" src="player.html"></iframe></body>'
    )
    height = re.search(r'style="height: (\d+)px', browsed(page, "", "800,600"))
    assert height is not None and 640 < int(height[1]) < 900  # the canvas of 560 with the controls; 150 by itself


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here")
def test_it_plays_in_a_browser(trajectory: Trajectory, tmp_path: Path) -> None:
    """From the front e1 points to the right and e3 upwards: node 0 is drawn there, as far from the middle as it is.

    The names of markers that lie on each other are written behind each other.
    """
    data = spatial_player_data(trajectory.body, trajectory.t, trajectory.q)
    body = data["bodies"][0]
    far = int(np.argmax(np.linalg.norm(np.array(body["nodes"]) - body["nodes"][0], axis=1)))
    body["markers"] = [
        {"name": name, "node": node} for name, node in (("pin", 0), ("end", far), ("eye", 0), ("pin", 0))
    ]
    path = tmp_path / "page.html"
    path.write_text(spatial_player_page(data))
    dom = browsed(path, "t=0.013&yaw=0&pitch=0", "1000,900")
    assert "t = <b>0.01300</b> s" in dom
    x, y = map(float, re.search(r'data-corner="([-\d.]+) ([-\d.]+)"', dom).groups())
    width, height = map(int, re.search(r'data-size="(\d+) (\d+)"', dom).groups())
    assert 'data-names="pin, eye; end"' in dom
    scale = 0.45 * min(width, height) / data["reach"]
    wanted = node_positions(data, 13)[0] - data["centre"]
    assert x == pytest.approx(width / 2 + scale * wanted[0], abs=0.02)
    assert y == pytest.approx(height / 2 - scale * wanted[2], abs=0.02)


def test_the_command_writes_table_plots_and_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = str(ROOT / "scenes/block.toml")
    values = ["--set", "body.modes=1", "--set", "body.start.angular_velocity=[0, 0, 10]"]
    arguments = ["simulate", spec, "--out", str(tmp_path), "--duration", "0.01", "--output", "1e-3", *values]
    assert main(arguments) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[:3] == [
        "set body.modes: 8 -> 1",
        "set body.start.angular_velocity: [0, 0, 0] -> [0, 0, 10]",
        "block: 0.01 s",
    ]
    folder = tmp_path / "block"
    pictures = [f"{name}.svg" for name in ("amplitudes", "angular_velocity", "energy", "position", "rotation")]
    assert sorted(p.name for p in folder.iterdir()) == sorted(["block.csv", "block.html", "block.json", *pictures])
    table = np.genfromtxt(folder / "block.csv", names=True, delimiter=",")
    assert table["omega3"][-1] == pytest.approx(10, abs=1e-6) and len(table) == 11
    assert json.loads((folder / "block.json").read_text())["last_state"]["t"] == 0.01
    (tmp_path / "file").write_text("")
    assert main([*arguments[:2], "--out", str(tmp_path / "file"), *arguments[4:]]) == 2
    assert "this is a file, not a folder" in capsys.readouterr().err
