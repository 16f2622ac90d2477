"""Steady rotation in space against closed forms: a top, a governor, a stretched rod, a free body, and what is none."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from reference_mechanisms import GOVERNOR_SPEED, GOVERNOR_START, flyball_governor, flyball_governor_scene
from scipy.linalg import eigvals
from scipy.optimize import fsolve
from test_space_motions import KEPT, MGL, top_scene
from tops import SymmetricTop, steady_precession

import derive
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.linear import steady_rotation
from derive.simulation.linear.modes import Modes, modes
from derive.simulation.linear.rotating_field import RotatingField
from derive.simulation.linear.steady_motion import NoSteadyMotion
from derive.spec.toml.read import parse
from derive.visual.mode_pages import modes_page, modes_picture
from explicit_motion import moved


def steady(text: str) -> str:
    """A scene that starts in a steady rotation."""
    return text.replace("[scene]", '[scene]\nstart = "steady"')


def angular(result: Modes) -> np.ndarray:
    """The angular frequencies of the modes that oscillate, rad/s, ascending."""
    found = 2 * np.pi * result.frequencies
    return np.sort(found[found > 0])


# ---- regular precession of a symmetric top

MOMENTS, INCLINED, FAST = (0.5, 0.2), 0.7, 30.0
"""Moments of inertia across and along, kg m^2; the inclination; the angular velocity along the axis, rad/s."""


def top(precession: float, theta: float) -> str:
    """A top with these rates of precession and of its own rotation, at a first guess of its inclination."""
    spin = FAST - precession * np.cos(INCLINED)
    return steady(top_scene(SymmetricTop(*MOMENTS, MGL, theta, phidot=precession, psidot=spin), 1.0, KEPT))


def nutation(precession: float) -> float:
    """The frequency (rad/s) at which the inclination oscillates with the momenta of the precession.

    It follows from the curvature of (p - C n cos)^2/(2 A sin^2) + mgl cos, with the momentum p about the vertical and
    n about the axis, where p - C n cos is A sin^2 times the precession.
    """
    A, C = MOMENTS
    c, s = np.cos(INCLINED), np.sin(INCLINED)
    slope = C * FAST * s - 2 * A * precession * s * c  # that of the rate of precession, times A sin^2
    curvature = slope**2 / (A * s * s) + A * precession**2 * s * s
    return float(np.sqrt(curvature / A))


@pytest.mark.parametrize("number", [0, pytest.param(1, marks=pytest.mark.long)], ids=["slow", "fast"])
def test_regular_precession_of_a_symmetric_top(number: int) -> None:
    """The inclination is that at which the given rates are steady, and the top nutates about it as the energy says."""
    precession = float(steady_precession(*MOMENTS, MGL, INCLINED, FAST)[number])
    result = modes(parse(top(precession, INCLINED + 0.06)))
    assert result.steady is not None and result.steady.spin == pytest.approx(precession)
    assert result.steady.text.endswith("about [0, 0, 1] through [0.3, -0.2, 0] m")
    e = result.linear.q[3:7]
    assert 1 - 2 * (e[1] ** 2 + e[2] ** 2) == pytest.approx(np.cos(INCLINED), abs=1e-10)
    assert angular(result) == pytest.approx([nutation(precession)], rel=1e-7)
    assert result.zero_eigenvalues == 4 and result.modes[-1].damping_ratio == pytest.approx(0, abs=1e-9)


def test_a_simulation_stays_in_steady_precession() -> None:
    precession = float(steady_precession(*MOMENTS, MGL, INCLINED, FAST)[0])
    found = moved(parse(top(precession, INCLINED + 0.06)))
    vertical = 1 - 2 * (found["top_e1"] ** 2 + found["top_e2"] ** 2)
    assert vertical == pytest.approx(np.full(6, np.cos(INCLINED)), abs=1e-8)
    assert np.ptp(found["top_e3"]) > 0.1


def test_a_free_body_precesses_about_its_angular_momentum() -> None:
    """With |L|/A in space and (A - C)/A of its rotation along the axis in the body; in the rotating axes it nutates."""
    A, C, omega = 1.0, 1.5, np.array([0.5, -0.4, 1.7])
    result = modes(
        parse(f"""
