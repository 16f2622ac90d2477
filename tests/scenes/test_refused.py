"""Scenes that the derivation refuses, and starts that need the derivation to be understood."""

from __future__ import annotations

import numpy as np
import pytest
from made import make

import derive
from derive.errors import SpecError
from derive.simulation.errors import IntegrationStopped
from derive.simulation.initial.initial_state import initial_state
from derive.simulation.integration.scipy_methods import integrate
from derive.spec.toml.read import parse

PENDULUM = """
name = "pendulum"
[ground.markers]
a = [0, 0]
[bodies.bar]
mass = 1
inertia = 0.1
centre = [0.5, 0]
markers = { pin = [0, 0], tip = [1, 0] }
[joints.pin]
kind = "revolute"
between = ["ground.a", "bar.pin"]
"""


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (
            '[forces.bar_tip_s]\nat = "bar.tip"\ncomponents = ["sin(t)", 1]',
            "two things of this scene would be called bar_tip_s_1 in the code",
        ),
        ('[torques.push]\nat = "bar.tip"\nvalue = "1/(t - t)"', "torques.push.value: this is zoo for every t"),
        ('[drives.motor]\njoint = "pin"\nmotion = "sqrt(0*t - 1)*t"', "drives.motor.motion: this is I"),
        ('[drives.motor]\njoint = "pin"\nspeed = 2', "all motion is prescribed; nothing is left to be computed"),
    ],
)
def test_scenes_that_make_no_equations(more: str, said: str) -> None:
    with pytest.raises(SpecError) as error:
        derive.derive(parse(PENDULUM + more)).expanded()
    assert said in str(error.value)


def test_a_slider_on_a_guide_of_a_fixed_body_starts_where_it_was_put() -> None:
    scene = parse(
        """
name = "guided"
[ground.markers]
a = [1, 0]
[bodies.base]
markers = { foot = [0, 0], g = [3, 0] }
[bodies.ring]
mass = 1
inertia = 0.1
markers = { p = [0.25, 0] }
start = { position = [5, 0], velocity = [0.5, 0] }
[joints.weld]
kind = "weld"
between = ["ground.a", "base.foot"]
[joints.guide]
kind = "translational"
between = ["base.g", "ring.p"]
"""
    )
    made = make(scene)
    k = made.native.setup()
    start = initial_state(scene, made.native, k)
    place = made.native.bodies.index("ring")
    assert made.native.poses(0.0, start.q, k)[place] == pytest.approx([5.0, 0.0, 0.0])
    assert start.v == pytest.approx([0.5])


def test_an_integration_that_gets_nowhere_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    made = make(parse(PENDULUM.replace("mass = 1", "mass = 1\nstart = { spin = 30 }")))
    k, start = made.start()
    monkeypatch.setattr("derive.simulation.integration.scipy_methods.MAX_STEPS_PER_ROW", 2)
    with pytest.raises(IntegrationStopped, match="5 steps do not reach the next row"):
        integrate(made.native, k, start.q, start.v, np.array([0.0, 10.0]), max_step=0.1)
