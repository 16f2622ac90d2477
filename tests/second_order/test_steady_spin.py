"""Frequencies of beams that spin: second order stiffens as the truth does; first order is lost, the earlier the more
shapes it has."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import Legendre
from rod_models import compiled_scene
from scipy.linalg import eigh
from steady_spin import beam_of, bending_frequencies, critical_spin, free_beam

import derive
from derive.notes.spin_limit import spin_limits
from derive.simulation.initial.initial_state import initial_state
from derive.simulation.linear.linearisation import linearise

ROTATING_CANTILEVER = json.loads((Path(__file__).parent / "rotating_cantilever.json").read_text())
SPINS = [10, 20, 26.83, 40, 60]


def ritz(spin: float, shapes: int = 16) -> np.ndarray:
    """The frequencies of a free beam under the tension spin^2 (1/4 - x^2)/2 of its spin, without any floating frame.

    int (w''^2 + tension w'^2 - spin^2 w^2) dx over int w^2 dx, with w orthogonal to the rigid motions.
    """
    x, weights = np.polynomial.legendre.leggauss(2 * shapes)
    x, weights = x / 2, weights / 2
    basis = [Legendre.basis(n, domain=[-0.5, 0.5]) for n in range(2, shapes + 2)]
    w, slope, bend = (np.array([p.deriv(d)(x) if d else p(x) for p in basis]) for d in (0, 1, 2))
    tension = spin**2 * (1 / 4 - x**2) / 2
    M = (w * weights) @ w.T
    return np.sqrt(eigh((bend * weights) @ bend.T + (slope * tension * weights) @ slope.T - spin**2 * M, M)[0])


def test_a_free_beam_stiffens_as_it_spins() -> None:
    """P2..P9: to 3e-5 of a Ritz method with the tension in the beam; P2, P3: 14 % high, and never lost."""
    fine, coarse = free_beam(8, "mean", 2), free_beam(2, "mean", 2)
    found = [bending_frequencies(fine, spin)[:2] for spin in SPINS]
    assert found == pytest.approx(np.array([ritz(spin)[:2] for spin in SPINS]), rel=2e-5)
    printed = [(26.558, 65.896), (36.294, 77.128), (44.355, 87.455), (61.212, 110.775), (88.160, 150.396)]
    for values, expected in zip(found, printed, strict=True):  # an independent prototype
        assert values == pytest.approx(expected, rel=1e-4)
    first = [bending_frequencies(coarse, spin)[0] for spin in SPINS]
    assert first == pytest.approx([30.332, 38.987, 46.476, 62.610, 88.994], rel=1e-4)
    assert first == pytest.approx([np.sqrt(720 + 2 * spin**2) for spin in SPINS])


@pytest.fixture(scope="module")
def cantilever() -> tuple[derive.Native, np.ndarray]:
    """A beam of P2..P9 that is clamped to the axis of a motor, and its first coordinates; the spin is a parameter."""
    rod = {
        "ansatz": [f"xi^{n}" for n in range(10)],
        "frame": "mean",
        "mass": 1,
        "length": 1,
        "bending_stiffness": 1,
        "order": 2,
        "markers": {"root": -1},
        "start": {"position": [0.5, 0]},
    }
    scene = derive.scene(
        "rotating_cantilever",
        ground={"axis": [0, 0]},
        bodies={"hub": {"markers": {"centre": [0, 0]}}, "rod": rod},
        joints={
            "shaft": {"kind": "revolute", "between": ["ground.axis", "hub.centre"]},
            "clamp": {"kind": "weld", "between": ["hub.centre", "rod.root"]},
        },
        drives={"motor": {"joint": "shaft", "speed": {"symbol": "mu", "default": 1}}},
    )
    native = compiled_scene(scene, complete=True)
    return native, initial_state(scene, native, native.setup()).q


@pytest.mark.parametrize(("mu", "limit"), [(2, 1e-8), (4, 1e-8), (6, 1e-8), (8, 1e-7), (10, 1e-7), (50, 0.013)])
def test_the_rotating_cantilever_has_the_published_frequencies(
    cantilever: tuple[derive.Native, np.ndarray], mu: float, limit: float
) -> None:
    """Chordwise and inextensible, so that flapwise^2 = chordwise^2 + mu^2, which was published. Not converged at 50."""
    native, q = cantilever
    v = np.zeros(native.nv)
    v[:3] = 0, mu * q[0], mu
    linear = linearise(native, native.setup([mu]), 0.0, q, v)
    chordwise = np.abs(np.linalg.eigvals(linear.A).imag).min()
    own = ROTATING_CANTILEVER["inextensible"]
    assert chordwise == pytest.approx(own["chordwise"][own["mu"].index(mu)], rel=limit)
    published = ROTATING_CANTILEVER["flapwise"][ROTATING_CANTILEVER["mu"].index(mu)]
    assert np.hypot(chordwise, mu) == pytest.approx(published, abs=1e-4 if mu < 50 else 0.03)


@pytest.mark.parametrize(
    ("frame", "expected"),
    [
        ("mean", {2: 26.833, 4: 22.564, 6: 22.373}),
        pytest.param({"kind": "point", "at": 0}, {2: 26.833, 4: 21.208, 6: 17.933}, marks=pytest.mark.long),
        pytest.param({"kind": "point", "at": "1/2"}, {2: 12.283, 4: 9.460, 6: 8.967}, marks=pytest.mark.long),
        ({"kind": "tangent", "at": -1}, {2: 5.606, 4: 5.593}),
    ],
)
def test_first_order_is_lost_at_a_lower_spin_with_more_shapes(frame: Any, expected: dict[int, float]) -> None:
    """The spin in sqrt(EI/(m l^3)) is never below 22.3733 in the mean frame, the first frequency; elsewhere far below.

    By eigenvalues of the compiled model, and as `build` mentions it.
    """
    found = {shapes: critical_spin(free_beam(shapes, frame, 1)) for shapes in expected}
    assert found == pytest.approx(expected, abs=1e-3)
    assert list(found.values()) == sorted(found.values(), reverse=True)
    limits = spin_limits(beam_of(max(expected), frame, 1))
    assert {shapes: limits.spins[shapes - 1] for shapes in expected} == pytest.approx(found, abs=1e-3)


def test_second_order_is_not_lost_in_that_frame() -> None:
    """The midpoint frame with four shapes, at twice and at three times the spin that first order bears."""
    beam = free_beam(4, {"kind": "point", "at": 0}, 2, "truncated")
    for spin in (42.4, 63.6):
        assert bending_frequencies(beam, spin)[:2] == pytest.approx(ritz(spin)[:2], rel=2e-3)
