"""A nut on its thread and a planetary gear against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from test_space_gears import KEEP, PLANETS

from derive.simulation.prepared_run import PreparedRun
from derive.spec.toml.read import parse

FALLING = """
name = "nut"
[scene]
gravity = [0, 0, -9.81]
[ground.markers]
o = [0, 0, 0]
[bodies.nut]
mass = 2
inertia = [0.02, 0.02, 0.001, 0, 0, 0]
markers = { bore = [0, 0, 0] }
KEEP
[joints.thread]
kind = "screw"
pitch = -0.3
between = ["ground.o", "nut.bore"]
start = { angle = 10 }
[outputs.turn]
kind = "joint"
joint = "thread"
[outputs.x]
kind = "position"
marker = "nut.bore"
[outputs.R]
kind = "reaction"
joint = "thread"
[simulation]
duration = 1
output = 0.1
tolerance = 1e-10
"""


@pytest.mark.parametrize("keep", ["", KEEP])
def test_a_nut_falls_along_its_thread(keep: str) -> None:
    """The closed form: (J + m lead^2) phidotdot = - m g lead; the start counts the turns of the nut."""
    trajectory = PreparedRun(parse(FALLING.replace("KEEP", keep)), complete=False).trajectory()
    lead = -0.3 / (2 * np.pi)
    turn = 10 - 2 * 9.81 * lead / (0.001 + 2 * lead**2) * trajectory.t**2 / 2
    assert trajectory["x_3"] == pytest.approx(lead * turn, abs=1e-8)
    shown = trajectory["turn"]
    assert np.cos(shown - turn) == pytest.approx(1, abs=1e-12)
    if not keep:
        assert shown == pytest.approx(turn, abs=1e-8)
    # the thread bears what gravity does not accelerate, and turns the nut by its axial force
    assert trajectory["R_3"] == pytest.approx(2 * (9.81 + lead * (turn[-1] - 10) * 2), rel=1e-7)
    assert trajectory["R_torque3"] == pytest.approx(-lead * trajectory["R_3"], rel=1e-7)


@pytest.mark.long
def test_a_planetary_gear_between_bodies_that_turn_with_the_carrier() -> None:
    """Willis: (omega_planet - omega_carrier)/(omega_sun - omega_carrier) = - z_sun/z_planet, about an inclined axis."""
    trajectory = PreparedRun(parse(PLANETS), complete=False).trajectory()
    carrier, sun, planet = (trajectory[f"{name}_3"] for name in ("carrier", "sun", "planet"))
    assert planet - carrier == pytest.approx(-2.1 * (sun - carrier), abs=1e-9)
    assert np.ptp(trajectory["E_total"]) < 1e-7 * trajectory["E_kinetic"].max()
    assert np.ptp(np.unwrap(trajectory["phi"])) > 4 * np.pi
    # the teeth mesh: 10 psi + 21 phi is a number of whole turns, that of the start
    turns = (10 * np.unwrap(trajectory["psi"]) + 21 * np.unwrap(trajectory["phi"])) / (2 * np.pi)
    assert turns == pytest.approx(np.round(turns[0]), abs=1e-9)
