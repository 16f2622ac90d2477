"""A free beam that spins and bends, integrated with SciPy: what must stay, stays; both frames tell one motion."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import beams
from derive.runtime.compiled_model import Native
from derive.runtime.native_call import Vector
from derive.simulation.integration.scipy_methods import Evaluator

P = np.array([1.3, 0.7, 2.1])
UNIT = math.sqrt(P[2] / (P[0] * P[1] ** 3))
"""sqrt(EI/(m l^3)), the unit of all frequencies of the beam."""


def integrate(native: Native, q: Vector, v: Vector, times: Vector) -> tuple[Vector, Vector]:
    """q and v at some times, by an eighth-order method to nearly machine precision."""
    n = native.nq
    flow = Evaluator(native, native.setup(P))  # in the plane qdot = v
    start = np.concatenate([q, v])
    done = solve_ivp(flow, (0, times[-1]), start, "DOP853", times, rtol=1e-13, atol=1e-15)
    assert done.success
    return done.y[:n].T, done.y[n:].T


@pytest.mark.long
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
    """The first-order models differ in the centrifugal softening of odd shapes, 1 against 6.25 phidot^2.

    The missing foreshortening is of the order phidot^2 alpha, and the frames miss different parts of it.
    """
    apart = [frames_apart(a, 0.5, 10.0) for a in AMPLITUDES]
    assert all(0.9 < order < 1.3 for order in orders(apart)), apart


def modal(frame: str, n: int = 2) -> tuple[Vector, Vector, Vector]:
    """Stiffness, mass with translations and rotation free, and what spin softens, in a beam that spins steadily.

    From the compiled code: dh/dalpha at rest and its change with spin; M with the rigid rows eliminated. The beam turns
    about its centre of mass, which removes c2 c2^T / m from what the spin softens.
    """
    native, module = beams.native(frame, n), beams.module(frame, n)
    k = native.setup(P)
    size = n + 3

    def gradient(spin: float) -> Vector:
        y = np.zeros(2 * size)
        y[size + 2] = spin
        return module["dense"](module["JACOBIAN"], native.jacobian(0.0, y, np.zeros(2 * size), 0.0, k))

    mass = module["dense"](module["MASS"], native.mass(np.zeros(size), k))
    stiffness = gradient(0.0)[size + 3 :, 3:size]
    softening = stiffness - gradient(1.0)[size + 3 :, 3:size]
    c2 = mass[3:, :2]
    rigid = mass[:3, :3]
    free = mass[3:, 3:] - mass[3:, :3] @ np.linalg.solve(rigid, mass[:3, 3:])
    return stiffness, free, softening - c2 @ c2.T / mass[0, 0]


def test_spin_softening_of_the_two_frames() -> None:
    """First order: alpha1^2 is 720 - phidot^2 in both; alpha2^2 8400 - phidot^2 mean, 8400 - 6.25 phidot^2 midpoint."""
    for frame, second in (("mean", 1.0), ("point", 6.25)):
        stiffness, mass, softening = modal(frame)
        assert np.allclose(np.diag(stiffness) / np.diag(mass), np.array([720, 8400]) * UNIT**2, rtol=1e-12)
        assert np.allclose(np.diag(softening) / np.diag(mass), [1, second], rtol=1e-12)


@pytest.mark.parametrize(
    ("frame", "spin"),
    [("mean", 26.833), ("point", 26.833), ("chord", 26.833), ("point_off_centre", 12.28), ("tangent", 5.61)],
)
def test_stability_is_lost_at_the_spins_of_the_readme(frame: str, spin: float) -> None:
    stiffness, _, softening = modal(frame)
    lost = np.linalg.eigvals(np.linalg.solve(stiffness, softening)).real.max()
    assert math.isclose(1 / math.sqrt(lost) / UNIT, spin, rel_tol=1e-3)


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
