"""Simulated motions in space against references: closed forms, and minimal models that share nothing with the package.

The references are exact to 1e-11 or better; what is left is the error of the integration, with a tolerance of 1e-11.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from minimal_models import Array
from reference_mechanisms import (
    GOVERNOR_SPEED,
    GOVERNOR_START,
    bricard,
    bricard_chain,
    bricard_scene,
    flyball_governor,
    flyball_governor_scene,
    slider,
    slider_crank,
    slider_crank_scene,
    turned_double_pendulum,
    turned_double_pendulum_scene,
)
from scipy.spatial.transform import Rotation
from tops import EulerBody, SymmetricTop, steady_precession

import derive
from derive.spec.toml.read import parse
from explicit_motion import moved

SETTINGS = """
[simulation]
duration = {duration}
output = {output}
tolerance = 1e-11
"""


@cache
def simulated(text: str, **changes: object) -> derive.Trajectory:
    """The motion of a scene."""
    return moved(parse(text), **changes)


def rotations(found: derive.Trajectory, body: str) -> Array:
    """The rotation matrices (rows, 3, 3) of a body that keeps its quaternion."""
    e = np.stack([found[f"{body}_e{i}"] for i in range(4)], axis=1)
    return np.asarray(Rotation.from_quat(e, scalar_first=True).as_matrix())


# ---- a body alone, and tops


FREE = EulerBody((1.0, 2.0, 2.5), (0.5, -0.4, 1.7))


def euler_scene() -> str:
    inertia, omega = list(FREE.inertia), list(FREE.omega)
    return f"""
name = "euler_body"
[bodies.body]
mass = 3
inertia = {[*inertia, 0, 0, 0]}
start = {{ position = [1, 2, 3], velocity = [0.5, -1, 2], angular_velocity = {omega} }}
{SETTINGS.format(duration=10, output=2)}"""


def test_eulers_free_body() -> None:
    """It tumbles for ten seconds, its centre of mass moves along a line."""
    found = simulated(euler_scene())
    for t, R, expected in zip(found.t, rotations(found, "body"), FREE.rotations(found.t), strict=True):
        assert np.allclose(R, expected, atol=1e-8), t
        assert np.allclose([found[f"body_c{k}"][found.t == t][0] for k in (1, 2, 3)], [1 + t / 2, 2 - t, 3 + 2 * t])
    e = np.stack([found[f"body_e{i}"] for i in range(4)])
    assert np.abs(np.linalg.norm(e, axis=0) - 1).max() < 4e-16


TOP_MASS, TOP_LENGTH, TOP_GRAVITY = 1.5, 0.4, 9.81


def top_scene(top: SymmetricTop, duration: float, extra: str = "") -> str:
    """A top on a ball joint, whose centre of mass is on its third axis."""
    about = top.A - TOP_MASS * TOP_LENGTH**2
    omega = [top.thetadot, top.phidot * np.sin(top.theta), top.phidot * np.cos(top.theta) + top.psidot]
    return f"""
