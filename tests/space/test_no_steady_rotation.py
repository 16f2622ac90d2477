"""Scenes in space without a steady rotation: messages on motions, and a loop that is at rest."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from steady_mechanisms import INCLINED, angular, pendulum, top
from test_space_motions import KEPT

from derive.simulation.linear.modes import Modes, modes
from derive.simulation.linear.steady_motion import NoSteadyMotion
from derive.spec.toml.read import parse


def refused(text: str) -> str:
    """The message about a scene."""
    with pytest.raises(NoSteadyMotion) as caught:
        modes(parse(text))
    return str(caught.value)


def test_motions_that_are_not_steady_say_why() -> None:
    across = pendulum(KEPT).replace("[0, 0, -9.81]", "[0, -9.81, 0]")
    direction = "not those of a rotation of the whole scene about the direction of gravity"
    assert re.search(rf"{direction}: motor misses it by [.\d]+ m/s or rad/s; give", refused(across))
    unsymmetric = re.sub(r"inertia = \[[^,]*,", "inertia = [0.3,", top(1.0, INCLINED))
    assert re.search(r"top.start.angular_velocity misses it by [.\d]+ rad/s;", refused(unsymmetric))
    wire = '[springs.wire]\nbetween = ["ground.base", "arm.tip"]\nstiffness = 5\nrest = 0.1\n'
    tied = pendulum().replace("markers.top", "markers.tip = [0, 0, -1]\nmarkers.top") + wire
    assert modes(parse(tied)).steady is not None  # the other end of the wire is on the axis
    beside = tied.replace("base =", "wall = [2, 0, 0]\nbase =").replace('"ground.base", "arm', '"ground.wall", "arm')
    assert "is not the same in axes that rotate with the scene" in refused(beside)
    slow = pendulum().replace("speed = 6", "speed = 2").replace("angle = -0.8", "angle = -1.3")
    assert "far from the initial state: a rotation along arm_phidot by 1.3 rad" in refused(slow)  # it hangs


FORK = """
name = "fork"
[scene]
gravity = [0, 0, -9.81]
start = "steady"
[ground.markers]
head = { at = [0, 0, 0.6], rotation = { axis = [0, 1, 0], angle = -0.4 } }
[bodies.crown]
mass = 1.2
inertia = [0.004, 0.002, 0.004, 0, 0, 0]
[bodies.crown.markers]
steer = [0, 0, 0]
ENDS
[bodies.left]
LEG
[bodies.right]
LEG
[bodies.axle]
mass = 0.4
inertia = [4e-4, 1e-4, 4e-4, 0, 0, 0]
[bodies.axle.markers]
ENDS
[joints.head]
kind = "revolute"
between = ["ground.head", "crown.steer"]
start = { angle = 0.05, guess = true }
JOINTS
[springs.steering]
kind = "rotational"
between = ["ground.head", "crown.steer"]
stiffness = 40
""".replace(
    "LEG",
    """mass = 0.8
inertia = [1e-4, 0.01, 0.01, 0, 0, 0]
markers = { top = [-0.2, 0, 0], bottom = [0.2, 0, 0] }""",
).replace(
    "ENDS",
    """left = { at = [0, 0.06, 0], rotation = { x = [0, 0, -1], y = [0, 1, 0] } }
right = { at = [0, -0.06, 0], rotation = { x = [0, 0, -1], y = [0, 1, 0] } }""",
)


def test_a_loop_of_rigid_bodies_whose_rows_are_rounding_errors_balances_in_its_spring() -> None:
    """Multipliers along rows of 1e-17 would balance any force, so that the fork would rest where it is guessed."""
    pairs = {"lt": "crown.left left.top", "rt": "crown.right right.top", "lb": "left.bottom axle.left"}
    pairs["rb"] = "right.bottom axle.right"

    def fork(names: str) -> Modes:
        tables = (f'[joints.{n}]\nkind = "fixed"\nbetween = {json.dumps(pairs[n].split())}\n' for n in names.split())
        return modes(parse(FORK.replace("JOINTS", "".join(tables))))

    closed, open_loop = fork("lt rt lb rb"), fork("lt rt lb")
    assert np.abs(closed.linear.q).max() < 1e-9  # the centre of mass is below the axis of the head
    assert angular(closed) == pytest.approx(angular(open_loop), rel=1e-9)
