"""Initial values that contradict each other: the message names the joints, drives and values, and by how much."""

from __future__ import annotations

import pytest

from derive.errors import TisserandError
from derive.generated_models import generated_explicit
from derive.runtime.compiler import UNOPTIMISED
from derive.runtime.loading import load_scene
from derive.simulation.initial.initial_state import initial_state
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse

SLIDER = """
name = "contradicting_slider"
ground.markers = { o = [0, 0] }
[bodies.crank]
mass = 0.1
inertia = 1e-4
markers = { hub = [0, 0], pin = [0.15, 0] }
[bodies.rod]
mass = 0.07
inertia = 1e-4
markers = { left = [-0.15, 0], right = [0.15, 0] }
[bodies.slider]
mass = 0.03
inertia = 1e-6
markers = { pin = [0, 0] }
[joints.bearing]
kind = "revolute"
between = ["ground.o", "crank.hub"]
[joints.crank_pin]
kind = "revolute"
between = ["crank.pin", "rod.left"]
[joints.slider_pin]
kind = "revolute"
between = ["rod.right", "slider.pin"]
[joints.guide]
kind = "translational"
between = ["ground.o", "slider.pin"]
axis = [1, 0]
"""
LOOP = "the joints bearing (off by {0}), crank_pin (off by {0}) and slider_pin (off by {0})"
MOTOR = "[drives.motor]\njoint = 'bearing'\nspeed = 10\n"
PISTON = "[drives.piston]\njoint = 'guide'\nmotion = '0.2 + t'\n"


def refusal(more: str, text: str = SLIDER + "{more}") -> str:
    scene = parse(text.replace("{more}", more))
    assert isinstance(scene, Scene)
    with pytest.raises(TisserandError) as error:
        initial_state(scene, load_scene(generated_explicit(scene)[1], UNOPTIMISED))
    return str(error.value)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (
            "[bodies.rod.start]\nposition = [0.7, 0]",
            "bodies.rod.start.position: component 1: 0.7 m contradicts the joints bearing (off by 0.4 m) and crank_pin "
            "(off by 0.4 m); the nearest positions have 0.3 m. Correct or leave out one of them, or write guess = true "
            "in [bodies.rod.start]",
        ),
        (  # out of reach for any angle of the crank
            "[bodies.slider.start]\nposition = [0.5, 0]\n[bodies.crank.start]\nangle = 0",
            f"0.5 m contradicts {LOOP.format('0.05 m')}; the nearest positions have 0.45 m",
        ),
        (
            "[bodies.slider.start]\nposition = [0.4, 0]\n[bodies.crank.start]\nangle = 0",
            f"bodies.crank.start.angle: 0 rad contradicts {LOOP.format('0.05 m')}, and bodies.slider.start.position.",
        ),
        (
            "[bodies.slider.start]\nposition = [0.45, 0.1]",
            "component 2: 0.1 m contradicts the joints bearing (off by 0.00366 m), crank_pin (off by 0.00366 m), "
            "slider_pin (off by 0.00366 m) and guide (off by 0.1 m); the nearest",
        ),
        (f"{MOTOR}[bodies.crank.start]\nangle = 0.5", "angle: 0.5 rad contradicts the drive motor (off by 0.5 rad)"),
        (
            "[joints.bearing.start]\nangle = 0\nspeed = 3\n[joints.guide.start]\nspeed = 1",
            f"joints.guide.start.speed: 1 m/s contradicts {LOOP.format('1 m/s')}; the nearest velocities have 0 m/s",
        ),
        (
            f"{MOTOR}[bodies.crank.start]\nspin = 8",
            "bodies.crank.start.spin: 8 rad/s contradicts the drive motor (off by 2 rad/s)",
        ),
        (
            MOTOR + PISTON + "[bodies.weight]\nmass = 1\ninertia = 1\n",
            "What cannot be met together, with what each misses if the others are met: the joints bearing (off by ",
        ),
    ],
    ids=["chain", "reach", "two values", "guide", "drive", "speed of a guide", "speed of a drive", "two drives"],
)
def test_what_is_in_conflict_is_named(more: str, message: str) -> None:
    text = refusal(more)
    assert message in text, text
    assert (
        "What cannot" not in message or "and the drives motor (off by 2.0" in text and "piston (off by 0.25 m)." in text
    )


@pytest.mark.long
def test_a_beam_in_pieces_that_bends_is_a_body_like_others() -> None:
    rod = "[bodies.rod]\nmass = 0.07\ninertia = 1e-4\nmarkers = { left = [-0.15, 0], right = [0.15, 0] }\n"
    beam = "[bodies.rod]\nmass = 0.07\nlength = 0.3\nbending_stiffness = 10\npieces = 2\n"
    beam += "markers = { left = -1, right = 1 }\n"
    start = 'start = { position = [0.7, 0.1], deflection = "0.002*xi^2" }\n'
    assert rod in SLIDER
    message = refusal(start, SLIDER.replace(rod, beam + "{more}"))
    assert (
        "component 1: 0.7 m contradicts the joints bearing (off by 0.475 m) and crank_pin (off by 0.475 m)" in message
    )
