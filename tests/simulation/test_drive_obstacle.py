"""A linkage that a drive cannot turn through is noted before the run, and no other."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

import derive
from derive.cli.main import main
from derive.runtime.interpreted_scene import InterpretedScene
from derive.simulation.drive_obstacle import DriveObstacle, drive_obstacle
from derive.simulation.initial.initial_state import initial_state, scene_size
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse


def bar(name: str, length: float) -> str:
    half = length / 2
    markers = f"markers = {{ left = [{-half}, 0], right = [{half}, 0] }}"
    return f"[bodies.{name}]\nmass = 0.1\ninertia = 1e-4\n{markers}\n"


def pin(name: str, first: str, second: str, more: str = "") -> str:
    return f'[joints.{name}]\nkind = "revolute"\nbetween = ["{first}", "{second}"]\n{more}'


def slider_crank(crank: float, rod: str, offset: float, at: float) -> str:
    slider = "[bodies.slider]\nmass = 0.1\ninertia = 1e-6\nmarkers.pin = [0, 0]\n"
    slider += f"start = {{ position = [{at}, {offset}]"
    text = f'name = "locking"\nground.markers = {{ o = [0, 0], g = [0, {offset}] }}\n{bar("crank", crank)}{rod}'
    text += slider + ", guess = true }\n" + pin("bearing", "ground.o", "crank.left")
    text += pin("crank_pin", "crank.right", "rod.left") + pin("slider_pin", "rod.right", "slider.pin")
    text += '[joints.guide]\nkind = "translational"\nbetween = ["ground.g", "slider.pin"]\naxis = [1, 0]\n'
    return text + "[simulation]\nduration = 1\noutput = 0.1\n"


def four_bar(crank: float, coupler: float, rocker: float, base: float, more: str = "") -> str:
    text = f'name = "locking"\nground.markers = {{ o = [0, 0], g = [{base}, 0] }}\n{bar("crank", crank)}'
    text += bar("coupler", coupler) + bar("rocker", rocker) + more + pin("bearing", "ground.o", "crank.left")
    text += pin("knee", "crank.right", "coupler.left") + pin("pivot", "ground.g", "rocker.left")
    text += pin("top", "coupler.right", "rocker.right" if not more else "dyad.left")
    text += pin("elbow", "dyad.right", "rocker.right") if more else ""
    return text + "[simulation]\nduration = 1\noutput = 0.1\n"


def drive(joint: str, motion: str) -> str:
    return f'[drives.motor]\njoint = "{joint}"\n{motion}\n'


def obstacle(text: str) -> DriveObstacle | None:
    scene = parse(text)
    assert isinstance(scene, Scene)
    native = InterpretedScene(derive.lower(derive.derive(scene)))
    k = native.setup()
    return drive_obstacle(scene, native, k, initial_state(scene, native, k).q, scene_size(scene))


STUBBY = slider_crank(0.15, bar("rod", 0.12), 0.05, 0.27)
SLIDER = slider_crank(0.15, bar("rod", 0.3), 0.0, 0.4)
DYAD = bar("dyad", 0.3) + "start = { angle = -1, guess = true }\n"
LOCKED = math.pi + math.asin(0.07 / 0.15)
"""rad: where the rod of 0.12 m is normal to the guide, 0.05 m above the bearing of the crank of 0.15 m."""


@pytest.mark.parametrize(
    ("text", "value", "t"),
    [
        (STUBBY + drive("bearing", "speed = 6"), LOCKED, LOCKED / 6),
        (STUBBY + drive("bearing", "speed = -6"), -math.asin(0.07 / 0.15), math.asin(0.07 / 0.15) / 6),
        (STUBBY + drive("bearing", "speed = 6000"), LOCKED, LOCKED / 6000),
        (STUBBY + drive("bearing", "motion = '0.4*sin(2*t) + 3.5*step(t, 0.6, 1)'"), LOCKED, None),
        (  # coupler and rocker in one line
            four_bar(0.2, 0.15, 0.1, 0.3) + drive("bearing", "speed = 6\nstart = { angle = 0.6, guess = true }"),
            math.acos(0.5625),
            math.acos(0.5625) / 6,
        ),
        (SLIDER + drive("guide", "motion = '0.4 + 0.1*t'"), 0.45, 0.5),
    ],
    ids=["slider-crank", "backwards", "fast", "back and forth", "four-bar", "slider"],
)
def test_a_linkage_that_cannot_turn_through(text: str, value: float, t: float | None) -> None:
    found = obstacle(text)
    assert found is not None and [name for name, _, _ in found.drives] == ["motor"] and found.joints
    assert found.drives[0][1] == pytest.approx(value, abs=2e-3) and (t is None or found.t == pytest.approx(t, rel=5e-3))
    assert f"beyond motor = {found.drives[0][1]:.5g} " in str(found) and "rigid beams" not in str(found)


@pytest.mark.parametrize(
    "text",
    [
        slider_crank(0.15, bar("rod", 0.3), 0.05, 0.4) + drive("bearing", "speed = 600"),
        slider_crank(0.15, bar("rod", 0.15), 0.0, 0.3) + drive("bearing", "speed = 6"),  # with a double root
        four_bar(0.1, 0.3, 0.1, 0.3) + drive("bearing", "speed = 10\noffset = 1"),  # with dead centres that it passes
        four_bar(0.2, 0.15, 0.1, 0.3) + drive("bearing", "motion = '0.6 + 0.3*sin(6*t)'"),
        SLIDER + drive("guide", "motion = '0.4 + 0.04*sin(6*t)'"),
        SLIDER + drive("guide", "motion = '0.4 + 0.05*sin(6*t)'"),  # which touches the dead centre
        four_bar(0.1, 0.3, 0.2, 0.3, DYAD) + drive("bearing", "speed = 6"),  # free to move besides
    ],
    ids=["slider-crank", "double root", "parallelogram", "four-bar", "slider", "dead centre", "five-bar"],
)
def test_a_linkage_that_can_is_not_noted(text: str) -> None:
    assert obstacle(text) is None


def test_a_beam_that_its_drive_bends_is_not_noted() -> None:
    """It is clamped, and a drive moves its other end: rigid, it would not move at all."""
    text = """
    name = "bending"
    ground.markers = { o = [0, 0], g = [1, 0] }
    [bodies.rod]
    mass = 1
    length = 1
    bending_stiffness = 10
    ansatz = ["1", "xi", "xi^2", "xi^3", "xi^4"]
    markers = { left = -1, right = 1 }
    [bodies.block]
    mass = 1
    inertia = 1
    markers.pin = [0, 0]
    [bodies.slide]
    mass = 1
    inertia = 1
    markers.pin = [0, 0]
    start = { position = [1, 0], guess = true }
    [joints.clamp]
    kind = "weld"
    between = ["ground.o", "rod.left"]
    [joints.tip]
    kind = "revolute"
    between = ["rod.right", "block.pin"]
    [joints.along]
    kind = "translational"
    between = ["slide.pin", "block.pin"]
    axis = [1, 0]
    [joints.guide]
    kind = "translational"
    between = ["ground.g", "slide.pin"]
    axis = [0, 1]
    [drives.motor]
    joint = "guide"
    motion = "0.02*sin(3*t)"
    [simulation]
    duration = 1
    output = 0.1
    """
    assert obstacle(text) is None


def test_the_note_comes_before_the_run_and_stays_with_its_result(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The beam bends, so that the run does not stop there."""
    beam = "[bodies.rod]\nmass = 0.1\nlength = 0.12\nbending_stiffness = 0.05\nmarkers = { left = -1, right = 1 }\n"
    spec = tmp_path / "locking.toml"
    spec.write_text(slider_crank(0.15, beam, 0.05, 0.27) + drive("bearing", "speed = 6"))
    options = ["--duration", "0.62", "--tolerance", "1e-4", "--out", str(tmp_path)]
    assert main(["simulate", str(spec), *options]) == 0
    printed = capsys.readouterr()
    note = "note: the linkage cannot be turned through: beyond motor = 3.62"
    assert printed.err.startswith(f"locking, rod in 1 beam: {note}") and printed.err.count("\n") == 1
    assert "cannot be met with rigid beams\n" in printed.err and f"  {note}" in printed.out
    record = json.loads((tmp_path / "locking/locking.json").read_text())
    assert [text.startswith(note.removeprefix("note: ")) for text in record["notes"]].count(True) == 1
