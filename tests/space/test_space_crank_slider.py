"""The rigid slider-crank in space: its start, its motion, and what its coordinates and constraints are."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.simulation.linear.modes import modes
from derive.simulation.observables.marker_positions import marker_positions
from derive.simulation.trajectory import Trajectory
from derive.spec.model.markers import MarkerRef
from derive.study.sweep.samples import grid
from explicit_motion import moved

SCENE = derive.read(ROOT / "examples" / "spatial_crank_slider_rigid.toml")


@pytest.fixture(scope="module")
def run() -> Trajectory:
    return moved(SCENE)


def test_start_is_that_of_the_benchmark(run: Trajectory) -> None:
    assert run["slider_s"][0] == pytest.approx(0.2, abs=1e-12)
    assert run["slider_sdot"][0] == pytest.approx(0.24, abs=1e-12)
    assert run["crank_phidot"][0] == pytest.approx(6.0, abs=1e-12)


def test_one_degree_of_freedom_is_left(run: Trajectory) -> None:
    native = run.motion.native
    assert (native.nq, native.nv, native.nlambda) == (4, 4, 3)


def test_the_rod_keeps_its_length(run: Trajectory) -> None:
    x = [marker_positions(run.motion, MarkerRef("rod", end)) for end in ("ball", "yoke")]
    assert np.linalg.norm(x[1] - x[0], axis=1) == pytest.approx(0.3, abs=1e-12)
    assert np.abs(run.solution.drift).max() < 1e-12


def test_energy_is_conserved(run: Trajectory) -> None:
    native, k = run.motion.native, run.motion.k
    energies = np.array([native.energy(q, v, k) for q, v in zip(run.q, run.v, strict=True)])
    assert np.ptp(energies.sum(axis=1)) < 1e-8 * np.ptp(energies[:, 0])


def test_frequency_about_the_equilibrium_is_that_of_a_small_motion() -> None:
    result = modes(SCENE)
    (frequency,) = result.frequencies
    native, k, q = result.native, result.k, result.linear.q
    # along the motion that the constraints allow, the force of a small displacement is -(2 pi f)^2 of its inertia
    amplitude = 1e-6
    change = (
        amplitude
        * np.linalg.pinv(np.column_stack([native.rates(q, e, k) for e in np.eye(native.nv)]))
        @ (result.modes[0].shape.real)
    )
    from derive.simulation.configurations import displaced
    from derive.simulation.constraints.projection import project

    moved, _ = project(native, k, 0.0, displaced(native, q, change), np.zeros(native.nv))
    vdot = native.accel(0.0, moved, np.zeros(native.nv), k)
    ratio = vdot @ change / (change @ change)
    assert np.sqrt(-ratio) / (2 * np.pi) == pytest.approx(frequency, rel=1e-4)


def test_a_sweep_runs_what_a_simulation_runs() -> None:
    """The final position of the slider for two masses, of a sweep with one compiled model and of single runs."""
    masses = grid({"bodies.slider.mass": [1.0, 3.0]})
    result = derive.sweep(SCENE, masses, ["final:slider_s"], duration=0.05, interval=0.05, tolerance=1e-9, workers=1)
    assert result.models == 1
    for mass, found in zip((1, 3), result["final_slider_s"], strict=True):
        bodies = tuple(replace(b, mass=Fraction(mass)) if b.name == "slider" else b for b in SCENE.bodies)
        alone = moved(replace(SCENE, bodies=bodies), duration=0.05, output=0.05, tolerance=1e-9)
        assert found == pytest.approx(alone["slider_s"][-1], abs=1e-9)
