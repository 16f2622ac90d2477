"""The inputs and reactions of given motions of scenes: those with which scenes move like that, or what is missing."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import derive
from conftest import QUICK
from derive.backends.model_files import explicit_files
from derive.spec.toml.read import parse

ARM = """
name = "arm"
scene.gravity = [0, -9.81]
ground.markers = { o = [0, 0] }
[bodies.lower]
ansatz = ["1", "xi", "xi^2", "xi^3"]
frame = "mean"
mass = 1.3
length = 1.2
bending_stiffness = 70
markers = { left = -1, right = 1 }
[bodies.upper]
mass = 2
inertia = 0.4
keep_coordinates = true
markers = { pin = [-0.4, 0], tip = [0.5, 0.1] }
[joints.shoulder]
kind = "revolute"
between = ["ground.o", "lower.left"]
[joints.elbow]
kind = "revolute"
between = ["lower.right", "upper.pin"]
[inputs]
first.value = "0"
second.value = "0"
[torques.shoulder]
at = "lower.left"
value = { input = "first" }
[torques.elbow]
at = "upper.pin"
against = "lower.right"
value = { input = "second" }
"""
CRANK = """
name = "crank"
ground.markers = { o = [0, 0] }
[bodies.crank]
mass = 1
inertia = 0.1
markers = { o = [0, 0], pin = [0.5, 0] }
[bodies.rod]
mass = 2
inertia = 0.3
markers = { pin = [-0.4, 0] }
[joints.bearing]
kind = "revolute"
between = ["ground.o", "crank.o"]
[joints.pin]
kind = "revolute"
between = ["crank.pin", "rod.pin"]
[inputs.turn]
value = "t"
unit = "rad"
[drives.motor]
joint = "bearing"
motion = { input = "turn" }
"""
MORE = """
[inputs.third]
value = "0"
[torques.third]
at = "lower.left"
value = { input = "third" }
[torques.third_again]
at = "lower.left"
value = { input = "third" }
"""


@cache
def native(text: str) -> derive.NativeScene:
    spec = parse(text)
    return derive.load_scene(explicit_files(derive.lower(derive.derive(spec), explicit=True), spec), QUICK)


def moving(scene: derive.NativeScene, u: Any) -> tuple[Any, ...]:
    """k with inputs, a state that meets the constraints, and its accelerations and multipliers."""
    rng, k = np.random.default_rng(2), scene.setup()
    k = scene.with_inputs(k, u)
    q = rng.uniform(-0.5, 0.5, scene.nq) * [0.1 if "alpha" in name else 1.0 for name in scene.coordinates]
    for _ in range(20):
        q = q + scene.project_velocity(0.0, q, k, -scene.constraints(0.0, q, k))
    v = rng.uniform(-1, 1, scene.nv)
    v = v + scene.project_velocity(0.0, q, k, -scene.constraint_rates(0.0, q, v, k))
    assert abs(scene.constraints(0.0, q, k)).max() < 1e-13
    return (k, q, v, *scene.solve(0.0, q, v, k))


def test_the_inputs_of_a_flexible_arm_are_those_with_which_it_moves() -> None:
    """Given are the accelerations of the angles alone: those of positions and modes follow, as do the reactions."""
    scene = native(ARM)
    k, q, v, vdot, lam = moving(scene, [3.0, -2.0])
    angles = np.array([name.endswith("phidot") for name in scene.velocities])
    forces = derive.inverse_dynamics(scene, 0.0, q, v, np.where(angles, vdot, np.nan), k)
    assert list(forces.inputs) == ["first", "second"] and not forces.undetermined
    assert np.allclose(list(forces.inputs.values()), [3.0, -2.0], rtol=1e-9)
    assert np.allclose(forces.vdot, vdot, rtol=1e-9) and np.allclose(forces.multipliers, lam, rtol=1e-9)
    complete = derive.inverse_dynamics(scene, 0.0, q, v, vdot, k)
    assert np.allclose(list(complete.inputs.values()), [3.0, -2.0], rtol=1e-8)


def test_other_accelerations_are_met_by_the_inputs_that_are_found() -> None:
    scene = native(ARM)
    k, q, v, vdot, _ = moving(scene, [0.0, 0.0])
    angles = np.array([name.endswith("phidot") for name in scene.velocities])
    wanted = np.where(angles, vdot + 3.0, np.nan)
    found = derive.inverse_dynamics(scene, 0.0, q, v, wanted, k)
    vdot, _ = scene.solve(0.0, q, v, scene.with_inputs(scene.setup(), list(found.inputs.values())))
    assert np.allclose(vdot[angles], wanted[angles], rtol=1e-9)
    assert np.allclose(vdot, found.vdot, rtol=1e-9)


def test_modes_have_no_inputs() -> None:
    """Two modes with accelerations of their own lack two inputs, and joints contradict what they do not allow."""
    scene = native(ARM)
    k, q, v, vdot, _ = moving(scene, [0.0, 0.0])
    modes = np.array(["alpha" in name for name in scene.velocities])
    positions = np.array([name.endswith(("c1dot", "c2dot")) for name in scene.velocities])
    wanted = np.where(positions, np.nan, vdot + 5.0 * modes)
    with pytest.raises(derive.MissingInputs, match="no inputs give these accelerations; 2 are missing"):
        derive.inverse_dynamics(scene, 0.0, q, v, wanted, k)
    with pytest.raises(derive.MissingInputs, match=r"the accelerations contradict the constraints .*elbow_1"):
        derive.inverse_dynamics(scene, 0.0, q, v, np.where(positions, 0.0, vdot), k)


def test_of_more_inputs_than_needed_the_least_are_found() -> None:
    scene = native(ARM + MORE)
    k, q, v, vdot, lam = moving(scene, [3.0, -2.0, 1.0])
    angles = np.array([name.endswith("phidot") for name in scene.velocities])
    forces = derive.inverse_dynamics(scene, 0.0, q, v, np.where(angles, vdot, np.nan), k)
    assert np.allclose([*forces.inputs.values()], [1.0, -2.0, 2.0], rtol=1e-9)  # first + 2 third = 5
    assert forces.undetermined == ("first", "third")
    assert np.allclose(forces.multipliers, lam, rtol=1e-9)
    one = derive.inverse_dynamics(scene, 0.0, q, v, np.where(angles, vdot, np.nan), k, inputs=["first", "second"])
    assert one.inputs["first"] == pytest.approx(3.0)  # beside the third, whose value k has


def test_drives_that_inputs_prescribe_have_their_torques_among_the_multipliers() -> None:
    text = (
        ARM + '[inputs.turn]\nvalue = "0"\nunit = "rad"\n[drives.motor]\njoint = "elbow"\nmotion = { input = "turn" }\n'
    )
    scene = native(text)
    k, q, v, vdot, lam = moving(scene, [3.0, -2.0, 0.1, 0.2, 0.3])
    first = np.array([name == "lower_phidot" for name in scene.velocities])
    forces = derive.inverse_dynamics(scene, 0.0, q, v, np.where(first, vdot, np.nan), k, inputs=["first"])
    assert forces.inputs["first"] == pytest.approx(3.0)
    assert np.allclose(forces.multipliers, lam, rtol=1e-9) and np.allclose(forces.vdot, vdot, rtol=1e-9)
    assert [*derive.inverse_dynamics(scene, 0.0, q, v, vdot, k).inputs] == ["first", "second"]


def test_a_model_of_loops_over_bodies_has_it_too() -> None:
    scene = native('scene.lowering = "instances"\n' + ARM)
    k, q, v, vdot, _ = moving(scene, [3.0, -2.0])
    assert np.allclose([*derive.inverse_dynamics(scene, 0.0, q, v, vdot, k).inputs.values()], [3.0, -2.0], rtol=1e-8)


def test_wrong_arguments() -> None:
    scene = native(ARM)
    k, q, v, vdot, _ = moving(scene, [0.0, 0.0])
    with pytest.raises(derive.UnknownNameError, match="input of arm"):
        derive.inverse_dynamics(scene, 0.0, q, v, vdot, k, inputs=["firs"])
    with pytest.raises(ValueError, match="vdot"):
        derive.inverse_dynamics(scene, 0.0, q, v, vdot[1:], k)


def test_an_input_that_is_no_force_is_refused() -> None:
    """The angle of the crank enters h through sines; by default it is not sought, since it prescribes a motion."""
    scene = native(CRANK)
    k = scene.with_inputs(scene.setup(), [0.3, 1.0, 0.0])
    assert derive.inverse_dynamics(scene, 0.0, [0.5], [1.0], [np.nan], k).inputs == {}
    with pytest.raises(ValueError, match="crank: the forces are not linear in the input turn; give it a value"):
        derive.inverse_dynamics(scene, 0.0, [0.5], [1.0], [0.0], k, inputs=["turn"])
