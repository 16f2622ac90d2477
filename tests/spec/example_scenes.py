"""A scene with every key there is, and ways to change it."""

from __future__ import annotations

import pytest

from derive.errors import SpecError
from derive.spec.toml.read import parse

EVERYTHING = """\
name = "all"

[scene]
gravity = [0, { symbol = "g", default = -9.81 }]

[ground.markers]
bearing = [0, 0]
wall = [{ symbol = "w", default = -2 }, "1/3"]

[bodies.crank]
mass = 2
inertia = { symbol = "I", default = 0.25 }
centre = [0.1, { symbol = "e", unit = "mm", default = 0 }]
markers = { hub = [0, 0], pin = [0.15, -0.5] }
start = { position = [1, "1/2"], angle = 0.3, velocity = [0, -1.5], spin = 3 }

[bodies.rod]
ansatz = ["xi^2", "xi^3", "xi^4"]
frame = "chord"
orthogonal = true
mass = { symbol = "m", unit = "g", default = 66 }
length = 0.3
bending_stiffness = 12.5
pieces = 2
markers = { left = -1, right = 1 }
start = { angle = -0.5 }

[bodies.slider]
mass = 0.5
inertia = 1e-6
markers = { pin = [0, 0] }

[bodies.plate]
markers = { a = [0, 0] }

[joints.bearing]
kind = "revolute"
between = ["ground.bearing", "crank.hub"]

[joints.pin]
kind = "revolute"
between = ["crank.pin", "rod.left"]

[joints.clamp]
kind = "weld"
between = ["rod.right", "slider.pin"]
angle = 0.1

[joints.guide]
kind = "translational"
between = ["ground.wall", "slider.pin"]
angle = 0.2
axis = [3, "-1/2"]

[joints.glue]
kind = "fixed"
between = ["slider.pin", "plate.a"]

[drives.motor]
joint = "bearing"
speed = { symbol = "Omega", default = -150 }
offset = 0.5

[drives.push]
joint = "guide"
motion = "0.1*t^2"

[forces.load]
at = "rod.right"
components = ["-10*sin(2*t)", 0.5]

[torques.brake]
at = "crank.hub"
value = -1.5
against = "rod.left"

[torques.wind]
at = "plate.a"
value = "t/2"

[springs.mount]
between = ["ground.wall", "slider.pin"]
stiffness = { symbol = "k", default = 0 }
damping = 0.5
rest = 0.25

[springs.coil]
kind = "rotational"
between = ["ground.bearing", "crank.hub"]
stiffness = 3
rest = { symbol = "rest", default = -1 }

[simulation]
duration = 2
output = 0.01
tolerance = 1e-6

[plots.bend]
deflection = "rod.right"
chord = ["rod.left", "slider.pin"]
divided_by = 0.3

[plots.cuts]
deflection = "rod.left"
chord = ["crank.pin", "rod.right"]
divided_by = 1
over = "push"
cut = "rod"
pieces = [1, 4]
"""

SMALL = """\
name = "s"
[ground.markers]
o = [0, 0]
[bodies.bar]
mass = 1
inertia = 1
markers = { a = [0, 0], b = [1, 0] }
[bodies.rod]
length = 1
markers = { left = -1, right = 1 }
[joints.pin]
kind = "revolute"
between = ["ground.o", "bar.a"]
"""
"""13 lines, after which a test writes its own."""


def small(*replaced: tuple[str, str], more: str = "") -> str:
    """The small scene with some of its lines changed, and others after them."""
    text = SMALL
    for old, new in replaced:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text + more


def errors(text: str, source: str = "s.toml") -> list[str]:
    """The messages on a faulty text, a line each, without the file."""
    with pytest.raises(SpecError) as caught:
        parse(text, source)
    return [line.removeprefix("s.toml:") for line in str(caught.value).split("\n")]
