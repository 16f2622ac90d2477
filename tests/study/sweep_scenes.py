"""A crank-slider with one beam, whose numbers are parameters, and tasks of workers that kill themselves."""

from __future__ import annotations

import os
import signal
from pathlib import Path

from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse
from derive.study.sweep.worker import Chunk, Outcome, run_chunk

SLIDER = """
name = "slider"

[scene]
gravity = [0, { symbol = "g", default = -9.81 }]

[parameters]
F = { default = -2, unit = "N" }

[ground.markers]
bearing = [{ symbol = "x0", default = 0 }, 0]

[bodies.crank]
markers = { hub = [0, 0], pin = [{ symbol = "radius", default = 0.15 }, 0] }

[bodies.rod]
ansatz = ["1", "xi", "xi^2"]
frame = "chord"
mass = { symbol = "m", default = 0.07 }
length = 0.3
bending_stiffness = { symbol = "EI", default = 12 }
markers = { left = -1, middle = 0, right = 1 }
start = { position = [0.3, 0], guess = true }

[bodies.slider]
mass = 0.03
inertia = 1e-6
markers = { pin = [0, 0] }
start = { position = [0.45, 0], guess = true }

[joints.crank_bearing]
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
joint = "crank_bearing"
speed = { symbol = "speed", default = 150 }

[forces.load]
at = "slider.pin"
components = ["F", 0]

[simulation]
duration = 0.01
output = 1e-4
tolerance = 1e-6

[plots.deflection]
deflection = "rod.middle"
chord = ["rod.left", "rod.right"]
divided_by = 0.3
over = "motor"
"""


PENDULUM = """
name = "pendulum"

[scene]
gravity = [{ symbol = "gx", default = 0.7 }, -9.81]

[parameters]
jump = { default = 0.05, unit = "s" }

[ground.markers]
pivot = [0, { symbol = "height", default = 1.5 }]
wall = [{ symbol = "wall", default = -2 }, 0]

[bodies.bob]
mass = { symbol = "m", default = 1.7 }
inertia = { symbol = "I", default = 0.31 }
centre = [0.2, { symbol = "e", default = -0.15 }]
markers = { top = [0, { symbol = "arm", default = 0.5 }], side = [0.1, 0] }
start = { spin = 2 }

[joints.hinge]
kind = "revolute"
between = ["ground.pivot", "bob.top"]

[springs.rope]
between = ["ground.wall", "bob.side"]
stiffness = { symbol = "c", default = 40 }
damping = { symbol = "d", default = 0.3 }
rest = { symbol = "rest", default = 1.2 }

[torques.push]
at = "bob.top"
value = "step(t, jump, jump + 0.1)"

[simulation]
duration = 0.2
output = 0.01
"""


def slider() -> Scene:
    """The crank-slider."""
    return _scene(SLIDER)


def pendulum() -> Scene:
    """A rigid pendulum with a spring, and with a torque that begins at a time which is a parameter."""
    return _scene(PENDULUM)


def _scene(text: str) -> Scene:
    scene = parse(text)
    assert isinstance(scene, Scene)
    return scene


FLAG = "SWEEP_TEST_FLAG"
"""The environment variable with the path of a file that says what has happened in other processes."""


def kill_once(chunk: Chunk, losses: int = 0) -> tuple[Outcome, ...]:
    """Kill this process instead of running the chunk, the first time that it is called anywhere."""
    try:
        Path(os.environ[FLAG]).touch(exist_ok=False)
    except FileExistsError:
        return run_chunk(chunk)
    os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError


def kill_at_seven(chunk: Chunk, losses: int = 0) -> tuple[Outcome, ...]:
    """Kill this process whenever sample 7 is among those of the chunk."""
    if any(sample.number == 7 for sample in chunk.samples):
        os.kill(os.getpid(), signal.SIGKILL)
    return run_chunk(chunk)


def kill_each_third_once(chunk: Chunk, losses: int = 0) -> tuple[Outcome, ...]:
    """Kill this process instead of running samples 0, 3, 6, ..., the first time that each is called anywhere."""
    number = chunk.samples[0].number
    if number % 3 == 0:
        try:
            (Path(os.environ[FLAG]) / str(number)).touch(exist_ok=False)
        except FileExistsError:
            return run_chunk(chunk)
        os.kill(os.getpid(), signal.SIGKILL)
    return run_chunk(chunk)
