"""Starts in equilibrium in studies, whose explicit C does without the iteration matrix that such a start needs."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import derive
from derive.spec.toml.read import parse
from derive.study.pivot_stability import frame_stability
from derive.study.sweep.run import sweep
from derive.study.sweep.samples import grid
from derive.study.variants import variant

HELD = """
name = "held"
[scene]
gravity = [0, -10]
start = "equilibrium"
lowering = "LOWERING"
[ground.markers]
o = [0, 0]
[bodies.arm]
mass = 1
inertia = 0.1
markers = { root = [-0.5, 0] }
start = { position = [0.5, 0] }
[joints.pin]
kind = "revolute"
between = ["ground.o", "arm.root"]
[springs.hold]
kind = "rotational"
between = ["ground.o", "arm.root"]
stiffness = { symbol = "stiffness", default = 20 }
[simulation]
duration = 0.01
output = 0.01
"""
"""An arm in gravity that a spring about its hinge holds: k phi = -m g l/2 cos phi."""


def held(lowering: str) -> derive.Scene:
    scene = parse(HELD.replace("LOWERING", lowering))
    assert isinstance(scene, derive.Scene)
    return scene


@pytest.mark.parametrize("lowering", ["flat", "instances"])
def test_the_samples_of_a_sweep_start_in_equilibrium(lowering: str) -> None:
    stiffnesses = np.array([20.0, 40.0])
    with ThreadPoolExecutor(1) as executor:
        swept = sweep(held(lowering), grid({"stiffness": stiffnesses}), "final:arm_phi", executor=executor)
    phi = swept["final:arm_phi"]
    assert stiffnesses * phi == pytest.approx(-5 * np.cos(phi), rel=1e-6)


def test_the_study_of_pivots_starts_in_equilibrium() -> None:
    result = frame_stability(variant(held("flat"), 1, "mean"), 3, 1, "", lambda _: None)
    assert result.simulated.states == 3
