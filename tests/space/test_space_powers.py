"""Drives, springs and loads in joints in space as outputs, and the balance of power and energy."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from arm_and_bob import ARM, BOB
from scipy.interpolate import CubicSpline

from derive.errors import SpecError
from derive.simulation.prepared_run import PreparedRun
from derive.simulation.space.marker_frames import own_frame
from derive.simulation.trajectory import Trajectory
from derive.spec.toml.read import parse

SCENE = (
    f'name = "driven_in_space"\n{ARM}[bodies.bob]\n{BOB}'
    + """[joints.first]
kind = "revolute"
between = ["ground.o", "arm.hub"]
[drives.motor]
joint = "first"
motion = "0.3*sin(4*t)"
[joints.rod]
kind = "cylindrical"
between = ["arm.end", "bob.m"]
[torques.spin]
joint = "rod"
value = "0.05*cos(3*t)"
[forces.ram]
joint = "rod"
value = "1 + 2*t"
[springs.pull]
between = ["ground.wall", "bob.n"]
stiffness = 20
damping = 0.4
rest = 0.2
[outputs.E]
kind = "energy"
[outputs.P]
kind = "power"
[outputs.M]
kind = "drive"
drive = "motor"
[outputs.S]
kind = "spring"
spring = "pull"
[outputs.L]
kind = "joint_load"
load = "spin"
[outputs.F]
kind = "joint_load"
load = "ram"
[outputs.R]
kind = "reaction"
joint = "first"
[outputs.at]
kind = "position"
marker = "bob.n"
[outputs.moving]
kind = "velocity"
marker = "bob.n"
[simulation]
duration = 0.2
output = 0.005
tolerance = 1e-11
"""
)


@cache
def run(text: str = SCENE) -> Trajectory:
    return PreparedRun(parse(text), complete=False).trajectory()


def test_the_powers_are_the_rate_of_the_energy() -> None:
    """Also of the prescribed arm, whose weight and inertia the drive moves."""
    trajectory = run()
    rate = CubicSpline(trajectory.t, trajectory["E_total"])(trajectory.t, 1)
    powers = [trajectory[f"P_{name}"] for name in ("loads", "drives", "dissipated")]
    assert min(np.abs(power).max() for power in powers) > 0.05
    assert sum(powers)[2:-2] == pytest.approx(rate[2:-2], abs=2e-5 * np.abs(rate).max())


@pytest.mark.parametrize("swapped", [pytest.param(False, marks=pytest.mark.long), True])
def test_a_drive_is_the_same_by_minimal_coordinates_and_by_a_multiplier(swapped: bool) -> None:
    ends = '["ground.o", "arm.hub"]', '["arm.hub", "ground.o"]'
    text = SCENE.replace(*ends) if swapped else SCENE
    kept = run(text.replace("mass = 1.2", "mass = 1.2\nkeep_coordinates = true"))
    eliminated = run(text)
    assert kept.motion.native.nlambda == 6 + 4
    assert eliminated.motion.native.nlambda == 4
    for name in ("M", "P_drives", "P_loads", "L_power", "F_power"):
        assert eliminated[name] == pytest.approx(kept[name], abs=1e-6 * np.abs(kept[name]).max()), name


def test_the_torque_of_a_drive_is_that_of_the_reaction_about_the_axis() -> None:
    trajectory = run()
    axis = own_frame(trajectory.scene.ground[0]).axes[:, 2]
    torque = np.column_stack([trajectory[f"R_torque{k}"] for k in (1, 2, 3)]) @ axis
    assert trajectory["M"] == pytest.approx(torque, abs=1e-12)


def test_a_spring_pulls_its_second_marker_towards_its_first() -> None:
    """Stiffness times extension and damping times its rate, both from positions and velocities alone."""
    trajectory = run()
    x, v = (np.column_stack([trajectory[f"{name}_{k}"] for k in (1, 2, 3)]) for name in ("at", "moving"))
    apart = x - [0.5, 0.2, 0.1]
    length = np.linalg.norm(apart, axis=1)
    tension = 20 * (length - 0.2) + 0.4 * np.einsum("ij,ij->i", apart, v) / length
    force = np.column_stack([trajectory[f"S_{k}"] for k in (1, 2, 3)])
    assert force == pytest.approx(-apart / length[:, None] * tension[:, None], abs=1e-12)
    assert np.abs(trajectory["S_torque1"]).max() == 0.0


def test_loads_in_joints_are_their_functions_of_time() -> None:
    trajectory = run()
    assert trajectory["L"] == pytest.approx(0.05 * np.cos(3 * trajectory.t), abs=1e-15)
    assert trajectory["F"] == pytest.approx(1 + 2 * trajectory.t, abs=1e-15)
    assert trajectory["L_power"] + trajectory["F_power"] == pytest.approx(trajectory["P_loads"], abs=1e-13)


LIFT = """
name = "lift"
[scene]
gravity = [0, 0, -10]
[ground.markers]
o = [0, 0, 0]
[bodies.nut]
mass = 3
inertia = [0.1, 0.1, 0.2, 0, 0, 0]
markers = { m = [0, 0, 0] }
[bodies.loose]
mass = 1
inertia = [1, 1, 1, 0, 0, 0]
[joints.j]
KIND
between = ["ground.o", "nut.m"]
MORE
[simulation]
duration = 0.5
output = 0.25
"""
DRIVE = """
[drives.up]
joint = "j"
motion = "2*t^2"
[outputs.D]
kind = "drive"
drive = "up"
"""
PITCH = 0.3


@pytest.mark.long
@pytest.mark.parametrize("keep", [False, True])
def test_what_a_lift_takes(keep: bool) -> None:
    """A force m (g + a) along z; on a thread a torque, of which the weight is the part that the pitch gives it."""
    kept = "mass = 3\nkeep_coordinates = true" if keep else "mass = 3"
    text = LIFT.replace("MORE", DRIVE).replace("mass = 3", kept)
    straight = run(text.replace("KIND", 'kind = "prismatic"'))
    assert straight["D"] == pytest.approx(3 * (10 + 4), rel=1e-12)
    lead = PITCH / (2 * np.pi)
    thread = run(text.replace("KIND", f'kind = "screw"\npitch = {PITCH}'))
    assert thread["D"] == pytest.approx(0.2 * 4 + lead * 3 * (10 + lead * 4), rel=1e-12)


@pytest.mark.parametrize(
    ("kind", "section", "reverse"),
    [
        ("revolute", "torques", True),
        ("prismatic", "forces", False),
        pytest.param("revolute", "torques", False, marks=pytest.mark.long),
        pytest.param("prismatic", "forces", True, marks=pytest.mark.long),
    ],
)
def test_a_load_in_a_joint_moves_the_second_body_forwards(kind: str, section: str, reverse: bool) -> None:
    load = f'[{section}.push]\njoint = "j"\nvalue = 0.6\n[outputs.q]\nkind = "joint"\njoint = "j"'
    text = LIFT.replace("KIND", f'kind = "{kind}"').replace("MORE", load).replace("-10]", "0]")
    if reverse:
        text = text.replace('["ground.o", "nut.m"]', '["nut.m", "ground.o"]')
    q = run(text)["q"]
    assert q[-1] == pytest.approx(0.6 / (0.2 if kind == "revolute" else 3) * 0.5**2 / 2, rel=1e-6)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ('[torques.x]\njoint = "k"\nvalue = 1', "torques.x.joint: there is no joint 'k'; the joints are j"),
        ('[forces.x]\njoint = "j"\nvalue = 1', "forces.x.joint: the bodies of the revolute joint j cannot move"),
        ('[outputs.x]\nkind = "drive"\ndrive = "y"', "outputs.x.drive: there is no drive 'y'; the scene has no drives"),
        ('[outputs.x]\nkind = "spring"\nspring = "y"', "outputs.x.spring: there is no spring 'y'"),
        ('[outputs.x]\nkind = "joint_load"\nload = "y"', "outputs.x.load: there is no force and no torque in a joint"),
        ('[torques.x]\njoint = "j"\nvalue = { input = "u" }', "there is no input 'u'"),
    ],
)
def test_what_is_not_there(more: str, message: str) -> None:
    with pytest.raises(SpecError) as error:
        parse(LIFT.replace("KIND", 'kind = "revolute"').replace("MORE", more))
    assert message in str(error.value).replace('"', "'")
