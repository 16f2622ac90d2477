"""A four-bar of flexible links: as they grow stiff it moves like one of rigid links, and the rest goes like 1/EI."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from made import of

TIMES = np.linspace(0, 1.5, 301)
CRANK, COUPLER, ROCKER, GROUND = 0.4, 1.2, 1.0, 1.2
EI = 98.174770


def rigid(angle: np.ndarray) -> np.ndarray:
    """The point at which the coupler meets the rocker, by triangles."""
    pin = CRANK * np.exp(1j * angle)
    to_pivot = GROUND - pin
    inside = np.arccos((COUPLER**2 + np.abs(to_pivot) ** 2 - ROCKER**2) / (2 * COUPLER * np.abs(to_pivot)))
    end = pin + COUPLER * np.exp(1j * (np.angle(to_pivot) + inside))
    return np.array([end.real, end.imag]).T


def off(stiffer: float) -> float:
    """How far the end of the coupler gets from where that of a rigid one is, m."""
    made = of("four_bar")
    p = np.array([stiffer * EI])
    found = made.run(TIMES, p)
    assert found.drift.max() < 1e-12
    k = made.native.setup(p)
    ends = [made.native.marker("coupler_right", q, v, k)[0] for q, v in zip(found.q, found.v, strict=True)]
    angle = np.pi / 2 + 4 * np.pi * TIMES / 3 - np.sin(4 * np.pi * TIMES / 3)
    return float(np.abs(np.array(ends) - rigid(angle)).max())


@pytest.mark.long
def test_the_rest_to_rigid_kinematics_goes_like_one_over_the_stiffness() -> None:
    """It is 1.8 mm for links four times as stiff as those of the scene, and halves as they are twice as stiff."""
    found = [off(stiffer) for stiffer in (4, 8, 16)]
    assert found[0] == pytest.approx(1.80e-3, rel=0.01)
    assert [a / b for a, b in pairwise(found)] == pytest.approx([2.06, 2.02], abs=0.02)


def test_the_start_is_that_of_rigid_links() -> None:
    """The guess has three digits; at the start no link is bent, and all are at rest."""
    made = of("four_bar")
    _, start = made.start()
    assert not start.deformed and not start.deforming
    bent = np.array(["alpha" in name for name in made.native.coordinates])
    assert np.all(start.q[bent] == 0) and np.all(start.v == 0)
    x = made.native.marker("coupler_right", start.q, start.v, made.native.setup())[0]
    assert x == pytest.approx(rigid(np.array([np.pi / 2]))[0], abs=1e-12)


def test_the_motor_does_the_work() -> None:
    """Its multiplier is the torque on the crank; with the speed it is the power, the rate of the energy."""
    made = of("four_bar")
    found = made.run(np.linspace(0, 0.3, 3001), tolerance=1e-11)
    k = made.native.setup()
    energy = np.array([made.native.energy(q, v, k).sum() for q, v in zip(found.q, found.v, strict=True)])
    speed = 4 * np.pi / 3 * (1 - np.cos(4 * np.pi * found.t / 3))
    power = speed * found.lam[:, made.native.multipliers.index("motor")]
    work = np.concatenate([[0], np.cumsum((power[1:] + power[:-1]) / 2 * np.diff(found.t))])
    assert energy == pytest.approx(work, abs=1e-5 * energy.max())
