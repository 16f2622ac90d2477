"""Gradients of poses: a few differences for all bodies at once, and assemblies of many bodies that need few of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import derive
from derive.runtime.interpreted_scene import InterpretedScene
from derive.simulation.initial.assembler import Assembler
from derive.simulation.initial.initial_state import initial_state, scene_size
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse

HANGING = """\
name = "hanging"
[scene]
gravity = [0, -9.81]
[ground.markers]
a = [0, 0]
b = [0.9, 0]
[bodies.link]
count = 10
mass = 0.1
inertia = 1e-4
markers = { left = [-0.05, 0], right = [0.05, 0] }
start = { position = ["0.09*(i + 0.5)", "-0.1 + 0.005*(i - 4.5)^2"], angle = "0.1*(i - 4.5)", guess = true }
[joints.first]
kind = "revolute"
between = ["ground.a", "link[0].left"]
[joints.pin]
count = 9
kind = "revolute"
between = ["link[i].right", "link[i+1].left"]
[joints.last]
kind = "revolute"
between = ["link[9].right", "ground.b"]
"""


class Counted(InterpretedScene):
    """An interpreted scene that counts how often it computes poses."""

    count = 0

    def poses(self, t, q, k):
        """The poses of all bodies."""
        self.count += 1
        return super().poses(t, q, k)


def hanging() -> tuple[Scene, Counted]:
    scene = parse(HANGING)
    return scene, Counted(derive.lower(derive.derive(scene)))


def test_gradients_of_all_bodies_take_six_evaluations() -> None:
    scene, native = hanging()
    assembler = Assembler(native, native.setup(), 0.0, scene_size(scene))
    q = 0.1 * np.arange(native.nq)
    one_by_one = replace(assembler.kinematics(q), groups=()).gradients
    native.count = 0
    gradients = assembler.kinematics(q).gradients
    assert native.count == 7, "the poses, and two for each coordinate of a body"
    assert np.count_nonzero(gradients) > native.nq
    np.testing.assert_array_equal(gradients, one_by_one)


def test_a_chain_is_assembled_with_few_evaluations() -> None:
    scene, native = hanging()
    state = initial_state(scene, native)
    assert max(abs(native.constraints(0.0, state.q, native.setup()))) < 1e-12
    assert native.count < 500, "one by one, and with differences of the steps of the fit, there are 4000"
