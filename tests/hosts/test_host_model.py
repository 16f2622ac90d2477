"""The model that hosts receive: its start values are those of a simulation, in the order of its descriptor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from host_models import PUSHED, STEERED, prepared, scene

import derive
from conftest import QUICK
from derive.export.fmi.variables import Causality, fmi_variables
from derive.export.host_model import host_model
from derive.pipeline import generate
from derive.spec.toml.read import parse


def started(variables: tuple[object, ...]) -> list[float]:
    return [x.start for x in variables]  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    "name",
    [
        *("four_bar", "pushed"),
        *(pytest.param(n, marks=pytest.mark.long) for n in ("block", "crank_slider_3", "free_beam_mean")),
    ],
)
def test_start_values_are_those_of_a_simulation(name: str) -> None:
    model = prepared(PUSHED) if name == "pushed" else scene(name)
    trajectory = derive.simulate(model.spec, duration=1e-4, output=1e-4)
    q, v = (trajectory.solution.q[0], trajectory.solution.v[0])
    assert np.allclose(started(model.coordinates), q, rtol=1e-9, atol=1e-10)
    assert np.allclose(started(model.velocities), v, rtol=1e-9, atol=1e-10)


@pytest.mark.parametrize("text", [PUSHED, STEERED], ids=["pushed", "steered"])
def test_names_are_those_of_the_descriptor_in_its_order(text: str) -> None:
    model = prepared(text)
    native = derive.load_scene(model.files, QUICK)
    assert tuple(x.name for x in model.coordinates) == native.coordinates
    assert tuple(x.name for x in model.velocities) == native.velocities
    assert tuple(x.name for x in model.inputs) == native.inputs
    assert tuple(x.name for x in model.outputs) == native.outputs
    assert tuple(x.unit for x in model.outputs) == native.output_units
    assert tuple(x.name for x in model.parameters) == native.parameters
    assert started(model.parameters) == native.defaults.tolist()


def test_a_table_of_the_descriptor_counts_elements_of_arrays() -> None:
    model = host_model(replace(scene("block").spec, lowering="loops"))
    assert len(model.coordinates) == 15 and model.coordinates[-1].name == "alpha8"
    native = derive.load(model.files, QUICK)
    assert tuple(x.name for x in model.parameters) == native.parameters and len(model.parameters) > 1


def test_a_prescribed_motion_has_two_derivatives_at_the_start() -> None:
    """The motion is 0.5 (1 + sin 4t) + 3 t^2; the force has no value, and is zero."""
    model = prepared(STEERED)
    angle, rate, acceleration, side = model.inputs
    assert (angle.name, rate.name, acceleration.name, side.name) == ("angle", "angledot", "angleddot", "side")
    assert (angle.unit, rate.unit, acceleration.unit) == ("rad", "rad/s", "rad/s^2")
    assert [u.start for u in model.inputs] == [0.5, 2.0, 6.0, 0.0]
    assert [u.derivative for u in model.inputs] == [0, 1, 2, 0]
    assert model.constant_inputs == (0.5, 0.0, 0.0, 0.0)


def test_the_start_state_follows_the_inputs() -> None:
    """The arm has the angle and the speed of its drive."""
    model = prepared(STEERED)
    native = derive.load_scene(model.files, QUICK)
    k = native.with_inputs(native.setup(), [u.start for u in model.inputs])
    q, v = (np.array(started(part)) for part in (model.coordinates, model.velocities))
    assert np.max(np.abs(native.constraints(0.0, q, k))) < 1e-14
    assert np.max(np.abs(native.constraint_rates(0.0, q, v, k))) < 1e-14
    assert q[2] == pytest.approx(0.5, abs=1e-12)
    changed = host_model(derive.validated(model.spec))
    assert changed.coordinates == model.coordinates


def test_other_functions_have_start_values() -> None:
    text = STEERED.replace('"amplitude*(1 + sin(4*t)) + 3*t^2"', '"amplitude*exp(2*t) + step(t, -1, 1) + abs(t - 2)"')
    value, rate, acceleration, _ = (u.start for u in prepared(text).inputs)
    assert (value, rate, acceleration) == pytest.approx((0.5 + 0.5 + 2.0, 1.0 + 15 / 16 - 1.0, 2.0), rel=1e-14)


def test_files_are_those_of_the_pipeline() -> None:
    """The C with its function NAME_start, as `build` generates it."""
    model = scene("four_bar")
    assert model.files == generate(model.spec, backends=("c",)).files
    assert "four_bar_start(" in model.header.text and isinstance(model.derived, derive.Mechanism)


def test_a_body_has_no_ports() -> None:
    model = scene("block")
    assert model.inputs == model.outputs == model.multipliers == ()


def test_names_of_a_unit_are_those_of_the_specification_and_others_make_way() -> None:
    """Outputs called energy and time, as in the tutorial, beside local variables of those names."""
    outputs = '[outputs.energy]\nkind = "energy"\n[outputs.time]\nkind = "rotation"\nmarker = "rod.tip"\n'
    variables = fmi_variables(host_model(parse(PUSHED + outputs), sensitivities=True))
    names = [x.name for x in variables]
    assert len(set(names)) == len(names)
    of = {x.name: x.causality for x in variables}
    assert [of[name] for name in ("energy.kinetic", "energy.total", "time")] == [Causality.OUTPUT] * 3
    assert of["pushed.energy.kinetic"] is Causality.LOCAL and of["pushed.time"] is Causality.INDEPENDENT
