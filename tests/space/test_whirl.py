"""The modes of a rotor that rotates steadily: a flexible shaft in two bearings, with a disk, whirls as is known.

The shaft deflects in its two lowest sines, in both planes. In the first one the disk moves sideways, and the rotation W
has no influence. In the second one it tilts: with its amplitude q (complex, y + i z, in inertial axes)

    (m + A) q'' - i C W q' + k q = 0

where m is the modal mass of the shaft, whose sections are nearly points, and A and C are the moments of inertia of the
disk across and along the shaft, times the square of the slope. Forward whirl is fast, backward whirl slow.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import derive
from derive.cli.main import main
from derive.simulation.linear.modes import modes
from derive.simulation.linear.whirl import whirls
from derive.visual.mode_pages import modes_picture

LENGTH, SHAFT_MASS, SIDE, STIFFNESS = 1.0, 2.0, 0.02, 200.0
"""m, kg, half of the side of a section (m), and the bending stiffness (N m^2)."""
CORNER = 2e-4
"""The share of the mass of a section at a corner, which makes it a little more than a point."""
DISK_MASS, DISK_ACROSS, DISK_ALONG = 5.0, 0.05, 0.09
SPIN = 150.0
"""The rotation, rad/s."""
SECTIONS, CORNERS = 9, ((1, 1), (1, -1), (-1, -1), (-1, 1))
WAVES = np.pi * np.array([1, 2]) / LENGTH


def shaft(path: Path) -> None:
    """Write the nodes: a section has one on the axis and four corners; the ends are half sections."""
    x = np.linspace(0, LENGTH, SECTIONS)
    across = SIDE * np.array([(0, 0), *CORNERS])
    positions = np.array([(xi, y, z) for xi in x for y, z in across])
    weights = np.full(SECTIONS, SHAFT_MASS / (SECTIONS - 1))
    weights[[0, -1]] /= 2
    mass = np.concatenate([w * np.array([1 - 4 * CORNER, *[CORNER] * 4]) for w in weights])
    modes = np.zeros((4, len(positions), 3))
    for i, wave in enumerate(WAVES):
        for j, axis in enumerate((1, 2)):
            modes[2 * i + j, :, axis] = np.sin(wave * positions[:, 0])
            modes[2 * i + j, :, 0] = -positions[:, axis] * wave * np.cos(wave * positions[:, 0])
    stiffness = np.diag(np.repeat(STIFFNESS * WAVES**4 * LENGTH / 2, 2))
    np.savez(path, positions=positions, mass=mass, modes=modes, modal_stiffness=stiffness)


def section(i: int) -> str:
    """The corners of a section as a marker."""
    return f"{{ nodes = {[5 * i + k for k in range(1, 5)]} }}"


SCENE = f"""
name = "rotor"
[scene]
start = "steady"
[ground.markers]
left = [0, 0, 0]
right = {{ at = [{LENGTH}, 0, 0], rotation = {{ z = [1, 0, 0], x = [0, 1, 0] }} }}
[bodies.shaft]
nodes = "shaft.npz"
units = "SI"
modes = 4
markers = {{ left = {section(0)}, middle = {section(4)}, right = {section(8)} }}
start = {{ position = [{LENGTH / 2}, 0, 0], rotation = [1, 0, 0, 0], amplitudes = [0, 0, 0, 0] }}
[bodies.disk]
mass = {DISK_MASS}
inertia = [{DISK_ALONG}, {DISK_ACROSS}, {DISK_ACROSS}, 0, 0, 0]
markers = {{ hub = [0, 0, 0] }}
[bodies.disk.start]
position = [{LENGTH / 2}, 0, 0]
rotation = [1, 0, 0, 0]
angular_velocity = [{SPIN}, 0, 0]
[joints.ball]
kind = "spherical"
between = ["ground.left", "shaft.left"]
[joints.sleeve]
kind = "point_on_line"
between = ["ground.right", "shaft.right"]
[joints.fit]
kind = "fixed"
between = ["shaft.middle", "disk.hub"]
"""


def whirl(spin: float) -> tuple[float, float]:
    """The frequencies (rad/s) of forward and backward whirl of the tilting disk in the inertial frame."""
    A, C, k = (x * WAVES[1] ** 2 for x in (DISK_ACROSS, DISK_ALONG, STIFFNESS * WAVES[1] ** 2 * LENGTH / 2))
    backward, forward = sorted(np.roots([SHAFT_MASS / 2 + A, -C * spin, -k]))
    return float(forward), float(backward)


@pytest.mark.long
def test_the_whirl_of_a_rotor(tmp_path: Path) -> None:
    """In axes that rotate along the rotation shifts the frequencies of circles; `whirls` are those in inertial axes."""
    shaft(tmp_path / "shaft.npz")
    (tmp_path / "rotor.toml").write_text(SCENE)
    result = modes(derive.read(tmp_path / "rotor.toml"))
    assert result.steady is not None
    assert result.steady.text == "rotation with 150 rad/s about [1, 0, 0] through [0, 0, 0] m"
    forward, backward = whirl(SPIN)
    assert forward > 300 and backward < -150  # far from the frequency without rotation, either way
    sideways = np.sqrt(STIFFNESS * WAVES[0] ** 4 * LENGTH / 2 / (SHAFT_MASS / 2 + DISK_MASS))
    found = whirls(result)
    assert found is not None and found[0] is None and not result.modes[0].eigenvalue  # the rotation itself
    frequencies = 2 * np.pi * np.sort(np.array(found[1:], dtype=float))
    assert frequencies == pytest.approx([backward, -sideways, sideways, forward], rel=1e-5)
    in_rotating_axes = np.sort(2 * np.pi * result.frequencies[1:])
    assert in_rotating_axes == pytest.approx(np.sort(np.abs(frequencies - SPIN)), rel=1e-9)
    assert modes_picture(result, 4).count('<path class="there"') == 4


@pytest.mark.long
def test_the_command_prints_the_whirl(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shaft(tmp_path / "shaft.npz")
    (tmp_path / "rotor.toml").write_text(SCENE)
    assert main(["modes", str(tmp_path / "rotor.toml"), "--out", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert "modes about the steady rotation with 150 rad/s about [1, 0, 0]" in text
    assert "forward 53.3874" in text and "backward 24.865" in text
    assert "positions of the markers, in axes that rotate with the scene" in text
    record = json.loads((tmp_path / "rotor" / "rotor.modes.json").read_text())
    assert record["steady"]["spin"] == pytest.approx(150)
    assert record["modes"][2]["whirl"] == pytest.approx(whirl(SPIN)[0] / (2 * np.pi), rel=1e-5)
