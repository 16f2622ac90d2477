"""Two flexible rods that fall: their energy stays, as well as the integrator is asked to keep it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from made import of

TIMES = np.linspace(0, 2, 201)


def energies(tolerance: float) -> np.ndarray:
    """Kinetic and strain energy, and the potential of the weight, one row an instant."""
    made = of("double_pendulum")
    found = made.run(TIMES, tolerance=tolerance)
    k = made.native.setup()
    assert found.drift.max() < 1e-13
    return np.array([made.native.energy(q, v, k) for q, v in zip(found.q, found.v, strict=True)])


def test_energy_stays_to_the_tolerance() -> None:
    """In 2 s its drift, against the kinetic energy, is 1.2e-6, 2.2e-8, 9.2e-11 and 1.0e-12."""
    drift = []
    for tolerance in (1e-4, 1e-6, 1e-8, 1e-10):
        found = energies(tolerance)
        drift.append(np.ptp(found.sum(axis=1)) / found[:, 0].max())
        assert drift[-1] < tolerance
    assert all(coarse > 50 * fine for coarse, fine in pairwise(drift))


def test_energies_are_those_of_rods_that_fall_and_bend() -> None:
    """At rest all is zero; the strain of a slender rod is there, but small beside the rest."""
    found = energies(1e-8)
    assert found[0] == pytest.approx([0, 0, 0], abs=1e-12)
    kinetic, strain, weight = found.T
    assert weight.min() < -0.098897337 * 9.81 * (0.5 + 1)
    assert strain.max() / kinetic.max() == pytest.approx(0.0101, rel=0.01)
