"""Configurations with quaternions: their lengths, and changes that lead from one to another."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from derive.roles import Role
from derive.simulation.configurations import blocks, difference, displaced, normalised

ROLES = (*[Role.TRANSLATION] * 3, *[Role.QUATERNION] * 4, Role.AMPLITUDE, *[Role.QUATERNION] * 4)
BODIES = SimpleNamespace(nq=12, nv=10, roles=ROLES)
"""A flexible body and a rotation."""


@pytest.fixture
def q() -> np.ndarray:
    return normalised(BODIES, np.random.default_rng(1).uniform(-1, 1, BODIES.nq))


def lengths(q: np.ndarray) -> list[float]:
    return [float(np.linalg.norm(q[i : i + 4])) for i, _, role in blocks(BODIES) if role is Role.QUATERNION]


def test_quaternions_get_length_one_and_keep_their_direction(q: np.ndarray) -> None:
    scaled = q.copy()
    scaled[3:7] *= 1.5
    scaled[8:] *= 0.2
    assert lengths(normalised(BODIES, scaled)) == pytest.approx([1, 1], abs=1e-15)
    assert normalised(BODIES, scaled) == pytest.approx(q, abs=1e-15)


def test_a_change_leads_to_the_configuration_from_which_it_is_found(q: np.ndarray) -> None:
    change = np.random.default_rng(2).uniform(-0.5, 0.5, BODIES.nv)
    other = displaced(BODIES, q, change)
    assert lengths(other) == pytest.approx([1, 1], abs=1e-15)
    assert difference(BODIES, q, other) == pytest.approx(change, abs=1e-14)
