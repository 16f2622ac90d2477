"""The simulation of a single body in space, compared with closed forms of its motion."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.simulation.initial.spatial_state import spatial_state

BLOCK = derive.read(ROOT / "scenes/block.toml")


@cache
def body(modes: int, gravity: float = 0.0) -> derive.NodalBody:
    down = (0, 0, derive.Parameter("g", "m/s^2", gravity)) if gravity else None
    return derive.validated(replace(BLOCK, modes=modes, gravity=down))


@pytest.mark.parametrize(("integrator", "step"), [("adaptive", None), ("dop853", None), ("rk4", 1e-3)])
def test_a_block_that_spins_about_a_principal_axis_falls(integrator: str, step: float | None) -> None:
    """c = c0 + v t + g t^2 / 2; the rotation about e3 goes on with a constant angular velocity."""
    start = derive.SpatialStart(
        position=(1.0, 0.0, 2.0),
        quaternion=(np.cos(0.15), 0.0, 0.0, np.sin(0.15)),
        velocity=(0.5, 0.0, 3.0),
        angular_velocity=(0.0, 0.0, 40.0),
    )
    found = derive.simulate(
        replace(body(0, -9.81), start=start), duration=0.5, output=0.1, integrator=integrator, step=step
    )
    t = found.t
    np.testing.assert_allclose(found["c1"], 1 + 0.5 * t, atol=1e-12)
    np.testing.assert_allclose(found["c3"], 2 + 3 * t - 9.81 / 2 * t**2, atol=1e-12)
    half = 0.15 + 20 * t
    rotation = np.stack([np.cos(half), 0 * t, 0 * t, np.sin(half)], axis=1)
    np.testing.assert_allclose(found.q[:, 3:7], rotation, atol=1e-8)
    energy = found["kinetic_energy"] + found["gravity_potential"]
    np.testing.assert_allclose(energy, energy[0], rtol=1e-12)


def test_a_mode_vibrates_at_its_frequency() -> None:
    """alpha1 = a cos(omega t), with omega^2 the modal stiffness over the modal mass."""
    modal = derive.modal(body(1))
    omega = float(np.sqrt(modal.stiffness[0, 0] / modal.c8[0, 0]))
    start = derive.SpatialStart(amplitudes=(1e-7,), amplitude_rates=(0.0,))
    found = derive.simulate(replace(body(1), start=start), duration=20 / omega, output=1 / omega, tolerance=1e-12)
    np.testing.assert_allclose(found["alpha1"], 1e-7 * np.cos(omega * found.t), atol=1e-12)
    assert found.units["alpha1"] == "m" and found.units["e0"] == "" and found.units["strain_energy"] == "J"


def test_quaternions_have_length_one_from_the_first_row_on() -> None:
    """One that is given with rounding errors is normalised, with a note; then after each step of a coarse tolerance."""
    start = derive.SpatialStart(quaternion=(0.7071, 0.0, 0.7071, 0.0), angular_velocity=(3.0, 20.0, 1.0))
    found = derive.simulate(replace(body(0), start=start), duration=2.0, output=0.01, tolerance=1e-4)
    assert found.q[0, 3:7] == pytest.approx([np.sqrt(0.5), 0, np.sqrt(0.5), 0], abs=1e-15)
    assert np.abs(np.linalg.norm(found.q[:, 3:7], axis=1) - 1).max() < 4e-16
    assert found.notes == ("body.start.rotation: length of the quaternion 0.99999041 -> 1",)


def test_a_body_and_a_scene_have_trajectories_of_one_type() -> None:
    """The scene of a body is empty, and its energies are columns; a scene has those that it declares as outputs."""
    start = derive.SpatialStart(position=(1.0, 2.0, 3.0), amplitudes=(1e-6,))
    alone = derive.simulate(replace(body(1, -9.81), start=start), duration=1e-3, output=1e-3)
    beam = derive.simulate(derive.planar_beam("free"), duration=0.1, output=0.1)
    assert type(alone) is type(beam) is derive.Trajectory
    assert (alone.scene.bodies, beam.scene.bodies[0].name) == ((), "beam")
    assert alone.spec.start == start and alone.initial.q.tolist() == alone.q[0].tolist()
    assert alone.columns[-3:] == ("kinetic_energy", "strain_energy", "gravity_potential")
    assert alone.energies.shape == (2, 3) and beam.energies.shape == (2, 0)
    assert alone.energies[:, 1].tolist() == alone["strain_energy"].tolist() and alone["strain_energy"][0] > 0
    assert alone.validity == alone.warnings == ()


def test_more_amplitudes_than_modes_are_refused() -> None:
    model = derive.lower(derive.derive(body(1)))
    with pytest.raises(
        derive.SpecError, match=r"body\.start\.amplitudes: there are 2 numbers, and the body has 1 mode"
    ):
        spatial_state(model, derive.SpatialStart(amplitudes=(1.0, 2.0)))
    state = spatial_state(model, derive.SpatialStart(amplitude_rates=(3.0,)))
    assert state.q.tolist() == [0, 0, 0, 1, 0, 0, 0, 0] and state.v.tolist() == [0, 0, 0, 0, 0, 0, 3]


def test_methods_for_scenes_are_refused() -> None:
    settings = {"duration": 0.1, "output": 0.1}
    with pytest.raises(derive.SimulationError, match="ida integrates scenes; for the body block choose adaptive"):
        derive.simulate(body(0), integrator="ida", **settings)
    with pytest.raises(derive.SimulationError, match="rk4 needs a step for a single body"):
        derive.simulate(body(0), integrator="rk4", **settings)
    with pytest.raises(derive.SpecError, match="simulation: this table is missing"):
        derive.simulate(body(0))


def test_a_free_beam_vibrates_and_spins() -> None:
    """Its first mode, xi^2 - 1/3, has omega^2 = 720 EI / (m l^3), while the beam moves on uniformly."""
    beam = derive.read(ROOT / "scenes/free_beam_mean.toml")
    start = derive.InitialValues(velocity=(1.0, 0.5), deflection=(Fraction(-1, 300), Fraction(0), Fraction(1, 100)))
    bent = replace(beam, start=start, simulation=derive.Simulation(1.0, 0.01, 1e-11))
    found = derive.simulate(bent)
    np.testing.assert_allclose(found["beam_c1"], found.t, atol=1e-10)
    np.testing.assert_allclose(found["beam_c2"], found.t / 2, atol=1e-10)
    first = found["beam_alpha1"]
    assert abs(first[0]) > 1e-3
    np.testing.assert_allclose(first, first[0] * np.cos(np.sqrt(720) * found.t), atol=1e-8)
    assert derive.validated(bent) == bent


def test_a_beam_that_is_called_beam() -> None:
    """The name of the model and that of the body differ."""
    found = derive.simulate(derive.planar_beam("beam"), duration=0.1, output=0.1)
    assert "rod_phi" in found and found.name == "beam"
