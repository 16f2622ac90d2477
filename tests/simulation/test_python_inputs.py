"""Run-time inputs that follow functions in Python: with every integrator that calls Python, otherwise refused."""

from __future__ import annotations

import os
from importlib.util import find_spec

import numpy as np
import pytest

import derive
from derive.simulation.inputs import InputFunction
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse
from explicit_motion import moved

TURNED = """
name = "turned"
ground.markers = { o = [0, 0] }
[inputs.turn]
unit = "rad"
[inputs.pull]
unit = "N"
[bodies.arm]
mass = 1
inertia = 0.2
markers = { hub = [0, 0], tip = [1, 0] }
[bodies.block]
mass = 2
inertia = 1
markers = { m = [0, 0] }
[joints.hub]
kind = "revolute"
between = ["ground.o", "arm.hub"]
[joints.guide]
kind = "translational"
between = ["ground.o", "block.m"]
[drives.motor]
joint = "hub"
motion = { input = "turn" }
[forces.pull]
at = "block.m"
components = [{ input = "pull" }, 0]
[outputs.moment]
kind = "drive"
drive = "motor"
[simulation]
duration = 1
output = 0.25
"""
INPUTS: dict[str, InputFunction] = {"turn": lambda t: (0.3 * t**3, 0.9 * t**2, 1.8 * t), "pull": lambda t: 6 * t}
"""An arm on a prescribed angle, and a block of 2 kg that moves by t^3/2."""


def scene() -> Scene:
    result = parse(TURNED)
    assert isinstance(result, Scene)
    return result


@pytest.mark.parametrize("integrator", ["adaptive", "dop853", "rk45", "ida"])
def test_integrators_that_call_python_follow_them(integrator: str) -> None:
    if integrator == "ida" and not find_spec("sksundae") and not os.environ.get("CI"):
        pytest.skip("no scikit-sundae")
    found = moved(scene(), inputs=INPUTS, integrator=integrator)
    t = found.t
    np.testing.assert_allclose(found["block_s"], t**3 / 2, rtol=0, atol=1e-7)
    np.testing.assert_allclose(found["motor"], 0.3 * t**3, rtol=1e-14, err_msg="the drive has a column of its own")
    np.testing.assert_allclose(found["u_turndot"], 0.9 * t**2, rtol=1e-14)
    np.testing.assert_allclose(found["moment"], 0.2 * 1.8 * t, rtol=0, atol=1e-7)
    assert found.units["motor"] == "rad"
    noted = "integrator: adaptive -> dop853, since functions in Python give the inputs"
    assert found.solution.notes == ((noted,) if integrator == "adaptive" else ())


def test_integrators_in_c_refuse_them() -> None:
    with pytest.raises(derive.SimulationError, match=r"rk4 calls C alone, .* for turn, pull; choose dop853, rk45 or"):
        moved(scene(), inputs=INPUTS, integrator="rk4")


@pytest.mark.parametrize("integrator", ["dop853", "ida"])
def test_what_a_function_raises_reaches_the_caller(integrator: str) -> None:
    if integrator == "ida" and not find_spec("sksundae") and not os.environ.get("CI"):
        pytest.skip("no scikit-sundae")

    def failing(t: float) -> float:
        if t > 0.5:
            raise ZeroDivisionError("my own mistake")
        return 1.0

    with pytest.raises(ZeroDivisionError, match="my own mistake"):
        moved(scene(), inputs={**INPUTS, "pull": failing}, integrator=integrator)
    with pytest.raises(ValueError, match="the inputs turn, turndot, turnddot, pull: a vector of 4 is needed"):
        moved(scene(), inputs={**INPUTS, "turn": lambda t: t}, integrator=integrator)
