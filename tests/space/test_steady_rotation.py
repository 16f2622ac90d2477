"""Steady rotation in space against closed forms: governors, a stretched rod, and a load on a rope."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from reference_mechanisms import GOVERNOR_SPEED, GOVERNOR_START, flyball_governor, flyball_governor_scene
from scipy.linalg import eigvals
from scipy.optimize import fsolve
from steady_mechanisms import angular, pendulum, steady
from test_space_motions import KEPT

import derive
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.linear import steady_rotation
from derive.simulation.linear.modes import modes
from derive.simulation.linear.rotating_field import RotatingField
from derive.spec.toml.read import parse
from derive.visual.mode_pages import modes_page, modes_picture


@pytest.mark.parametrize("keep", ["", pytest.param(KEPT, marks=pytest.mark.long)], ids=["minimal", "constrained"])
def test_a_pendulum_on_a_driven_shaft(keep: str) -> None:
    """cos = m g s / (w^2 (A - C)), as cos = g / (w^2 l) of a point mass; about it w sin sqrt((A - C)/B)."""
    w, A, B, C = 6.0, 0.05 + 2 * 0.25, 0.06 + 2 * 0.25, 0.01
    cosine = 2 * 9.81 * 0.5 / (w * w * (A - C))
    result = modes(parse(pendulum(keep)))
    pose = result.native.poses(0.0, result.linear.q, result.k)[result.native.bodies.index("arm")]
    assert pose[3:].reshape(3, 3)[2, 2] == pytest.approx(cosine, abs=1e-10)
    assert angular(result) == pytest.approx([w * np.sqrt(1 - cosine**2) * np.sqrt((A - C) / B)], rel=1e-8)
    picture, page = modes_picture(result, 2), modes_page(result, 2)
    assert picture.count('<path class="there"') == 1 and '"name":"base"' in page


@pytest.mark.long
def test_the_flyball_governor() -> None:
    """Its position and its damped frequencies are those of a minimal model, which knows nothing of rotating axes."""
    model = flyball_governor()
    rates = (GOVERNOR_SPEED, 0, 0)
    at = fsolve(lambda x: model.accelerations((0, *x), rates)[1:], GOVERNOR_START[1:], xtol=1e-13)
    scene = parse(steady(flyball_governor_scene(keep=False)))
    result, relative = (modes(replace(scene, coordinates=form)) for form in ("absolute", "relative"))
    assert result.linear.q[result.native.coordinates.index("slider_c3")] == pytest.approx(at[1], abs=1e-9)
    step, A = 1e-5, np.zeros((5, 5))  # the states: both coordinates, and all three rates
    A[:2, 3:] = np.eye(2)
    first = np.array([*at, *rates], float)
    for j in range(5):
        ahead, behind = first.copy(), first.copy()
        ahead[j] += step
        behind[j] -= step
        slopes = [model.accelerations((0, *x[:2]), x[2:]) for x in (ahead, behind)]
        A[2:, j] = (slopes[0] - slopes[1]) / (2 * step)
    found, other = (np.array([mode.eigenvalue for mode in of.modes]) for of in (result, relative))
    known = [x for x in sorted(eigvals(A), key=abs)[1:] if x.imag >= 0]  # the first one is that of a faster rotation
    assert len(known) == 3  # rods that move against each other are not in the model
    for value in known:
        assert np.abs(found - value).min() < 1e-5 * abs(value)
        assert np.abs(other - value).min() < 1e-5 * abs(value)


ROD_LENGTH, ROD_MASS, SECTIONS, SIDE, ROD_STIFFNESS, RATE = 2.0, 3.0, 11, 0.05, 4e3, 12.0
"""m, kg, and the modal stiffness (N/m) of its stretching, for a rotation in rad/s."""


def rod(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Write a rod along x that stretches as a sine; returns x, the square of y, and the masses of its nodes."""
    x = np.linspace(-ROD_LENGTH / 2, ROD_LENGTH / 2, SECTIONS)
    corners = SIDE * np.array([(1, 1), (1, -1), (-1, -1), (-1, 1)])
    positions = np.array([(xi, y, z) for xi in x for y, z in corners])
    masses = np.full(len(positions), ROD_MASS / len(positions))
    modes_ = np.zeros((1, len(positions), 3))
    modes_[0, :, 0] = np.sin(np.pi * positions[:, 0] / ROD_LENGTH)
    np.savez(path, positions=positions, mass=masses, modes=modes_, modal_stiffness=np.array([[ROD_STIFFNESS]]))
    return positions[:, 0], positions[:, 1] ** 2, masses