name = "free_body"
[scene]
start = "steady"
[bodies.body]
mass = 3
inertia = [{A}, {A}, {C}, 0, 0, 0]
start = {{ position = [1, 2, 3], angular_velocity = {omega.tolist()} }}
""")
    )
    momentum = omega * [A, A, C]
    assert result.steady is not None and result.steady.rotation == pytest.approx(momentum / A)
    assert result.linear.q == pytest.approx([1, 2, 3, 1, 0, 0, 0])
    assert angular(result)[-1] == pytest.approx(np.linalg.norm(momentum) / A)


# ---- a governor

PENDULUM = """
name = "governor"
[scene]
gravity = [0, 0, -9.81]
start = "steady"
[ground.markers]
base = [0, 0, 0]
[bodies.shaft]
mass = 1
inertia = [0.1, 0.1, 0.1, 0, 0, 0]
markers.foot = [0, 0, 0]
markers.hinge = { at = [0, 0, 1], rotation = { x = [1, 0, 0], z = [0, 1, 0] } }
KEEP
[bodies.arm]
mass = 2
centre = [0, 0, -0.5]
inertia = [0.05, 0.06, 0.01, 0, 0, 0]
markers.top = { at = [0, 0, 0], rotation = { x = [1, 0, 0], z = [0, 1, 0] } }
start = { guess = true, position = [0, 0, 1], rotation = { axis = [0, 1, 0], angle = -0.8 } }
[joints.bearing]
kind = "revolute"
between = ["ground.base", "shaft.foot"]
[joints.hinge]
kind = "revolute"
between = ["shaft.hinge", "arm.top"]
[drives.motor]
joint = "bearing"
speed = 6
"""


@pytest.mark.parametrize("keep", ["", pytest.param(KEPT, marks=pytest.mark.long)], ids=["minimal", "constrained"])
def test_a_pendulum_on_a_driven_shaft(keep: str) -> None:
    """cos = m g s / (w^2 (A - C)), as cos = g / (w^2 l) of a point mass; about it w sin sqrt((A - C)/B)."""
    w, A, B, C = 6.0, 0.05 + 2 * 0.25, 0.06 + 2 * 0.25, 0.01
    cosine = 2 * 9.81 * 0.5 / (w * w * (A - C))
    result = modes(parse(PENDULUM.replace("KEEP", keep)))
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


# ---- a flexible rod

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
    index = np.arange(len(positions))
    np.savez(
        path,
        positions=positions,
        mass_row=index,
        mass_col=index,
        mass_value=masses,
        modes=modes_,
        modal_stiffness=np.array([[ROD_STIFFNESS]]),
    )
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


# ---- the angle about the axis, which nothing determines


def test_another_angle_about_the_axis_is_no_other_rotation(monkeypatch: pytest.MonkeyPatch) -> None:
    """Newton's method may turn a scene by rounding errors about the axis of its rotation, about which it is free."""
    balanced = steady_rotation._balanced

    def elsewhere(native: NativeScene, k: Vector, q: Vector, field: RotatingField, size: float) -> Vector:
        return field.later(balanced(native, k, q, field, size), 2.0 / max(field.rates))

    expected = [modes(parse(PENDULUM.replace("KEEP", keep))) for keep in ("", KEPT)]
    monkeypatch.setattr(steady_rotation, "_balanced", elsewhere)
    for keep, of in zip(("", KEPT), expected, strict=True):
        assert angular(modes(parse(PENDULUM.replace("KEEP", keep)))) == pytest.approx(angular(of), rel=1e-6)


# ---- what is no steady rotation


def refused(text: str) -> str:
    """The message about a scene."""
    with pytest.raises(NoSteadyMotion) as caught:
        modes(parse(text))
    return str(caught.value)


