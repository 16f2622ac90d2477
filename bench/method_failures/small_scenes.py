"""Small scenes in which a failure of methods can be seen by itself: a rigid crank-slider, and a free beam."""

from __future__ import annotations

from enum import Enum

from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse

SOURCE = "a scene of this study"
ANGLE, SPEED = 0.5, 1.0
"""The crank angle at the start, rad, and the speed of the drive, rad/s or m/s."""


class Driven(Enum):
    """The body of a crank-slider that is driven."""

    CRANK = "crank"
    SLIDER = "slider"


CRANK_SLIDER = """
name = "{name}"
[ground.markers]
bearing = [0, 0]
[bodies.crank]
mass = 1
inertia = 0.1
centre = [0.5, 0]
markers = {{ hub = [0, 0], pin = [1, 0] }}
start = {{ angle = 0.5 }}
[bodies.rod]
mass = 1
inertia = 0.3
markers = {{ left = [{left}, 0], right = [{right}, 0] }}
start = {{ angle = {tilt}, guess = true }}
[bodies.slider]
mass = 1
inertia = 0.1
markers = {{ pin = [0, 0] }}
start = {{ position = [{position}, 0], guess = true }}
[joints.bearing]
kind = "revolute"
between = ["ground.bearing", "crank.hub"]
[joints.crank_pin]
kind = "revolute"
between = ["crank.pin", "rod.left"]
[joints.slider_pin]
kind = "revolute"
between = ["rod.right", "slider.pin"]
[joints.guide]
kind = "translational"
between = ["ground.bearing", "slider.pin"]
axis = [1, 0]
[drives.motor]
joint = "{joint}"
motion = "{motion}"
[simulation]
duration = 6
output = 0.01
"""
"""The specification of a crank of length 1 m, a rod and a slider without offset, all of them rigid."""


def crank_slider(rod: float = 2.0, driven: Driven = Driven.CRANK) -> Scene:
    """A rigid crank-slider whose crank is 1 m and whose rod is `rod` m long; it starts at a crank angle of 0.5 rad.

    A driven slider moves inwards at 1 m/s.
    """
    from math import asin, cos, sin

    tilt = -asin(sin(ANGLE) / rod)
    position = cos(ANGLE) + rod * cos(tilt)
    crank = driven is Driven.CRANK
    text = CRANK_SLIDER.format(
        name=f"rigid_{driven.value}",
        left=-rod / 2,
        right=rod / 2,
        tilt=tilt,
        position=position,
        joint="bearing" if crank else "guide",
        motion=f"{ANGLE} + t" if crank else f"{position!r} - t",
    )
    scene = parse(text, SOURCE)
    assert isinstance(scene, Scene)
    return scene


BENT_BEAM = """
name = "bent_beam"
[bodies.beam]
ansatz = ["1", "xi", "xi^2"]
frame = "mean"
mass = 1
length = 1
bending_stiffness = 1
start = { spin = 0.5, deflection = "29/100*xi^2" }
[simulation]
duration = 1
output = 0.01
"""


def bent_beam() -> Scene:
    """A free beam of one shape with m = l = EI = 1 that is bent by a fifth of its length, is let go, and spins."""
    scene = parse(BENT_BEAM, SOURCE)
    assert isinstance(scene, Scene)
    return scene
