"""The geometrically exact rod against closed forms, and the models of a beam against the rod."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from exact_rod import ExactRod
from numpy.polynomial import Legendre
from rod_models import TIMES, RodModel, deflection, first_mode
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc


@pytest.mark.parametrize("tip_angle", [0.1, 0.5, 1.2])
def test_the_rod_is_the_elastica(tip_angle: float) -> None:
    """The rod is clamped, with a dead load P across its tip: elliptic integrals of the modulus (1 + sin angle)/2."""
    m = (1 + np.sin(tip_angle)) / 2
    begin = np.arcsin(1 / np.sqrt(2 * m))
    root_of_load = ellipk(m) - ellipkinc(begin, m)
    expected = 1 - 2 * (ellipe(m) - ellipeinc(begin, m)) / root_of_load
    tip = ExactRod("clamped", load=(0.0, root_of_load**2)).at_rest()[2]
    assert tip[1] == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize(
    ("support", "expected"), [("free", 22.3732854), ("pinned", 15.4182057), ("clamped", 3.5160153)]
)
def test_small_motions_of_the_rod_have_the_frequencies_of_a_beam(support: str, expected: float) -> None:
    rod = ExactRod(support)
    still = np.zeros(rod.angles)
    mass = rod.equations(still, still)[0]
    stiffness = np.array([rod.equations(1e-6 * unit, still)[1] for unit in np.eye(rod.angles)]) / 1e-6
    squares = np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real
    assert np.sqrt(squares[squares > 1].min()) == pytest.approx(expected, rel=1e-7)


def test_the_rod_keeps_its_energy_and_its_length_far_from_the_straight_state() -> None:
    """Pinned, spinning at 5 sqrt(EI/(m l^3)) and bent by a tenth; some energy passes between bending and motion."""
    rod, times = ExactRod("pinned", 7), np.linspace(0, 0.5, 26)
    motion = rod.struck(Legendre([2.5, 2.5, 2.0], domain=[0, 1]), times, 1e-9)
    assert np.abs(deflection(motion, "free")).max() > 0.1
    assert np.ptp(motion.energy) < 1e-7 * motion.energy[0]
    assert np.linalg.norm(motion.right - motion.left, axis=1).min() < 0.97


SPIN = 10.0


@cache
def exact(size: float) -> np.ndarray:
    """The deflection of the exact rod, free and spinning, that is struck."""
    return deflection(ExactRod("free", 8).struck(velocity(size), TIMES["free"], 1e-8), "free")


def velocity(size: float) -> Legendre:
    """The first mode and the spin."""
    return 22.37 * size * first_mode("free") + Legendre([0, SPIN / 2], domain=[0, 1])


def error(model: RodModel, size: float) -> float:
    """The root mean square over two periods, over the largest deflection."""
    truth = exact(size)
    return float(
        np.sqrt(np.mean((deflection(model.struck(velocity(size), TIMES["free"]), "free") - truth) ** 2))
        / np.abs(truth).max()
    )


@pytest.mark.long
def test_second_order_converges_to_the_exact_rod_with_the_square_of_the_deflection() -> None:
    """In the mean frame its error passes 1 % at a deflection of 0.03 of the length: it is of the next order."""
    model = RodModel("free", "mean", "truncated")
    small, large = error(model, 0.01), error(model, 0.02)
    assert np.abs(exact(0.02)).max() == pytest.approx(0.027, abs=1e-3)
    assert large < 0.01
    assert large / small == pytest.approx(4, rel=0.15)


def test_first_order_does_not_come_to_the_exact_rod_under_spin() -> None:
    model = RodModel("free", "mean", "first order")
    assert error(model, 0.01) == pytest.approx(1.28, abs=0.05)
    assert error(model, 0.02) == pytest.approx(1.28, abs=0.05)


@pytest.mark.long
def test_a_load_across_the_tip_of_a_cantilever_up_to_large_deflections() -> None:
    """P l^3/(3 EI) to first order; the second-order model in the tangent frame yields the same."""
    model = RodModel("clamped", "mean", "truncated")
    for load, limit in ((0.1, 1e-3), (0.5, 1e-2)):
        tip = ExactRod("clamped", load=(0.0, load)).at_rest()[2]
        assert model.at_rest(load)[2][1] == pytest.approx(tip[1], rel=limit)


@pytest.mark.long
def test_a_state_at_rest_does_not_need_a_definite_mass_matrix() -> None:
    """The mass matrix of the truncated model in the chord frame is indefinite at a tip deflection of 0.26 l."""
    model = RodModel("clamped", "chord", "truncated")
    tip = ExactRod("clamped", load=(0.0, 0.9)).at_rest()[2]
    assert model.at_rest(0.9)[2][1] == pytest.approx(tip[1], rel=0.03)
