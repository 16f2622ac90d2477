"""Simulations of scenes whose code has loops over the bodies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import derive
from bench import chain_scene
from derive.backends.model_files import emit
from derive.ir.model import Model
from derive.lowering.flat.lower import lower as lower_flat
from derive.lowering.instances.lower import lower_instances
from derive.mechanics.multibody.mechanism import Mechanism
from derive.runtime.compiler import RUN_FLAGS
from derive.runtime.loading import load_scene
from derive.runtime.native_scene import NativeScene
from derive.simulation.constraints.certificates import independent, moves_mass
from derive.simulation.constraints.scaling import spectrum
from derive.simulation.initial.assembler import Assembler
from derive.simulation.initial.initial_state import initial_state
from derive.simulation.initial.targets import targets
from derive.simulation.integration.adaptive import adaptive
from derive.simulation.integration.integrator import Settings
from derive.simulation.observables.default_plots import SELECTED, default_plots, plots_note
from derive.simulation.validity import monitoring_outputs
from derive.simulation.validity.monitoring_outputs import monitoring_note, with_monitors
from derive.spec.model.scene import Scene
from explicit_motion import moved


def chain(count: int, kind: str = "revolute") -> Scene:
    """A straight chain of beams that a hinge holds at one end, and that falls; its joints are of this kind."""
    return chain_scene.chain(count, kind=kind, duration=0.1)


def mechanism(scene: Scene) -> Mechanism:
    derived = derive.derive(scene)
    assert isinstance(derived, Mechanism)
    return derived


def compiled(scene: Scene, model: Model) -> NativeScene:
    return load_scene(emit(model, scene, ("c",)), RUN_FLAGS)


@pytest.mark.parametrize("kind", [pytest.param("revolute", marks=pytest.mark.long), "weld"])
def test_the_motion_is_that_of_straight_line_code(kind: str) -> None:
    scene = chain(5, kind)
    derived = mechanism(scene)
    models = lower_instances(derived, explicit=False), lower_flat(derived.expanded())
    times, rows = np.linspace(0.0, 0.1, 6), []
    for model in models:
        native = compiled(scene, model)
        k = native.setup()
        start = initial_state(scene, native, k)
        rows.append(adaptive(native).integrate(k, start.q, start.v, times, Settings(tolerance=1e-11)))
    assert np.abs(rows[0].q[-1, 1]) > 1e-3, "the chain has fallen"
    np.testing.assert_allclose(rows[0].q, rows[1].q, rtol=0, atol=1e-8)
    np.testing.assert_allclose(rows[0].v, rows[1].v, rtol=0, atol=1e-6)


@pytest.mark.long
def test_a_chain_of_twenty_beams_keeps_its_energy_and_its_joints() -> None:
    scene = chain(20, "weld")
    run = moved(scene)
    assert run.model.lowering == "instances"
    native, k = run.motion.native, run.motion.k
    energies = np.array([native.energy(q, v, k) for q, v in zip(run.q, run.v, strict=True)])
    assert energies[-1, 0] > 1e-2, "kinetic energy in J"
    np.testing.assert_allclose(energies.sum(axis=1), energies[0].sum(), atol=1e-8 * energies[-1, 0])
    assert run.solution.drift.max() < 1e-10


def test_a_free_chain_conserves_momentum_and_energy() -> None:
    scene = chain_scene.chain(10, duration=0.01, free=True)
    run = moved(scene, integrator="rk4", step=1e-5)
    native, k = run.motion.native, run.motion.k
    states = list(zip(run.q, run.v, strict=True))
    momenta = np.array([native.momentum(q, v, k) for q, v in states])
    energies = np.array([native.energy(q, v, k).sum() for q, v in states])
    assert np.abs(momenta[0]).min() > 1e-3
    np.testing.assert_allclose(momenta, momenta[[0] * len(momenta)], rtol=1e-12)
    np.testing.assert_allclose(energies, energies[0], rtol=1e-8)


def test_more_beams_than_can_be_monitored_are_not_and_a_note_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = chain(2)
    assert len(with_monitors(scene).outputs) > 0
    assert monitoring_note(scene) == ()
    monkeypatch.setattr(monitoring_outputs, "MOST_BEAMS", 1)
    assert with_monitors(scene) == scene
    run = moved(scene, duration=0.01)
    assert run.validity == ()
    assert run.notes[0].startswith("validity: none of the 2 beams is monitored")


def test_default_plots_of_many_coordinates_show_some_and_a_note_says_so() -> None:
    scene = chain(70)
    model = lower_instances(mechanism(scene))
    plots = {plot.name: plot.quantity.y for plot in default_plots(scene, model)}  # type: ignore[union-attr]
    assert [len(names) for names in plots.values()] == [SELECTED] * 3
    assert plots["angles"][-1] == "link[69]_phi"
    assert {name[-2:] for name in plots["positions"]} == {"c1", "c2"}
    assert "12 of 70 of angles, 12 of 140 of positions, 12 of 140 of deformations" in plots_note(scene, model)[0]
    assert plots_note(chain(3), model=lower_instances(mechanism(chain(3)))) == ()


def test_what_is_certified_as_independent_has_no_small_singular_value() -> None:
    scene = chain(30, "weld")
    native = compiled(scene, lower_instances(mechanism(scene), explicit=False))
    k = native.setup()
    q = initial_state(scene, native, k).q
    assert independent(native, k, 0.0, q)
    assert spectrum(native, k, 0.0, q).smallest > 1e-3


def test_redundant_constraints_are_not_certified() -> None:
    scene = chain(3)
    again = replace(scene.joints[1], name="again")
    redundant = replace(scene, joints=(*scene.joints, again))
    native = compiled(redundant, lower_flat(mechanism(redundant).expanded()))
    k = native.setup()
    q = np.concatenate([[0.05 + 0.1 * i, 0, 0, 0, 0] for i in range(3)])
    assert moves_mass(native, k, q)
    assert not independent(native, k, 0.0, q)
    assert spectrum(native, k, 0.0, q).rank == native.nlambda - 2


def test_targets_have_the_same_values_without_derivatives() -> None:
    scene = chain(3)
    native = compiled(scene, lower_flat(mechanism(scene).expanded()))
    assembler = Assembler(native, native.setup(), 0.0, 0.3)
    q = np.random.default_rng(0).standard_normal(native.nq)
    for target in targets(scene, native):
        assert target.function(assembler.values(q)).value == target.function(assembler.kinematics(q)).value
