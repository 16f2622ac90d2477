"""What the initial states of a sweep depend on: they are shared only where they are the same to the bit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sweep_scenes import slider

from derive.runtime.loading import load_scene
from derive.simulation.initial.initial_guess import initial_guess
from derive.simulation.initial.initial_state import initial_state, scene_size
from derive.simulation.scene_run import SceneRun
from derive.spec.model.scene import EQUILIBRIUM, Scene
from derive.spec.model.scene_functions import breaks
from derive.spec.set_values import with_values
from derive.spec.toml.read import parse
from derive.study.sweep.dependence import initial_parameters, with_defaults

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


def with_start(text: str) -> Scene:
    scene = parse(text)
    assert isinstance(scene, Scene)
    return scene


@pytest.mark.parametrize(
    ("scene", "expected"),
    [
        (slider(), {"x0", "radius", "m", "speed", "F"}),
        (with_start(PENDULUM), {"height", "wall", "m", "I", "e", "arm", "jump"}),
    ],
    ids=["slider", "pendulum"],
)
def test_parameters_that_are_left_out_change_nothing(scene: Scene, expected: set[str]) -> None:
    run = SceneRun(scene, "adaptive", None, {})
    native = load_scene(run.files)
    initial = initial_parameters(run.scene, run.complete_model)
    assert initial == expected
    at_rest = replace(run.scene, start=EQUILIBRIUM)  # which depends on all forces
    assert initial_parameters(at_rest, run.complete_model) == {p.name for p in run.model.parameters}
    base = initial_state(scene, native)
    for parameter in run.model.parameters:
        assert parameter.default is not None
        value = 1.1 * parameter.default + 0.01
        changed = with_defaults(scene, {parameter.name: value})
        assert changed == with_values(scene, {parameter.name: repr(value)})[0]
        if parameter.name not in initial:
            state = initial_state(changed, native, native.setup({parameter.name: value}))
            assert np.array_equal(state.q, base.q) and np.array_equal(state.v, base.v), parameter.name
            assert scene_size(changed) == scene_size(scene) and breaks(changed) == breaks(scene), parameter.name


def test_the_first_guess_follows_the_parameters() -> None:
    """The displacement of the slider counts from the bearing, to which its guide leads."""
    native = load_scene(SceneRun(slider(), "adaptive", None, {}).files)
    number = native.coordinates.index("slider_s")
    assert initial_guess(slider(), native)[0][number] == pytest.approx(0.45)
    assert initial_guess(slider(), native, native.setup(x0=0.1))[0][number] == pytest.approx(0.35)
