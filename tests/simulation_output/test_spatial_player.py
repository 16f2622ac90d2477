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
from derive.simulation.observables.spatial_player_data import MAX_NODES, neighbours, spatial_player_data
from derive.simulation.trajectory import Trajectory
from derive.visual.player import spatial_player_page

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
    """(nodes, 3): x = c + Q (X + Phi alpha) of the data of a page, at an instant."""

    def now(channels: list[dict]) -> np.ndarray:
        values = [decoded(channel) for channel in channels]
        return np.array([v[instant if len(v) > 1 else 0] for v in values])

    c, e, alpha = now(data["position"]), now(data["quaternion"]), now(data["amplitudes"])
    w, r = np.array(data["nodes"]) + np.tensordot(alpha, np.array(data["shapes"]), 1), e[1:]
    return c + w + 2 * np.cross(r, np.cross(r, w) + e[0] * w)


def test_nodes_of_the_page_are_where_the_model_has_its_markers(trajectory: Trajectory) -> None:
    data = spatial_player_data(trajectory.body, trajectory.t, trajectory.q)
    for instant in (0, 7, 20):
        x = node_positions(data, instant)
        for marker in data["markers"]:
            q, v = trajectory.q[instant], trajectory.v[instant]
            wanted = trajectory.motion.native.marker(marker["name"], q, v, trajectory.motion.k)[0]
            np.testing.assert_allclose(x[marker["node"]], wanted, atol=3e-6)  # m


def test_edges_are_those_of_the_cells_of_a_grid(trajectory: Trajectory) -> None:
    """The block has 17 x 5 x 3 nodes: 16 5 3 + 17 4 3 + 17 5 2 edges along its axes, and no diagonals."""
    data = spatial_player_data(trajectory.body, trajectory.t, trajectory.q)
    x, edges = np.array(data["nodes"]), np.array(data["edges"])
    assert len(edges) == 16 * 5 * 3 + 17 * 4 * 3 + 17 * 5 * 2
    assert (np.count_nonzero(np.abs(x[edges[:, 0]] - x[edges[:, 1]]) > 1e-9, axis=1) == 1).all()
    assert neighbours(np.zeros((1, 3))) == []


def test_a_body_of_many_nodes_is_drawn_as_a_box(trajectory: Trajectory, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = spatial_player_data(trajectory.body, trajectory.t, trajectory.q)
    assert len(whole["nodes"]) == 255 <= MAX_NODES
    monkeypatch.setattr("derive.simulation.observables.spatial_player_data.MAX_NODES", 254)
    box = spatial_player_data(trajectory.body, trajectory.t, trajectory.q)
    assert len(box["nodes"]) == 8 and len(box["edges"]) == 12 and box["markers"] == []
    corners = node_positions(whole, 9)[[0, 254]]
    found = node_positions(box, 9)[[0, 7]]
    np.testing.assert_allclose(found, corners, atol=1e-6)


def test_the_page_needs_nothing_from_outside(trajectory: Trajectory) -> None:
    text = spatial_player_page(spatial_player_data(trajectory.body, trajectory.t, trajectory.q))
    assert MARK in text[:1000] and "prefers-color-scheme: dark" in text
    assert not re.search(r"https?://|<link|@import|url\(|fetch\(|import\(|src=", text)
    assert len(text.encode()) < 300_000


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here")
def test_it_plays_in_a_browser(trajectory: Trajectory, tmp_path: Path) -> None:
    """From the front e1 points to the right and e3 upwards: node 0 is drawn there, as far from the middle as it is."""
    data = spatial_player_data(trajectory.body, trajectory.t, trajectory.q)
    path = tmp_path / "page.html"
    path.write_text(spatial_player_page(data))
    dom = browsed(path, "t=0.013&yaw=0&pitch=0", "1000,900")
    assert "t = <b>0.01300</b> s" in dom
    x, y = map(float, re.search(r'data-corner="([-\d.]+) ([-\d.]+)"', dom).groups())
    width, height = map(int, re.search(r'data-size="(\d+) (\d+)"', dom).groups())
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
