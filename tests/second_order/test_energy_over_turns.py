"""Energy over a hundred turns: the equations of second order are those of a Lagrangian, truncated or not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from rod_models import compiled_scene

import derive
from derive.simulation.initial.initial_state import initial_state
from derive.simulation.integration.scipy_methods import integrate

TURNS = 100
SPIN = 30.0


def rod(terms: str, frame: str, **start: Any) -> dict[str, Any]:
    """A beam of 1 kg, 1 m, 1 N m^2 with two shapes."""
    return {
        "ansatz": ["1", "xi", "xi^2", "xi^3"],
        "frame": frame,
        "mass": 1,
        "length": 1,
        "bending_stiffness": 1,
        "order": 2,
        "terms": terms,
        "markers": {"left": -1},
        "start": {"spin": SPIN, **start},
    }


@pytest.mark.parametrize("terms", ["truncated", pytest.param("full", marks=pytest.mark.long)])
def test_a_free_beam_keeps_its_energy_and_its_momenta(terms: str) -> None:
    """It is bent by 5 % of its length and spins: energy to 1e-7 of what passes between motion and strain."""
    scene = derive.scene("free", bodies={"beam": rod(terms, "mean")})
    native = compiled_scene(scene)
    k, start = native.setup(), initial_state(scene, native, native.setup())
    q, v = start.q.copy(), start.v.copy()
    q[3:], v[3:] = [0.05, 0.004], [0.1, 0.2]
    found = integrate(native, k, q, v, np.linspace(0, 2 * np.pi * TURNS / SPIN, 201), tolerance=1e-10)
    assert abs(found.q[-1, 2]) > 0.99 * 2 * np.pi * TURNS
    energies = np.array([native.energy(q, v, k) for q, v in zip(found.q, found.v, strict=True)])
    total = energies.sum(axis=1)
    assert np.ptp(total) < 1e-7 * np.ptp(energies, axis=0).max()
    momenta = np.array([native.momentum(q, v, k) for q, v in zip(found.q, found.v, strict=True)])
    assert np.ptp(momenta, axis=0).max() < 1e-9 * np.abs(momenta).max()


@pytest.mark.long
@pytest.mark.parametrize("terms", [pytest.param("truncated", marks=pytest.mark.long), "full"])
def test_a_pendulum_that_turns_over_keeps_its_energy(terms: str) -> None:
    """On a hinge under gravity: to 1e-8 of the work of the weight; in the chord frame, where no moment vanishes."""
    scene = derive.scene(
        "over",
        gravity=[0, -40],
        ground={"hook": [0, 0]},
        bodies={"beam": rod(terms, "chord", position=[0.5, 0])},
        joints={"hinge": {"kind": "revolute", "between": ["ground.hook", "beam.left"]}},
    )
    native = compiled_scene(scene)
    k, start = native.setup(), initial_state(scene, native, native.setup())
    found = integrate(native, k, start.q, start.v, np.linspace(0, 2 * np.pi * TURNS / SPIN, 201), tolerance=1e-9)
    assert abs(found.q[-1, 2]) > 0.95 * 2 * np.pi * TURNS
    energies = np.array([native.energy(q, v, k) for q, v in zip(found.q, found.v, strict=True)])
    total = energies.sum(axis=1)
    assert np.ptp(total) < 1e-8 * np.ptp(energies, axis=0).max()