name = "symmetric_top"
[scene]
gravity = [0, 0, {-TOP_GRAVITY}]
[ground.markers]
base = [0.3, -0.2, 0.1]
[bodies.top]
mass = {TOP_MASS}
centre = [0, 0, {TOP_LENGTH}]
inertia = {[about, about, top.C, 0, 0, 0]}
markers = {{ point = [0, 0, 0] }}
start = {{ rotation = {{ axis = [1, 0, 0], angle = {top.theta!r} }}, angular_velocity = {[float(x) for x in omega]} }}
{extra}
[joints.ball]
kind = "spherical"
between = ["ground.base", "top.point"]
{SETTINGS.format(duration=duration, output=duration / 5)}"""


MGL = TOP_MASS * TOP_LENGTH * TOP_GRAVITY
NUTATING = SymmetricTop(A=0.5, C=0.2, mgl=MGL, theta=0.7, phidot=0.3, thetadot=0.4, psidot=25.0)
HANGING = SymmetricTop(A=0.5, C=0.2, mgl=MGL, theta=2.0, phidot=1.5, thetadot=-0.7, psidot=0.5)


KEPT = "keep_coordinates = true"


@pytest.mark.parametrize(
    ("top", "extra"),
    [
        pytest.param(NUTATING, "", id="nutating, minimal"),
        pytest.param(HANGING, KEPT, id="hanging, constrained"),
        pytest.param(NUTATING, KEPT, id="nutating, constrained", marks=pytest.mark.long),
        pytest.param(HANGING, "", id="hanging, minimal", marks=pytest.mark.long),
    ],
)
def test_symmetric_top(top: SymmetricTop, extra: str) -> None:
    """Its attitude is that of the closed form, whether it keeps three coordinates or has three constraints."""
    found = simulated(top_scene(top, 2.0, extra))
    for R, expected in zip(rotations(found, "top"), top.rotations(found.t), strict=True):
        assert np.allclose(R, expected, atol=1e-7)


def test_steady_precession() -> None:
    for rate in map(float, steady_precession(0.5, 0.2, MGL, 0.7, 30.0)):
        top = SymmetricTop(0.5, 0.2, MGL, 0.7, phidot=rate, psidot=30.0 - rate * np.cos(0.7))
        R = rotations(simulated(top_scene(top, 1.0)), "top")
        assert np.allclose(R[:, 2, 2], np.cos(0.7), atol=1e-8)
        assert np.allclose(R[-1, :2, 2], np.sin(0.7) * np.array([np.sin(rate), -np.cos(rate)]), atol=1e-7)


# ---- mechanisms

KEEP = pytest.mark.parametrize(
    "keep", [pytest.param(False, id="minimal"), pytest.param(True, id="constrained", marks=pytest.mark.long)]
)
"""Whether bodies at joints to the ground keep all coordinates."""


@KEEP
def test_turned_double_pendulum(keep: bool) -> None:
    found = simulated(turned_double_pendulum_scene(1.2, -0.8, keep=keep))
    expected = turned_double_pendulum().motion([1.2, -0.8], [0, 0], found.t)
    a, b = expected[:, 0], expected[:, 1]
    if keep:
        lower = Rotation.from_euler("ZYZ", np.stack([a, np.full_like(a, np.pi / 4), b], axis=1))
        assert np.allclose(rotations(found, "lower"), lower.as_matrix(), atol=1e-7)
    else:
        assert np.allclose([found["upper_phi"], found["lower_phi"]], [a, b], atol=1e-7)


@KEEP
def test_slider_crank_in_space(keep: bool) -> None:
    """The slider starts at 0.2 m, with 0.24 m/s for 6 rad/s."""
    found = simulated(slider_crank_scene(6.0, keep=keep))
    angle = slider_crank().motion(0.0, 6.0, found.t)[:, 0]
    at = found["slider_c1"] if keep else found["slider_s"]
    assert np.allclose(at, slider(angle), atol=1e-7) and at[0] == pytest.approx(0.2, abs=1e-14)


@pytest.mark.long
def test_bricards_mechanism() -> None:
    """30 constraints of rank 29 are simulated without a switch."""
    found = simulated(bricard_scene(np.pi / 4))
    s = bricard().motion(np.pi / 4, 0.0, found.t)[:, 0]
    starts, turned = bricard_chain(s)
    for i in range(5):
        assert np.allclose(rotations(found, f"bar{i + 1}"), turned[i], atol=1e-6)
        centre = np.stack([found[f"bar{i + 1}_c{k}"] for k in (1, 2, 3)], axis=1)
        assert np.allclose(centre, starts[i] + turned[i][..., 0] / 2, atol=1e-6)


@pytest.mark.long
def test_flyball_governor() -> None:
    found = simulated(flyball_governor_scene(), duration=0.1, output=0.02)
    expected = flyball_governor().motion(GOVERNOR_START, [GOVERNOR_SPEED, 0, 0], found.t, "Radau")
    assert np.allclose(found["slider_c3"], expected[:, 2], atol=1e-7)
    assert np.ptp(expected[:, 2]) > 1e-4


# ---- what is conserved


FREE_PAIR = f"""
name = "free_pair"
[bodies.one]
mass = 2
centre = [0.1, 0, -0.2]
inertia = [0.3, 0.4, 0.5, 0.05, -0.02, 0.01]
markers.end = {{ at = [0.5, 0.1, 0], rotation = {{ axis = [1, 1, 0], angle = 0.7 }} }}
start = {{ position = [0, 0, 0], rotation = [1, 0, 0, 0], velocity = [1, 0, -1], angular_velocity = [2, -3, 1] }}
[bodies.two]
mass = 1
inertia = [0.1, 0.2, 0.25, 0, 0, 0]
markers.end = {{ at = [-0.4, 0, 0.2], rotation = {{ angles = [0.3, -0.4, 0.2], sequence = "zyx" }} }}
[joints.link]
kind = "KIND"
between = ["one.end", "two.end"]
{SETTINGS.format(duration=2, output=0.5)}"""


@pytest.mark.parametrize(
    "kind",
    [
        "universal",
        *(
            pytest.param(kind, marks=pytest.mark.long)
            for kind in ("spherical", "revolute", "prismatic", "cylindrical", "planar")
        ),
    ],
)
def test_joints_conserve_energy_and_momentum(kind: str) -> None:
    """Two bodies that a joint connects, and nothing acts on."""
    found = moved(parse(FREE_PAIR.replace("KIND", kind)))
    native, k = found.motion.native, found.motion.k
    momenta = np.array([native.momentum(q, v, k) for q, v in zip(found.q, found.v, strict=True)])
    energies = np.array([sum(native.energy(q, v, k)) for q, v in zip(found.q, found.v, strict=True)])
    assert np.abs(momenta - momenta[0]).max() < 1e-8 * np.abs(momenta).max()
    assert np.ptp(energies) < 1e-8 * energies[0]
    for t, q in zip(found.t, found.q, strict=True):
        assert np.abs(native.constraints(t, q, k)).max(initial=0.0) < 1e-11  # rows between steps are interpolated


@pytest.mark.parametrize("steps", [2000, pytest.param(100_000, marks=pytest.mark.long)])
def test_rotation_constraints_do_not_drift(steps: int) -> None:
    """With steps of fixed length, constraints and the length of quaternions are met to rounding."""
    spec, duration = parse(turned_double_pendulum_scene(1.2, -0.8)), 1e-3 * steps
    found = moved(spec, duration=duration, output=duration / 4, integrator="rk4", step=1e-3)
    native, k = found.motion.native, found.motion.k
    for t, q, v in zip(found.t, found.q, found.v, strict=True):
        assert np.abs(native.constraints(t, q, k)).max() < 5e-15
        assert np.abs(native.constraint_rates(t, q, v, k)).max() < 1e-13
    for body in ("upper", "lower"):
        e = np.stack([found[f"{body}_e{i}"] for i in range(4)])
        assert np.abs(np.linalg.norm(e, axis=0) - 1).max() < 1e-15


DURATIONS = {"adaptive": 6800.0, "c_ida": 300.0, "dop853": 20.0, "rk45": 10.0, "ida": 10.0}
"""s; those of the integrators in C are more than 10^5 steps."""
INTERPOLATED = {"adaptive": 1e-11}
"""The largest constraints (m, rad) in rows within steps of integrators that do not project these."""
DISSIPATED = {"c_ida": 3e-5}
"""The energy that a method of backward differences takes in more than 10^5 steps, of the largest kinetic energy."""


@pytest.mark.long
@pytest.mark.parametrize(("integrator", "duration"), DURATIONS.items())
def test_no_integrator_drifts(integrator: str, duration: float) -> None:
    """In all rows constraints and the length of quaternions are met to rounding, and energy is conserved."""
    spec = parse(turned_double_pendulum_scene(1.2, -0.8))
    found = moved(spec, duration=duration, output=duration / 50, integrator=integrator, tolerance=1e-8)
    native, k, limit = found.motion.native, found.motion.k, INTERPOLATED.get(integrator, 5e-15)
    for t, q, v in zip(found.t, found.q, found.v, strict=True):
        assert np.abs(native.constraints(t, q, k)).max() < limit
        assert np.abs(native.constraint_rates(t, q, v, k)).max() < 20 * limit
    for body in ("upper", "lower"):
        e = np.stack([found[f"{body}_e{i}"] for i in range(4)])
        assert np.abs(np.linalg.norm(e, axis=0) - 1).max() < limit
    energies = np.array([native.energy(q, v, k) for q, v in zip(found.q, found.v, strict=True)])
    assert np.ptp(energies.sum(axis=1)) < DISSIPATED.get(integrator, 1e-5) * energies[:, 0].max()
    assert integrator not in ("adaptive", "c_ida") or found.solution.cost.steps > 100_000
