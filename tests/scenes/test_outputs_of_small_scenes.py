"""Outputs of small scenes against statics and closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from test_outputs import compiled

from derive.spec.toml.read import parse
from explicit_motion import moved


def test_a_cantilever_under_a_tip_load():
    static = parse(
        """
name = "cantilever"
ground.markers = { wall = [0, 0] }
[bodies.beam]
mass = { symbol = "m", default = 2 }
length = 1.5
bending_stiffness = 1e7
pieces = 2
frame = "clamped"
markers = { root = -1, quarter = -0.5, tip = 1 }
[joints.clamp]
kind = "weld"
between = ["ground.wall", "beam.root"]
[forces.load]
at = "beam.tip"
components = [5, -40]
[outputs.moment]
kind = "bending_moment"
section = "beam.quarter"
[outputs.shear]
kind = "shear_force"
section = "beam.quarter"
[outputs.tension]
kind = "axial_force"
section = "beam.quarter"
[outputs.strain]
kind = "strain"
section = "beam.quarter"
height = 0.01
""".replace('frame = "clamped"\n', "")
    )
    native = compiled(static)
    k, zero = native.setup(), np.zeros(native.nv)
    matrix = native.dae["index3"]
    y = np.zeros(matrix.size)
    y[:3] = [0.375, 0, 0]
    names = list(native.coordinates)
    for name, value in {"beam_1_c1": 0.375, "beam_2_c1": 1.125}.items():
        y[names.index(name)] = value
    for _ in range(4):  # Newton's method; the stiff beam hardly bends
        full = np.zeros(matrix.size)
        J = matrix.pattern.dense(matrix.jacobian(0, y, full, 0.0, k))
        F = matrix.residual(0, y, full, k)
        y = y - np.linalg.lstsq(J, F, rcond=None)[0]
    lam = y[native.nq + native.nv :]
    out = dict(zip(native.outputs, native.evaluate_outputs(0, y[: native.nq], zero, zero, lam, k), strict=True))
    assert out["moment"] == pytest.approx(-40 * 1.125, rel=1e-5)
    assert out["moment_curvature"] == pytest.approx(-40 * 1.125, rel=1e-5)
    assert out["shear"] == pytest.approx(-40, rel=1e-5)
    assert out["tension"] == pytest.approx(5, rel=1e-3)
    assert out["strain"] == pytest.approx(0.01 * 40 * 1.125 / 1e7, rel=1e-5)


def test_a_driven_slider_needs_the_force_that_accelerates_it():
    text = """
name = "slide"
ground.markers = { o = [0, 0] }
scene.gravity = [0, -9.81]
[bodies.block]
mass = 2
inertia = 1
centre = [0.3, 0.2]
markers = { hook = [0.1, 0] }
[joints.guide]
kind = "translational"
between = ["ground.o", "block.hook"]
axis = [3, 4]
[drives.push]
joint = "guide"
motion = "0.5*t^2"
[bodies.free]
mass = 1
inertia = 1
[outputs.force]
kind = "drive"
drive = "push"
[outputs.hold]
kind = "reaction"
joint = "guide"
[simulation]
duration = 0.2
output = 0.1
"""
    run = moved(parse(text))
    np.testing.assert_allclose(run["force"], 2 * 1.0 + 2 * 9.81 * 0.8, rtol=1e-12)
    force = 2 * np.array([0.6, 0.8 + 9.81])  # mass times acceleration, less the weight; at the centre of mass
    np.testing.assert_allclose([run["hold_1"][-1], run["hold_2"][-1]], force, rtol=1e-12)
    lever = np.array([0.2, 0.2])  # from the hook, about which the torque is
    np.testing.assert_allclose(run["hold_torque"], lever[0] * force[1] - lever[1] * force[0], rtol=1e-12)


def test_an_angle_of_whole_radians_is_one_like_any_other() -> None:
    """cos(1) is no exact number, and no symbol is in it."""

    def position(angle: str) -> np.ndarray:
        spec = parse(f"""
name = "slide"
ground.markers = {{ o = [0, 0] }}
[bodies.sledge]
mass = 1
inertia = 0.1
markers = {{ foot = [0, 0], tip = [0.5, 0.2] }}
[joints.guide]
kind = "translational"
between = ["ground.o", "sledge.foot"]
angle = {angle}
[drives.pull]
joint = "guide"
motion = "0.3 + t"
[bodies.bob]
mass = 1
inertia = 0.1
markers = {{ pivot = [0.1, 0] }}
[joints.pin]
kind = "revolute"
between = ["sledge.tip", "bob.pivot"]
[outputs.at]
kind = "position"
marker = "bob.pivot"
frame = "sledge.foot"
""")
        native = compiled(spec)
        q, v, k = np.array([0.4]), np.array([-0.7]), native.setup()
        vdot, lam = native.solve(0.2, q, v, k)
        return native.evaluate_outputs(0.2, q, v, vdot, lam, k)

    assert position("-1") == pytest.approx(position("-1.0000000001"), abs=1e-9)
    assert np.abs(position("-1")).min() > 0.01