def test_a_rod_that_its_rotation_stretches(tmp_path: Path) -> None:
    """k q = w^2 int (x + q s) s dm; it oscillates about that with its angular momentum, which Coriolis forces keep."""
    x, yy, m = rod(tmp_path / "rod.npz")
    (tmp_path / "scene.toml").write_text(f"""
name = "stretched_rod"
[scene]
start = "steady"
[bodies.rod]
nodes = "rod.npz"
units = "SI"
modes = 1
markers = {{ end = {SECTIONS - 1} }}
start = {{ position = [0, 0, 0], rotation = [1, 0, 0, 0], angular_velocity = [0, 0, {RATE}] }}
""")
    result = modes(derive.read(tmp_path / "scene.toml"))
    s = np.sin(np.pi * x / ROD_LENGTH)
    modal = float(m @ s**2)
    q = RATE**2 * (m @ (x * s)) / (ROD_STIFFNESS - RATE**2 * modal)
    J, slope = m @ ((x + q * s) ** 2 + yy), 2 * m @ (s * (x + q * s))
    stiffness = ROD_STIFFNESS + RATE**2 * (slope**2 / J - modal)
    assert abs(result.linear.q[-1]) == pytest.approx(q * np.sqrt(modal), rel=1e-9)  # of a mode of unit modal mass
    assert np.min(np.abs(angular(result) - np.sqrt(stiffness / modal))) < 1e-7 * np.sqrt(stiffness / modal)


CRANE = """
name = "crane"
[scene]
gravity = [0, 0, -9.81]
start = "steady"
[ground.markers]
foot = [0, 0, 0]
[bodies.tower]
mass = 5
inertia = [1, 1, 1, 0, 0, 0]
markers = { foot = [0, 0, 0], top = [0, 0, 3] }
[bodies.jib]
mass = 2
inertia = [0.1, 1, 1, 0, 0, 0]
markers = { ring = [0, 0, 0], tip = [2, 0, 0] }
[bodies.load]
mass = 4
inertia = [1, 1, 1, 0, 0, 0]
markers.hook = [0, 0, 0.3]
start = { guess = true, position = [2.1, 0, 1.6], rotation = { axis = [1, 2, 3], angle = 0.3 } }
[joints.foot]
kind = "fixed"
between = ["ground.foot", "tower.foot"]
[joints.slew]
kind = "revolute"
between = ["tower.top", "jib.ring"]
[drives.slew]
joint = "slew"
speed = 0.9
[springs.rope]
between = ["jib.tip", "load.hook"]
stiffness = 2e4
rest = 1
"""


def test_a_load_on_a_rope_of_a_crane_rotates_with_the_jib() -> None:
    """A tower that stands on the ground tells nothing of the axes, nor do rounding errors of a load without joints."""
    q = modes(parse(CRANE)).linear.q
    rope = 1 + 4 * np.hypot(9.81, 0.81 * q[0]) / 2e4
    tilt = np.arctan2(0.81 * q[0], 9.81)  # of the rope, and with it of the load: its centre of mass is in line
    assert q[:3] == pytest.approx([2 + (rope + 0.3) * np.sin(tilt), 0, 3 - (rope + 0.3) * np.cos(tilt)], abs=1e-8)


def test_another_angle_about_the_axis_is_no_other_rotation(monkeypatch: pytest.MonkeyPatch) -> None:
    """Newton's method may turn a scene by rounding errors about the axis of its rotation, about which it is free."""
    balanced = steady_rotation._balanced

    def elsewhere(native: NativeScene, k: Vector, q: Vector, field: RotatingField, size: float) -> Vector:
        return field.later(balanced(native, k, q, field, size), 2.0 / max(field.rates))

    expected = [modes(parse(pendulum(keep))) for keep in ("", KEPT)]
    monkeypatch.setattr(steady_rotation, "_balanced", elsewhere)
    for keep, of in zip(("", KEPT), expected, strict=True):
        assert angular(modes(parse(pendulum(keep)))) == pytest.approx(angular(of), rel=1e-6)
