"""Starts that meet joints badly, nodes without rotation, and frames that are none: a line each, and nothing written."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from conftest import ROOT
from derive.cli.main import main
from derive.spec.toml.read import parse
from explicit_motion import moved

RIGID = (ROOT / "examples" / "spatial_crank_slider_rigid.toml").read_text(encoding="utf-8")
FLEXIBLE = (ROOT / "examples" / "spatial_crank_slider.toml").read_text(encoding="utf-8")


def refused(text: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> list[str]:
    """The lines by which `simulate` refuses a scene, with exit code 2 and nothing written, behind `FILE:`."""
    path = folder / "scene.toml"
    path.write_text(text)
    assert main(["simulate", str(path), "--out", str(folder / "results")]) == 2
    assert [*folder.iterdir()] == [path]
    lines = capsys.readouterr().err.splitlines()
    assert all(line.startswith(f"{path}:") for line in lines), lines
    return [line.removeprefix(f"{path}:") for line in lines]


STARTS = {
    "misaligned": (
        "start = { rotation = { axis = [1, 0, 0], angle = 0.2 } }",
        "29: bodies.slider.start.rotation: ",
        "misses it by 0.2 rad; with it, x of slider.shoe would be 11.46 degrees from x of ground.guide, and the "
        "prismatic joint guide keeps them parallel",
    ),
    "reversed": (
        "start = { rotation = { axis = [0, 1, 0], angle = 3.14159265 } }\nkeep_coordinates = true",
        "47: joints.guide.between: ",
        "y of slider.shoe is 180 degrees from y of ground.guide and z of slider.shoe is 180 degrees from z of "
        "ground.guide, which should be parallel in pairs",
    ),
}


@pytest.mark.parametrize("case", STARTS)
def test_starts_that_miss_joints_name_the_axes(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Values that the joints do not contradict, such as the angle of the crank, are not blamed."""
    start, where, message = STARTS[case]
    text = RIGID.replace("start = { guess = true, position = [0.2, 0, 0] }", start)
    (line,) = refused(text, tmp_path, capsys)
    assert line.startswith(where) and message in line


def test_a_loop_that_cannot_be_closed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    absolute = RIGID.replace("gravity =", 'coordinates = "absolute"\ngravity =')
    ball, yoke = refused(absolute.replace("at = [0.3, 0, 0]", "at = [0.05, 0, 0]"), tmp_path, capsys)
    off = r"the mechanism cannot be assembled: this is off by 0\.\d+ m and \S+ degrees"
    assert re.match(rf"37: joints\.ball: {off}", ball) and re.match(rf"41: joints\.yoke: {off}", yoke)


BALL = "ball = { nodes = [0, 1, 2, 3, 4, 5, 6, 7, 8] }"
TWIST = '[torques.twist]\non = "rod.ball"\ntorque = [0, 0, 1]\n'
MOUNT = '[springs.mount]\nkind = "bushing"\nbetween = ["crank.pin", "rod.ball"]\nstiffness = [1, 1, 1, 1, 1, 1]\n'
NODES = {
    "on a line": ("ball = { nodes = [0, 1, 2] }", "", "26: bodies.rod.markers.ball.nodes: these nodes lie on a line"),
    "two": (
        "ball = { nodes = [0, 1] }",
        "",
        "26: bodies.rod.markers.ball: a set of nodes needs three, not on a line, to have a rotation; or write node = 0",
    ),
    "torque": ("ball = 4", TWIST, "54: torques.twist.on: the marker rod.ball is a node, which has no rotation"),
    "bushing": (
        "ball = 4",
        MOUNT,
        "55: springs.mount.between[1]: the marker rod.ball is a node, which has no rotation",
    ),
}


@pytest.mark.parametrize("case", NODES)
def test_nodes_without_a_rotation(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ball, more, message = NODES[case]
    nodes = (ROOT / "examples" / "spatial_rod.npz").as_posix()
    text = FLEXIBLE.replace(BALL, ball).replace("[simulation]", f"{more}[simulation]")
    (line,) = refused(text.replace('"spatial_rod.npz"', f'"{nodes}"'), tmp_path, capsys)
    assert line.startswith(message)


FRAMES = {
    "left-handed": ("{ x = [1, 0, 0], y = [0, 1, 0], z = [0, 0, -1] }", "these axes are left-handed"),
    "no length": ("[0, 0, 0, 0]", "this quaternion has the length 0"),
    "one axis": ("{ x = [1, 0, 0] }", "two axes of the frame are needed"),
}


@pytest.mark.parametrize("case", FRAMES)
def test_frames_that_are_none(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rotation, message = FRAMES[case]
    text = RIGID.replace("{ z = [-1, 0, 0], x = [0, 1, 0] }", rotation, 1)
    (line,) = refused(text, tmp_path, capsys)
    assert line.startswith("9: ground.markers.bearing.rotation: ") and message in line


DRIVEN = """
name = "driven"
[ground.markers]
o = [0, 0, 0]
[bodies.wheel]
mass = 1
inertia = [1, 1, 1, 0, 0, 0]
markers = { hub = [0, 0, 0], rim = [0.1, 0, 0] }
keep_coordinates = true
[joints.hinge]
kind = "revolute"
between = ["ground.o", "wheel.hub"]
[drives.motor]
joint = "hinge"
motion = "3 + t"
[outputs.rim]
kind = "position"
marker = "wheel.rim"
[simulation]
duration = 0.1
output = 0.1
"""


def test_a_drive_begins_where_it_says() -> None:
    """Not half a turn away, where its constraint, the sine of the difference, vanishes as well."""
    trajectory = moved(parse(DRIVEN))
    assert trajectory["rim_1"] == pytest.approx([-0.0989992496600, -0.0999135150273], abs=1e-12)


def test_a_first_guess_that_is_reversed_is_turned_to_the_attitude_that_is_meant() -> None:
    start = "start = { guess = true, rotation = { axis = [0, 1, 0], angle = 3 } }\nkeep_coordinates = true"
    text = RIGID.replace("start = { guess = true, position = [0.2, 0, 0] }", start)
    trajectory = moved(parse(text), duration=1e-3, output=1e-3)
    assert abs(trajectory["slider_e0"][0]) == pytest.approx(1.0, abs=1e-9)


TURNED = """name = "arm"
[ground.markers]
hub = [0, 0, 0]
[bodies.arm]
mass = 1
inertia = [1, 1, 1, 0, 0, 0]
markers = { hub = [0, 0, 0] }
[bodies.ball]
mass = 1
inertia = [1, 1, 1, 0, 0, 0]
[joints.hub]
kind = "revolute"
between = ["ground.hub", "arm.hub"]
[drives.motor]
joint = "hub"
speed = 3
start = { angle = 0.6 }
[simulation]
duration = 0.1
output = 0.1
"""


def test_a_start_that_a_drive_contradicts_names_the_drive(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (line,) = refused(TURNED, tmp_path, capsys)
    assert "the nearest state misses it by 0.6 rad; drive motor prescribes 0 rad at t = 0; its key offset adds" in line
    scene = tmp_path / "met.toml"
    scene.write_text(TURNED.replace("speed = 3", "speed = 3\noffset = 0.6"))
    assert main(["simulate", str(scene), "--out", str(tmp_path / "results")]) == 0
