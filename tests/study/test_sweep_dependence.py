"""The initial states of a sweep are shared only where they are the same to the bit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sweep_scenes import pendulum, slider

from conftest import QUICK
from derive.runtime.loading import load_scene
from derive.simulation.initial.initial_guess import initial_guess
from derive.simulation.initial.initial_state import initial_state, scene_size
from derive.simulation.prepared_run import PreparedRun
from derive.spec.model.scene import EQUILIBRIUM, Scene
from derive.spec.model.scene_functions import breaks
from derive.spec.set_values import with_values
from derive.study.sweep.dependence import initial_parameters, with_defaults


@pytest.mark.parametrize(
    ("scene", "expected"),
    [
        (slider(), {"x0", "radius", "m", "speed", "F"}),
        (pendulum(), {"height", "wall", "m", "I", "e", "arm", "jump"}),
    ],
    ids=["slider", "pendulum"],
)
def test_parameters_that_are_left_out_change_nothing(scene: Scene, expected: set[str]) -> None:
    run = PreparedRun(scene)
    native = load_scene(run.files, QUICK)
    initial = initial_parameters(run.scene, run.complete_model)
    assert initial == expected
    at_rest = replace(run.scene, start=EQUILIBRIUM)  # which depends on all forces
    assert initial_parameters(at_rest, run.complete_model) == {p.name for p in run.model.parameters}
    base = initial_state(scene, native)
    for parameter in run.model.parameters:
        assert parameter.default is not None
        value = 1.1 * parameter.default + 0.01
        changed = with_defaults(scene, {parameter.name: value})
        assert changed == with_values(scene, {parameter.name: repr(value)})[0]
        if parameter.name not in initial:
            state = initial_state(changed, native, native.setup({parameter.name: value}))
            assert np.array_equal(state.q, base.q) and np.array_equal(state.v, base.v), parameter.name
            assert scene_size(changed) == scene_size(scene) and breaks(changed) == breaks(scene), parameter.name


def test_the_first_guess_follows_the_parameters() -> None:
    """The displacement of the slider counts from the bearing, to which its guide leads."""
    native = load_scene(PreparedRun(slider()).files, QUICK)
    number = native.coordinates.index("slider_s")
    assert initial_guess(slider(), native)[0][number] == pytest.approx(0.45)
    assert initial_guess(slider(), native, native.setup(x0=0.1))[0][number] == pytest.approx(0.35)
