"""Scenes in space that start in a steady rotation: a top, and a pendulum on a driven shaft."""

from __future__ import annotations

import numpy as np
from test_space_motions import KEPT, MGL, top_scene
from tops import SymmetricTop

from derive.simulation.linear.modes import Modes

MOMENTS, INCLINED, FAST = (0.5, 0.2), 0.7, 30.0
"""Moments of inertia across and along, kg m^2; the inclination; the angular velocity along the axis, rad/s."""

PENDULUM = """
name = "governor"
[scene]
gravity = [0, 0, -9.81]
start = "steady"
[ground.markers]
base = [0, 0, 0]
[bodies.shaft]
mass = 1
inertia = [0.1, 0.1, 0.1, 0, 0, 0]
markers.foot = [0, 0, 0]
markers.hinge = { at = [0, 0, 1], rotation = { x = [1, 0, 0], z = [0, 1, 0] } }
KEEP
[bodies.arm]
mass = 2
centre = [0, 0, -0.5]
inertia = [0.05, 0.06, 0.01, 0, 0, 0]
markers.top = { at = [0, 0, 0], rotation = { x = [1, 0, 0], z = [0, 1, 0] } }
start = { guess = true, position = [0, 0, 1], rotation = { axis = [0, 1, 0], angle = -0.8 } }
[joints.bearing]
kind = "revolute"
between = ["ground.base", "shaft.foot"]
[joints.hinge]
kind = "revolute"
between = ["shaft.hinge", "arm.top"]
[drives.motor]
joint = "bearing"
speed = 6
"""


def top(precession: float, theta: float) -> str:
    """A top with these rates of precession and of its own rotation, at a first guess of its inclination."""
    spin = FAST - precession * np.cos(INCLINED)
    return steady(top_scene(SymmetricTop(*MOMENTS, MGL, theta, phidot=precession, psidot=spin), 1.0, KEPT))


def pendulum(keep: str = "") -> str:
    """A pendulum on a shaft; keep: the key that keeps the coordinates of the shaft."""
    return PENDULUM.replace("KEEP", keep)


def steady(text: str) -> str:
    """A scene that starts in a steady rotation."""
    return text.replace("[scene]", '[scene]\nstart = "steady"')


def angular(result: Modes) -> np.ndarray:
    """The angular frequencies of the modes that oscillate, rad/s, ascending."""
    found = 2 * np.pi * result.frequencies
    return np.sort(found[found > 0])
