"""Small motions of a free beam that spins steadily, in the rotating frame, by the generated Jacobian."""

from __future__ import annotations

from typing import Any

import numpy as np

import derive
from derive.generated_models import generated

FLAGS = ("-std=c99", "-O0", "-ffp-contract=off")


def beam_of(shapes: int, frame: Any, order: int, terms: str | None = None) -> derive.PlanarBeam:
    """A beam of 1 kg, 1 m, 1 N m^2 with so many shapes from monomials: spins are in rad/s."""
    return derive.planar_beam(
        "free",
        ansatz=[f"xi^{n}" for n in range(shapes + 2)],
        frame=frame,
        mass=1,
        length=1,
        bending_stiffness=1,
        order=order,
        terms=terms,
    )


def free_beam(shapes: int, frame: Any, order: int, terms: str | None = None) -> derive.Native:
    """The compiled C of `beam_of`."""
    spec = beam_of(shapes, frame, order, terms)
    return derive.load(generated(spec)[1], FLAGS)


def eigenvalues(beam: derive.Native, spin: float) -> np.ndarray:
    """The 2 nv eigenvalues, 1/s, of small motions about the straight beam that spins about its centre.

    With c = Q z the coefficients do not depend on time, where the generated Jacobian gives the derivatives by c and its
    rates at phi = 0: dcdot = dzdot + W dz and dcddot = dzddot + 2 W dzdot + W^2 dz, with W = spin x.
    """
    n = beam.nv
    k, q, v = beam.setup(), np.zeros(n), np.zeros(n)
    v[2] = spin
    y, ydot = np.concatenate([q, v]), np.concatenate([v, np.zeros(n)])
    still, moving = (beam.jacobian_pattern.dense(beam.jacobian(0.0, y, ydot, cj, k)) for cj in (0.0, 1.0))
    M, H, K = (moving - still)[n:, n:], still[n:, n:], still[n:, :n]
    W = np.zeros((n, n))
    W[0, 1], W[1, 0] = -spin, spin
    damping, stiffness = H + 2 * M @ W, K + H @ W + M @ W @ W
    below = -np.linalg.solve(M, np.hstack([stiffness, damping]))
    return np.linalg.eigvals(np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), below]))


def bending_frequencies(beam: derive.Native, spin: float) -> np.ndarray:
    """The frequencies of the modes with a deformation, rad/s: without zeros and without translation at the spin."""
    found = eigenvalues(beam, spin)
    assert np.abs(found.real).max() < 1e-5 * max(1.0, spin)
    positive = np.sort(found.imag[found.imag > 1e-3])
    return positive[np.abs(positive - spin) > 1e-4]


def critical_spin(beam: derive.Native, highest: float = 40.0) -> float:
    """The spin up to which no small motion grows, by bisection: between 0 and `highest`, where one does."""
    low, high = 0.0, highest
    assert eigenvalues(beam, high).real.max() > 1e-2
    while high - low > 1e-5 * highest:
        middle = (low + high) / 2
        low, high = (low, middle) if eigenvalues(beam, middle).real.max() > 1e-2 else (middle, high)
    return high
