"""Beams in pictures and players: drawn where the generated code has them, also at second order, with their masses."""

from __future__ import annotations

import re
import shutil
import subprocess
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import derive
from conftest import QUICK
from derive.generated_models import generated_explicit
from derive.runtime.compiler import ESSENTIAL
from derive.runtime.loading import load_scene
from derive.simulation.linear.displaced import scene_lines
from derive.simulation.observables.beams import axis_points, beam_bodies, beam_points
from derive.simulation.observables.marker_positions import marker_positions
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.observables.player_data import player_data
from derive.spec.model.markers import MarkerRef
from derive.visual.mechanism import mechanism_picture
from derive.visual.player import player_page

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
FRAMES = {"mean": "mean", "chord": "chord", "point": "point", "tangent": {"kind": "tangent", "at": -1}}
PLACES = {"left": -1, "inside": "1/3", "right": 1}


def drawn(frame: str, pieces: int = 1, order: int = 2) -> derive.Scene:
    """A rod of 2 m that bends, stretches and has a mass at its right end."""
    rod = {"mass": 1, "length": 2, "bending_stiffness": 3, "ansatz": [f"xi^{n}" for n in range(4)], "markers": PLACES}
    rod |= {"frame": FRAMES[frame], "pieces": pieces, "order": order, "masses": {"tip": {"at": 1, "mass": 2}}}
    rod |= {"axial": {"ansatz": ["xi"], "stiffness": 100}}
    return derive.scene(
        "drawn",
        ground={"wall": [0, 0]},
        bodies={"rod": rod},
        joints={"pin": {"kind": "revolute", "between": ["ground.wall", "rod.left"]}},
        simulation={"duration": 1, "output": 0.5},
    )


@cache
def motion(frame: str, pieces: int = 1, order: int = 2) -> SceneMotion:
    """The rod in three states of large deformation."""
    scene = drawn(frame, pieces, order)
    native = load_scene(generated_explicit(scene)[1], (*QUICK, *ESSENTIAL))
    q = np.random.default_rng(1).uniform(-0.3, 0.3, (3, native.nq))
    return SceneMotion(scene, native, native.setup(), np.arange(3.0), q, 0 * q)


@pytest.mark.parametrize(
    ("frame", "pieces"),
    [
        ("tangent", 1),
        ("mean", 2),
        *(pytest.param(frame, 1, marks=pytest.mark.long) for frame in ("mean", "chord", "point")),
    ],
)
def test_points_of_the_axis_are_those_of_the_generated_code(frame: str, pieces: int) -> None:
    shown = motion(frame, pieces)
    (rod,) = beam_bodies(shown.scene)
    at = {name: marker_positions(shown, MarkerRef("rod", name)) for name in PLACES}
    left, *_, right = beam_points(shown, rod)
    np.testing.assert_allclose([left, right], [at["left"], at["right"]], atol=1e-12)
    if pieces == 1:
        np.testing.assert_allclose(axis_points(shown, rod, "rod", np.array([1 / 3]))[:, 0], at["inside"], atol=1e-12)
    axis, tip, *_ = scene_lines(shown)
    np.testing.assert_allclose(axis[:, [0, -1]].swapaxes(0, 1), [at["left"], at["right"]], atol=1e-12)
    np.testing.assert_allclose(tip[:, 0], at["right"], atol=1e-12)


def test_the_drawing_of_a_mechanism_has_a_dot_for_a_mass() -> None:
    text = mechanism_picture(drawn("mean"))
    assert text.count('<circle class="mass"') == 1 and ">tip</text>" in text


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here")
@pytest.mark.parametrize("order", [pytest.param(1, marks=pytest.mark.long), 2])
def test_the_player_draws_the_rod_and_its_mass_where_they_are(order: int, tmp_path: Path) -> None:
    shown = motion("mean", 1, order)
    path = tmp_path / "page.html"
    data = player_data(shown, [])
    path.write_text(player_page(data))
    command = [str(CHROMIUM), "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'profile'}"]
    command += ["--virtual-time-budget=1000", "--window-size=1000,800", "--dump-dom", f"file://{path}#t=1"]
    dom = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout
    box = re.search(r'viewBox="([-\d.]+) 0 ([-\d.]+) ([-\d.]+)"', dom)
    low_x, low_y, high_x, high_y = data["view"]
    scale = min(float(box[2]) / (high_x - low_x), float(box[3]) / (high_y - low_y))  # type: ignore[index]
    axis = re.search(r'<path data-k="rod" d="M([^"]*)"', dom)[1].split("L")  # type: ignore[index]
    mass = re.search(r'<path data-k="mass" d="M([-\d.]+) ([-\d.]+)a([-\d.]+) ', dom)
    centre = f"{float(mass[1]) + float(mass[3])} {mass[2]}"  # type: ignore[index]
    for name, text in (("left", axis[0]), ("right", axis[-1]), ("right", centre)):
        x, y = marker_positions(shown, MarkerRef("rod", name))[1]
        expected = [(x - low_x) * scale, (high_y - y) * scale]
        np.testing.assert_allclose([float(c) for c in text.split()], expected, atol=0.15)  # pixels
