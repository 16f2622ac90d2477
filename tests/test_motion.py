"""A free beam that spins and bends, integrated with SciPy: what must stay, stays; both frames tell one motion."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import beams
from derive.native import Native, Vector

P = np.array([1.3, 0.7, 2.1])
UNIT = math.sqrt(P[2] / (P[0] * P[1] ** 3))
"""sqrt(EI/(m l^3)), the unit of all frequencies of the beam."""


def integrate(native: Native, q: Vector, v: Vector, times: Vector) -> tuple[Vector, Vector]:
    """q and v at some times, by an eighth-order method to nearly machine precision."""
    k = native.setup(P)
    n = native.nq

    def flow(t: float, y: Vector) -> Vector:
        return np.concatenate([native.rates(y[:n], y[n:], k), native.accel(t, y[:n], y[n:], k)])

    start = np.concatenate([q, v])
    done = solve_ivp(flow, (0, times[-1]), start, "DOP853", times, rtol=1e-13, atol=1e-15)
    assert done.success
    return done.y[:n].T, done.y[n:].T


@pytest.mark.parametrize("frame", ["mean", "point"])
def test_energy_and_momentum_stay_over_100_turns(frame: str) -> None:
    native = beams.native(frame)
    k = native.setup(P)
    spin = 10 * UNIT
    q = np.array([0.1, -0.2, 0.3, 0.004, 0.002])
    v = np.array([0.5, -0.3, spin, 0.02, -0.05])
    times = np.linspace(0, 100 * 2 * math.pi / spin, 60)
    qs, vs = integrate(native, q, v, times)
    assert qs[-1][2] - q[2] > 99 * 2 * math.pi
    energies = np.array([native.energy(*state, k).sum() for state in zip(qs, vs, strict=True)])
    momenta = np.array([native.momentum(*state, k) for state in zip(qs, vs, strict=True)])
    assert np.max(np.abs(energies / energies[0] - 1)) < 1e-9
    assert np.max(np.abs(momenta[:, :2] - momenta[0, :2])) < 1e-9 * np.linalg.norm(momenta[0, :2])
    assert np.max(np.abs(momenta[:, 2] / momenta[0, 2] - 1)) < 1e-9
    bending = np.array([native.energy(*state, k)[1] for state in zip(qs, vs, strict=True)])
    assert bending.max() > 10 * bending.min()  # it does vibrate


def point_state(q: Vector, v: Vector, length: float) -> tuple[Vector, Vector]:
    """The state of the point frame (xi^2, xi^3) that is, to first order, a state of the mean frame (P2, P3).

    The deflection a1 P2 + a2 P3 is -a1/2 - 3/2 a2 xi + 3/2 a1 xi^2 + 5/2 a2 xi^3: the constant moves the frame
    sideways, the slope turns it.
    """
    sideways, slope = np.array([-q[3] / 2, -v[3] / 2]), np.array([-1.5 * q[4], -1.5 * v[4]])
    turn, turning = 2 * slope / length
    normal = np.array([-math.sin(q[2]), math.cos(q[2])])
    along = np.array([math.cos(q[2]), math.sin(q[2])])
    c = q[:2] + normal * sideways[0]
    cdot = v[:2] + normal * sideways[1] - along * v[2] * sideways[0]
    return (
        np.array([*c, q[2] + turn, 1.5 * q[3], 2.5 * q[4]]),
        np.array([*cdot, v[2] + turning, 1.5 * v[3], 2.5 * v[4]]),
    )


def markers_over_time(native: Native, q: Vector, v: Vector, times: Vector) -> Vector:
    """Positions of the ends, (times, 2 markers, 2)."""
    k = native.setup(P)
    qs, vs = integrate(native, q, v, times)
    states = list(zip(qs, vs, strict=True))
    return np.array([[native.marker(m, a, b, k)[0] for m in ("left", "right")] for a, b in states])


def frames_apart(amplitude: float, odd: float, spin: float) -> float:
    """The largest distance between the ends as the two frames have them, over 1.5 slow periods, in lengths.

    `amplitude` is that of the even shape over the length; `odd` times it that of the odd shape; `spin` in UNIT.
    """
    length = float(P[1])
    bend = amplitude * length
    q = np.array([0.0, 0.0, 0.3, bend, odd * bend])
    v = np.array([0.1, 0.0, spin * UNIT, bend * UNIT, -odd * bend * UNIT])
    times = np.linspace(0, 1.5 * 2 * math.pi / (26.83 * UNIT), 40)
    mean = markers_over_time(beams.native("mean"), q, v, times)
    point = markers_over_time(beams.native("point"), *point_state(q, v, length), times)
    return float(np.max(np.linalg.norm(mean - point, axis=-1))) / length


def orders(apart: list[float]) -> list[float]:
    return [math.log2(big / small) for big, small in pairwise(apart)]


AMPLITUDES = (0.02, 0.01, 0.005, 0.0025)


@pytest.mark.parametrize(
    ("odd", "spin"),
    [(0.0, lambda a: 10.0), (0.5, lambda a: 0.0), (0.5, lambda a: 500 * a)],
    ids=["even shape, spinning", "both shapes, not spinning", "both shapes, spin in step with the amplitude"],
)
def test_frames_differ_by_the_square_of_the_amplitude(odd: float, spin: Callable[[float], float]) -> None:
    """Both are first-order models of one beam: halving the amplitude divides what they differ by by four."""
    apart = [frames_apart(a, odd, spin(a)) for a in AMPLITUDES]
    assert apart[0] < 30 * AMPLITUDES[0] ** 2
    assert all(1.8 < order < 3.2 for order in orders(apart)), apart


def test_odd_shapes_at_a_fixed_spin_differ_by_the_amplitude_itself() -> None:
    """What the first-order models do not share: the centrifugal softening of odd shapes, 1 against 6.25 phidot^2.

    The missing foreshortening is of the order phidot^2 alpha, and the frames miss different parts of it.
    """
    apart = [frames_apart(a, 0.5, 10.0) for a in AMPLITUDES]
    assert all(0.9 < order < 1.3 for order in orders(apart)), apart


def frequency_squared(frame: str, spin: float) -> Callable[[int], float]:
    """Stiffness over mass of each shape in a beam that spins steadily, in EI/(m l^3), from the Jacobian."""
    native, module = beams.native(frame), beams.module(frame)
    k = native.setup(P)
    y = np.zeros(10)
    y[7] = spin * UNIT
    jacobian = module["dense"](module["JACOBIAN"], native.jacobian(0.0, y, np.zeros(10), 0.0, k))
    mass = module["dense"](module["MASS"], native.mass(y[:5], k))
    # at rest in the turning frame: alpha_i'' = -(dF_i/dalpha_i) alpha_i / m_i once the others are eliminated
    return lambda i: float(jacobian[5 + 2 + i, 2 + i] / _reduced(mass, 2 + i) / UNIT**2)


def _reduced(mass: Vector, i: int) -> float:
    """The inertia of one coordinate when all others are free."""
    return float(1 / np.linalg.inv(mass)[i, i])


def test_spin_softening_is_where_theory_says() -> None:
    """First order: alpha1 is lost at phidot = sqrt(720) in the mean frame; alpha2^2 is 8400 - phidot^2 there.

    In the point frame alpha2^2 is 8400 - 6.25 phidot^2: the first-order models of the two frames are not the same.
    """
    assert math.isclose(frequency_squared("mean", 0)(1), 720, rel_tol=1e-12)
    assert math.isclose(frequency_squared("mean", 0)(2), 8400, rel_tol=1e-12)
    assert math.isclose(frequency_squared("mean", 25)(1), 720 - 625, rel_tol=1e-9)
    assert math.isclose(frequency_squared("mean", 29)(1), 720 - 841, rel_tol=1e-9)
    assert math.isclose(frequency_squared("mean", 29)(2), 8400 - 841, rel_tol=1e-9)
    assert math.isclose(frequency_squared("point", 29)(2), 8400 - 6.25 * 841, rel_tol=1e-9)


@pytest.mark.parametrize(("n", "first", "second"), [(2, 0.1994, 0.4864), (4, 0.0085, 0.030), (6, 9e-6, 2.5e-4)])
def test_ritz_frequencies_approach_the_exact_beam(n: int, first: float, second: float) -> None:
    """Free-free beam 22.3733, 61.6728; Ritz with P2..P_{N+1} lies above by a known part."""
    native, module = beams.native("mean", n), beams.module("mean", n)
    k = native.setup(P)
    size = n + 3
    stiffness = module["dense"](
        module["JACOBIAN"], native.jacobian(0.0, np.zeros(2 * size), np.zeros(2 * size), 0.0, k)
    )
    mass = module["dense"](module["MASS"], native.mass(np.zeros(size), k))
    k_shapes, m_shapes = stiffness[size + 3 :, 3:size], mass[3:, 3:]
    frequencies = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(m_shapes, k_shapes)).real)) / UNIT
    for found, exact, above in zip(frequencies, (22.3733, 61.6728), (first, second), strict=False):
        assert math.isclose(found / exact - 1, above, rel_tol=0.05, abs_tol=2e-6)
