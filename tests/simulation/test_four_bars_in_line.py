"""Chains of four-bar linkages through the positions in which all of their rods are in line."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from test_redundant_motion import IN_LINE, G, energy, four_bars, pendulum, simulated

from derive.simulation.errors import SingularConfiguration
from derive.spec.model.scene import Scene


def check_four_bars(count: int, scene: Scene, rate: float = -1.0, angle: float = 0.0) -> None:
    motion = simulated(scene)
    expected = pendulum(count, motion.t, rate, angle)
    for i in (0, count // 2, count):
        assert motion[f"crank[{i}]_phi"] == pytest.approx(expected, abs=1e-7)
    energies = energy(motion)
    assert np.abs(energies - energies[0]).max() < 1e-6 * count * G


@pytest.mark.parametrize(
    ("count", "redundant"),
    [
        (2, "auto"),
        (4, "resolve"),
        *(pytest.param(*case, marks=pytest.mark.long) for case in ((2, "resolve"), (4, "auto"))),
    ],
)
def test_four_bars_pass_the_positions_in_which_all_rods_are_in_line(count: int, redundant: str) -> None:
    """Four linkages are 9 moving rods, whose code has loops. In 4 s the cranks make two revolutions."""
    scene = replace(four_bars(count), redundant=redundant)
    check_four_bars(count, scene)


@pytest.mark.long
def test_eighty_one_rods_pass_the_positions_in_which_they_are_in_line() -> None:
    check_four_bars(40, four_bars(40))


@pytest.mark.long
def test_four_bars_start_in_line_along_their_velocities() -> None:
    moving = (
        (IN_LINE[0], (IN_LINE[1][0], IN_LINE[1][1])),
        ("angle = -1.5707963267948966", "angle = -1.5707963267948966, spin = -4"),
    )
    scene = four_bars(2, *moving[0], moving[1])
    check_four_bars(2, scene, -4.0, -np.pi / 2)
    with pytest.raises(SingularConfiguration, match="dead centre at t = 0 s"):
        simulated(replace(scene, redundant="error"))


def test_four_bars_at_rest_in_line_can_go_on_in_several_ways() -> None:
    with pytest.raises(SingularConfiguration, match="dead centre at t = 0 s"):
        simulated(four_bars(2, *IN_LINE))


@pytest.mark.long
@pytest.mark.parametrize("count", [pytest.param(2, marks=pytest.mark.long), 4])
def test_a_further_rod_between_parallel_cranks_is_redundant(count: int) -> None:
    """Its pins are in the middle of the first two cranks; it moves as a mass on a circle of half a metre."""
    rod = """[bodies.rod]
mass = 1
inertia = "1/12"
markers = { left = [-0.5, 0], right = [0.5, 0] }
start = { position = [0.5, 0.5] }
[joints.first]
kind = "revolute"
between = ["crank[0].middle", "rod.left"]
[joints.second]
kind = "revolute"
between = ["crank[1].middle", "rod.right"]
"""
    scene = four_bars(
        count, ("top = [0, 0.5]", "top = [0, 0.5], middle = [0, 0]"), ("[simulation]", f"{rod}[simulation]")
    )
    motion = simulated(scene)
    inertia, moment = (count + 1) / 3 + count + 0.25, G * ((count + 1) / 2 + count + 0.5)
    assert motion.model.proximal and any("is implied by" in note for note in motion.solution.notes)
    solution = solve_ivp(
        lambda t, y: (y[1], moment / inertia * np.sin(y[0])),
        (0, motion.t[-1]),
        (0, -1),
        "DOP853",
        motion.t,
        rtol=1e-13,
        atol=1e-13,
    )
    assert motion["crank[1]_phi"] == pytest.approx(solution.y[0], abs=1e-7)
    assert np.ptp(energy(motion)) < 1e-6 * count * G
