"""Finite-element bodies in scenes in space: derivatives of constraints by differences, energy, and markers."""

from __future__ import annotations

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.roles import Role
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import constraint_matrix
from derive.simulation.configurations import displaced
from derive.simulation.trajectory import Trajectory
from derive.spec.toml.read import parse
from explicit_motion import moved

ROD = f"""
nodes = "{ROOT / "examples" / "spatial_rod.npz"}"
units = "SI"
modes = 3
"""
LEFT, RIGHT = list(range(9)), list(range(108, 117))
SCENE = f"""
name = "space_flexible"
[scene]
gravity = [0, 0, -9.81]
[ground.markers]
o = {{ at = [0, 0.1, 0], rotation = {{ x = [0, 1, 0], z = [0, 0, 1] }} }}
[bodies.rod]
{ROD}
start = {{ guess = true, position = [0.15, 0.1, 0] }}
[bodies.rod.markers]
left = {{ nodes = {LEFT}, rotation = {{ x = [0, 1, 0], z = [0, 0, 1] }} }}
right = {{ nodes = {RIGHT}, rotation = {{ angles = [0.3, -0.2, 0.5], sequence = "xyz" }} }}
[bodies.tip]
mass = 0.05
centre = [0.01, 0.02, -0.01]
inertia = [2e-5, 3e-5, 4e-5, 1e-6, -2e-6, 3e-6]
markers = {{ at = [0.02, 0, 0] }}
[joints.hinge]
kind = "revolute"
between = ["ground.o", "rod.left"]
start = {{ speed = 8 }}
[joints.weld]
kind = "KIND"
between = ["rod.right", "tip.at"]
[simulation]
duration = 0.05
output = 1e-3
tolerance = 1e-10
"""


@pytest.fixture(scope="module")
def run() -> Trajectory:
    return moved(parse(SCENE.replace("KIND", "fixed")))


def bent(native: NativeScene) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A state far from rest and from the constraints, with large deformations, and accelerations."""
    numbers = np.random.default_rng(1)
    q, v, a = (
        numbers.uniform(-0.5, 0.5, native.nq),
        numbers.uniform(-2, 2, native.nv),
        numbers.uniform(-2, 2, native.nv),
    )
    quaternions = [i for i, role in enumerate(native.roles) if role is Role.QUATERNION]
    for start in range(0, len(quaternions), 4):
        own = quaternions[start : start + 4]
        q[own] /= np.linalg.norm(q[own])
    amplitudes = [i for i, role in enumerate(native.roles) if role is Role.AMPLITUDE]
    q[amplitudes] *= 0.02
    return q, v, a


def test_jacobian_and_bias_are_derivatives_of_the_constraints(run: Trajectory) -> None:
    native, k, h = run.motion.native, run.motion.k, 1e-5
    q, v, a = bent(native)
    assert native.nlambda == 11

    def at(s: float) -> tuple[np.ndarray, np.ndarray]:
        # a motion with velocity v and acceleration a at s = 0, to second order: angular velocities change linearly
        return displaced(native, q, s * v + s * s / 2 * a), v + s * a

    def g(s: float) -> np.ndarray:
        return native.constraints(0.0, at(s)[0], k)

    rate = (8 * (g(h) - g(-h)) - (g(2 * h) - g(-2 * h))) / (12 * h)
    G = constraint_matrix(native, 0.0, q, k)
    assert G @ v == pytest.approx(rate, rel=1e-9, abs=1e-8)
    assert native.constraint_rates(0.0, q, v, k) == pytest.approx(rate, rel=1e-9, abs=1e-8)

    def gdot(s: float) -> np.ndarray:
        return native.constraint_rates(0.0, *at(s), k)

    second = (8 * (gdot(h) - gdot(-h)) - (gdot(2 * h) - gdot(-2 * h))) / (12 * h)
    assert G @ a - native.constraint_bias(0.0, q, v, k) == pytest.approx(second, rel=1e-8, abs=2e-7)


def test_energy_is_conserved_with_rotations_by_deformation(run: Trajectory) -> None:
    native, k = run.motion.native, run.motion.k
    energies = np.array([native.energy(q, v, k) for q, v in zip(run.q, run.v, strict=True)])
    assert np.ptp(energies[:, 1]) > 1e-4, "the rod deforms"
    assert np.ptp(energies.sum(axis=1)) < 1e-7 * np.ptp(energies[:, 0])


def test_a_node_has_no_rotation_for_joints_that_need_one() -> None:
    text = SCENE.replace("KIND", "fixed").replace(f"{{ nodes = {RIGHT}, rotation =", "{ node = 110, rotation =")
    with pytest.raises(derive.SpecError, match=r"rod\.right is a node, which has no rotation"):
        parse(text)


@pytest.mark.parametrize("kind", ["spherical", 'distance"\ndistance = "0.1'])
def test_joints_of_points_need_no_rotation(kind: str) -> None:
    text = SCENE.replace("KIND", kind).replace(f"{{ nodes = {RIGHT}, rotation =", "{ node = 110, rotation =")
    assert len(parse(text).joints) == 2


def test_nodes_on_a_line_are_refused() -> None:
    line = SCENE.replace("KIND", "spherical").replace(str(RIGHT), "[108, 109, 110]")
    with pytest.raises(derive.SpecError, match="lie on a line"):
        derive.derive(parse(line))


def test_a_missing_node_and_a_set_that_deforms_are_refused() -> None:
    with pytest.raises(derive.SpecError, match="there is no node 117"):
        parse(SCENE.replace("KIND", "spherical").replace(str(RIGHT), "[108, 109, 117]"))
    with pytest.raises(derive.SpecError, match="deforms this rigid set"):
        rigid = f'{RIGHT}, motion = "rigid"'
        derive.derive(parse(SCENE.replace("KIND", "spherical").replace(str(RIGHT), rigid)))