def test_motions_that_are_not_steady_say_why() -> None:
    across = PENDULUM.replace("KEEP", KEPT).replace("[0, 0, -9.81]", "[0, -9.81, 0]")
    direction = "not those of a rotation of the whole scene about the direction of gravity"
    assert re.search(rf"{direction}: motor misses it by [.\d]+ m/s or rad/s; give", refused(across))
    unsymmetric = re.sub(r"inertia = \[[^,]*,", "inertia = [0.3,", top(1.0, INCLINED))
    assert re.search(r"top.start.angular_velocity misses it by [.\d]+ rad/s;", refused(unsymmetric))
    wire = '[springs.wire]\nbetween = ["ground.base", "arm.tip"]\nstiffness = 5\nrest = 0.1\n'
    tied = PENDULUM.replace("KEEP", "").replace("markers.top", "markers.tip = [0, 0, -1]\nmarkers.top") + wire
    assert modes(parse(tied)).steady is not None  # the other end of the wire is on the axis
    beside = tied.replace("base =", "wall = [2, 0, 0]\nbase =").replace('"ground.base", "arm', '"ground.wall", "arm')
    assert "is not the same in axes that rotate with the scene" in refused(beside)
    slow = PENDULUM.replace("KEEP", "").replace("speed = 6", "speed = 2").replace("angle = -0.8", "angle = -1.3")
    assert "far from the initial state: a rotation along arm_phidot by 1.3 rad" in refused(slow)  # it hangs


FORK = """
name = "fork"
[scene]
gravity = [0, 0, -9.81]
start = "steady"
[ground.markers]
head = { at = [0, 0, 0.6], rotation = { axis = [0, 1, 0], angle = -0.4 } }
[bodies.crown]
mass = 1.2
inertia = [0.004, 0.002, 0.004, 0, 0, 0]
[bodies.crown.markers]
steer = [0, 0, 0]
left = { at = [0, 0.06, 0], rotation = { x = [0, 0, -1], y = [0, 1, 0] } }
right = { at = [0, -0.06, 0], rotation = { x = [0, 0, -1], y = [0, 1, 0] } }
[bodies.left]
mass = 0.8
inertia = [1e-4, 0.01, 0.01, 0, 0, 0]
markers = { top = [-0.2, 0, 0], bottom = [0.2, 0, 0] }
[bodies.right]
mass = 0.8
inertia = [1e-4, 0.01, 0.01, 0, 0, 0]
markers = { top = [-0.2, 0, 0], bottom = [0.2, 0, 0] }
[bodies.axle]
mass = 0.4
inertia = [4e-4, 1e-4, 4e-4, 0, 0, 0]
[bodies.axle.markers]
left = { at = [0, 0.06, 0], rotation = { x = [0, 0, -1], y = [0, 1, 0] } }
right = { at = [0, -0.06, 0], rotation = { x = [0, 0, -1], y = [0, 1, 0] } }
[joints.head]
kind = "revolute"
between = ["ground.head", "crown.steer"]
start = { angle = 0.05, guess = true }
JOINTS
[springs.steering]
kind = "rotational"
between = ["ground.head", "crown.steer"]
stiffness = 40
"""


def test_a_loop_of_rigid_bodies_whose_rows_are_rounding_errors_balances_in_its_spring() -> None:
    """Multipliers along rows of 1e-17 would balance any force, so that the fork would rest where it is guessed."""
    pairs = {"lt": "crown.left left.top", "rt": "crown.right right.top", "lb": "left.bottom axle.left"}
    pairs["rb"] = "right.bottom axle.right"

    def fork(names: str) -> Modes:
        tables = (f'[joints.{n}]\nkind = "fixed"\nbetween = {json.dumps(pairs[n].split())}\n' for n in names.split())
        return modes(parse(FORK.replace("JOINTS", "".join(tables))))

    closed, open_loop = fork("lt rt lb rb"), fork("lt rt lb")
    assert np.abs(closed.linear.q).max() < 1e-9  # the centre of mass is below the axis of the head
    assert angular(closed) == pytest.approx(angular(open_loop), rel=1e-9)
