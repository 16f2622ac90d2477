"""The initial state of generated code: threads and gears, and bodies that hang on others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import derive
from derive.simulation.initial.start_state import start_state
from derive.spec.toml.read import parse

GEARED = """
name = "geared_screw"
[bodies.rod]
mass = 0.72
inertia = [0.00066, 0.000215, 0.000749, 0, -1e-05, 0]
start = { position = [-0.059, -0.074, 0.0007], rotation = { axis = [0.05, -0.28, -0.13], angle = 0.64 }, guess = true }
[bodies.rod.markers]
m0 = { at = [0.129, 0.29, -0.06], rotation = { angles = [-0.2, 0.55, 0.32], sequence = "xyz" } }
m2 = { at = [-0.09, 0.154, 0.136], rotation = { axis = [0.67, 0.67, -0.32], angle = 2.8 } }
[bodies.nut]
mass = 0.85
inertia = [0.00131, 0.00125, 0.00192, 0, 0.0, 0]
markers = { m0 = { at = [-0.4, 0.05, -0.06], rotation = { axis = [0.3, 0, 0.1], angle = 2 } } }
[ground.markers]
m0 = [0.14, 0.175, 0.067]
[joints.clamp]
kind = "planar"
between = ["ground.m0", "rod.m0"]
[joints.root]
kind = "screw"
between = ["rod.m2", "nut.m0"]
pitch = 0.044
[gears.train]
joints = ["clamp", "root"]
ratio = "29/6"
[simulation]
duration = 0.1
output = 0.1
"""


@pytest.mark.long
def test_it_comes_back_to_the_constraints() -> None:
    """Rotations need all digits that Newton's method works with: in doubles they do not follow its last steps."""
    spec = replace(parse(GEARED), coordinates="absolute")
    model = derive.lower(derive.derive(spec))
    start = start_state(spec, model)
    assert len(start.q) == 10 and np.all(np.isfinite(start.q))


HUNG = """
name = "hung_plate"
[scene]
gravity = [0, 0, -9.81]
[ground.markers]
a = { at = [1, 0, 0], rotation = { axis = [1, 1, 0], angle = 3 } }
b = { at = [0, 1, 0], rotation = { axis = [1, 0, 0], angle = 2 } }
c = { at = [-1, -1, 0], rotation = { axis = [0, 1, 0], angle = 2 } }
[bodies.plate]
mass = 1
inertia = [0.1, 0.1, 0.2, 0, 0, 0]
markers = { a = [1, 0, 0], b = [0, 1, 0], c = [-1, -1, 0] }
start = { position = [0, 0, -0.55], guess = true }
[joints]
a = { kind = "distance", between = ["ground.a", "plate.a"], distance = 0.5 }
b = { kind = "distance", between = ["ground.b", "plate.b"], distance = 0.5 }
c = { kind = "distance", between = ["ground.c", "plate.c"], distance = 0.5 }
[simulation]
duration = 0.1
output = 0.1
"""


def test_a_body_that_hangs_on_others_is_not_turned() -> None:
    """Joints that keep a distance, or meet in a ball, say nothing on rotations: those of their markers are no guess."""
    spec = parse(HUNG)
    start = start_state(spec, derive.lower(derive.derive(spec)))
    assert np.allclose(start.q, [0, 0, -0.5, 1, 0, 0, 0], atol=1e-4)


ARM = """
name = "arm_with_rod"
[ground.markers]
hook = { at = [0.1, 0, 0.3], rotation = { axis = [0.3, 1, 0], angle = 0.7 } }
[bodies.arm]
mass = 1
inertia = [0.1, 0.1, 0.2, 0, 0, 0]
markers = { root = [0, 0, 0], tip = [0.7, 0.1, 0] }
[bodies.rod]
mass = 1
inertia = [0.1, 0.1, 0.2, 0, 0, 0]
markers = { top = [0.3, 0, 0] }
[joints.root]
kind = "revolute"
between = ["ground.hook", "arm.root"]
start = { angle = 0.2, speed = 0.1 }
[joints.ball]
kind = "spherical"
between = ["arm.tip", "rod.top"]
[simulation]
duration = 0.1
output = 0.1
"""


def test_a_given_angle_keeps_its_digits_beside_quaternions() -> None:
    """Positions that follow from it, and are rounded, give way."""
    spec = parse(ARM)
    start = start_state(spec, derive.lower(derive.derive(spec)))
    assert (start.q[0], start.v[0]) == (0.2, 0.1)
