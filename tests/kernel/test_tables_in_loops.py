"""Loops over instances of tables: outputs of their drives, constants of two bodies, and no parameters at all."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import derive
from derive.ir.interpreter import interpret
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse

ARMS = """
name = "arms"
[ground.markers]
o = [0, 0]
[scene]
gravity = [0, {gravity}]
[bodies.arm]
count = 3
mass = 1
inertia = 0.1
keep_coordinates = true
markers = {{ left = [-0.5, 0], right = [0.5, 0] }}
[joints.pin]
count = 3
kind = "revolute"
between = ["ground.o", "arm[i].left"]
[drives.motor]
count = 2
joint = "pin[i]"
motion = "sin(t)"
[springs.rope]
between = ["arm[1].right", "arm[2].right"]
stiffness = 100
rest = 0.1
[outputs.torque]
kind = "drive"
drive = "motor[1]"
"""


def arms(gravity: str, lowering: str) -> Scene:
    scene = parse(ARMS.format(gravity=gravity))
    assert isinstance(scene, Scene)
    return replace(scene, lowering=lowering)


@pytest.mark.parametrize("kernel", ["outputs", "parameter_jacobian"])
def test_drives_of_tables_and_gravity_that_is_a_parameter(kernel: str) -> None:
    results = []
    for lowering in ("flat", "instances"):
        model = derive.lower(derive.derive(arms('{ symbol = "g", default = -9.81 }', lowering)), sensitivities=True)
        assert model.lowering == lowering
        of, draws = model.kernel(kernel), np.random.default_rng(0)
        given = {a.name: 0.3 if a.scalar else draws.uniform(-1, 1, a.size) for a in of.arguments}
        given["k"] = interpret(model.kernel("setup"), {"p": [-9.81]})["k"]
        values = next(iter(interpret(of, given).values()))
        pattern = of.outputs[0].pattern
        results.append(values if pattern is None else pattern.dense(np.array(values)))
    np.testing.assert_allclose(*results, rtol=1e-12, atol=1e-12)
    assert np.any(results[0])


def test_patterns_without_columns_have_no_numbers() -> None:
    model = derive.lower(derive.derive(arms("-9.81", "instances")), sensitivities=True)
    (text,) = (f.text for f in derive.model_files(model, arms("-9.81", "instances")) if str(f.path).endswith(".c"))
    assert "arms_columns_mass" in text and "arms_columns_parameter_jacobian" not in text
