"""`--to fmu2`, `--to fmu3`: FMPy validates the units without a message, and computes the motion of a simulation."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fmus import KINDS, LIVING, VERSIONS, fmpy, model_of, prepared, simulated, unit
from host_models import CHAINS, EVERYWHERE, PUSHED, STEERED

import derive
from conftest import ROOT
from derive.export.fmi.variables import fmi_variables
from derive.export.host_model import HostModel

pytestmark = pytest.mark.hosts

MODELS = ("crank_slider_3", "pushed", "steered", "free_beam_mean", "block", *EVERYWHERE)
"""A scene without ports, with a force, with a prescribed motion, a beam, and a body in space."""

TIP = ["tip[1]", "tip[2]"]

ACCURACY = {"ModelExchange": 3e-6, "CoSimulation": 1e-8}
"""Differences relative to the largest value of a state: those of the integrators, CVODE of FMPy and ours."""


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", MODELS)
def test_fmpy_validates_without_a_message(name: str, version: int, tmp_path: Path) -> None:
    path = unit(model_of(name), version, tmp_path)
    assert fmpy().validation.validate_fmu(str(path)) == []
    assert "c-code" in fmpy().supported_platforms(str(path))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", ["crank_slider_3", "free_beam_mean", "block", *EVERYWHERE])
def test_the_motion_is_that_of_a_simulation(name: str, version: int, kind: str, tmp_path: Path) -> None:
    model = model_of(name)
    duration, rows = {"crank_slider_3": (0.02, 41), "free_beam_mean": (0.5, 41)}.get(name, (0.01, 21))
    ours = derive.simulate(model.spec, duration=duration, output=duration / (rows - 1)).solution
    states = [x.name for x in fmi_variables(model) if x.state]
    path = unit(model, version, tmp_path)
    theirs = simulated(
        path, kind, states, stop_time=duration, output_interval=duration / (rows - 1), relative_tolerance=1e-9
    )
    for mine, other in ((ours.q, theirs[:, : ours.q.shape[1]]), (ours.v, theirs[:, ours.q.shape[1] :])):
        assert mine.shape == other.shape
        accuracy = ACCURACY[kind] * (10 if name in CHAINS else 1)  # chains vibrate, so that small errors of time matter
        assert np.max(np.abs(mine - other)) < accuracy * max(np.max(np.abs(mine)), 1e-3)


def pushed_by_a_simulation() -> np.ndarray:
    """The positions of the tip over time, with the function of the input."""
    outputs: np.ndarray = derive.simulate(prepared(PUSHED).spec, duration=1.0, output=0.01).solution.outputs
    return outputs[:, :2]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("version", VERSIONS)
def test_inputs_move_the_model(version: int, kind: str, tmp_path: Path) -> None:
    """FMPy holds the input in each step, so that errors fall with the step: extrapolated, the motion is ours."""
    times = np.linspace(0.0, 1.0, 2001)
    signal = np.array([(t, 0.3 * np.cos(6 * t)) for t in times], dtype=[("time", float), ("push", float)])
    path = unit(prepared(PUSHED), version, tmp_path)
    settings = {"stop_time": 1.0, "relative_tolerance": 1e-9, "input": signal}
    coarse, fine = (
        simulated(path, kind, TIP, output_interval=1 / count, **settings)[:: count // 100] for count in (1000, 2000)
    )
    expected = pushed_by_a_simulation()
    assert 1e-4 < np.max(np.abs(fine - expected)) < 1e-3
    left = {"ModelExchange": 4e-5, "CoSimulation": 2e-6}[kind]  # FMPy makes steps to the times of the signal as well
    assert np.max(np.abs(2 * fine - coarse - expected)) < left


@pytest.mark.parametrize("version", VERSIONS)
def test_prescribed_motions_go_on_within_steps(version: int, tmp_path: Path) -> None:
    """A motion that was constant in each step would be 1e-3 rad behind."""
    t = np.linspace(0.0, 1.0, 1001)
    motion = 0.5 * (1 + np.sin(4 * t)) + 3 * t**2, 2 * np.cos(4 * t) + 6 * t, -8 * np.sin(4 * t) + 6
    names = ["time", "angle", "angledot", "angleddot"]
    signal = np.array([*zip(t, *motion, strict=True)], dtype=[(name, float) for name in names])
    path = unit(prepared(STEERED), version, tmp_path)
    states = [x.name for x in fmi_variables(prepared(STEERED)) if x.state]
    settings = {"stop_time": 1.0, "output_interval": 1e-3, "relative_tolerance": 1e-9, "input": signal}
    theirs = simulated(path, "CoSimulation", states, **settings)[::10]
    spec = prepared(STEERED.replace("[inputs.side]\n", "[inputs.side]\nvalue = 0\n")).spec
    ours = derive.simulate(spec, duration=1.0, output=0.01).solution
    assert np.max(np.abs(theirs[:, :4] - ours.q)) < 1e-6
    assert np.max(np.abs(theirs[:, 4:] - ours.v)) < 1e-4


@pytest.mark.parametrize("version", VERSIONS)
def test_parameters_and_start_values_are_taken(version: int, tmp_path: Path) -> None:
    """A stiffness moves the model as that of a specification does; a start value changes the consistent state."""
    stiff = unit(prepared(PUSHED.replace("default = 10", "default = 30")), version, tmp_path).rename(tmp_path / "stiff")
    path = unit(prepared(PUSHED), version, tmp_path)

    def tip(path: Path, **start: float) -> np.ndarray:
        settings = {"stop_time": 0.1, "output_interval": 0.05, "relative_tolerance": 1e-9}
        return simulated(path, "CoSimulation", TIP, start_values=start, **settings)

    changed = tip(path, EI=30.0)
    assert np.max(np.abs(changed - tip(stiff))) < 1e-12
    assert np.max(np.abs(changed - tip(path))) > 1e-6
    model = prepared(PUSHED)
    native = derive.load_scene(model.files)
    states = [x.name for x in fmi_variables(model) if x.state]
    settings = {"stop_time": 0.1, "output_interval": 0.1}
    row = simulated(path, "CoSimulation", states, start_values={"rod.phi": -0.5}, **settings)[0]
    q, v = np.split(row, 2)
    assert abs(q[2] - -1.2) > 0.5
    assert np.max(np.abs(native.constraints(0.0, q, native.setup()))) < 1e-11
    assert np.max(np.abs(native.constraint_rates(0.0, q, v, native.setup()))) < 1e-11


def slave(model: HostModel, version: int, folder: Path, logged: list[str], start: bool = True) -> object:
    """An instance for co-simulation, initialised at t = 0."""
    path = unit(model, version, folder)
    description = fmpy().read_model_description(str(path))
    instance = fmpy().instantiate_fmu(
        fmpy().extract(str(path)), description, "CoSimulation", logger=lambda *args: logged.append(str(args[-1]))
    )
    LIVING.append(instance)
    if start:
        if version == 2:
            instance.setupExperiment(startTime=0.0)
        instance.enterInitializationMode()
        instance.exitInitializationMode()
    return instance


def values(instance: object, version: int, references: list[int]) -> list[float]:
    get = instance.getReal if version == 2 else instance.getFloat64  # type: ignore[attr-defined]
    return list(get(references))


@pytest.mark.parametrize("version", VERSIONS)
def test_a_stored_state_continues_with_the_same_bytes(version: int, tmp_path: Path) -> None:
    """A stored state continues in another instance, too, from its bytes; bytes of another unit are refused."""
    logged: list[str] = []
    model = prepared(PUSHED)
    states = [x.reference for x in fmi_variables(model) if x.state]
    first = slave(model, version, tmp_path, logged)
    first.doStep(0.0, 0.1)
    stored = first.getFMUState()
    data = first.serializeFMUState(stored)
    first.doStep(0.1, 0.1)
    expected = values(first, version, states)
    first.setFMUState(stored)
    first.doStep(0.1, 0.1)
    assert values(first, version, states) == expected
    second = slave(model, version, tmp_path, logged)
    second.setFMUState(second.deserializeFMUState(data))
    second.doStep(0.1, 0.1)
    assert values(second, version, states) == expected
    assert logged == []
    wrong = second.deserializeFMUState(data[:8] + b"x" + data[9:])
    with pytest.raises(Exception, match="SetFMU"):
        second.setFMUState(wrong)
    assert "state of another unit" in logged[0]


@pytest.mark.parametrize("version", VERSIONS)
def test_what_is_wrong_is_said(version: int, tmp_path: Path) -> None:
    logged: list[str] = []
    model = prepared(PUSHED)
    stiffness = next(x.reference for x in fmi_variables(model) if x.name == "EI")
    tip = next(x.reference for x in fmi_variables(model) if x.name == "tip[1]")
    instance = slave(model, version, tmp_path, logged)
    put = instance.setReal if version == 2 else instance.setFloat64
    for act, message in (
        (lambda: put([tip], [1.0]), "no other variable"),
        (lambda: put([stiffness], [np.nan]), "not finite"),
        (lambda: values(instance, version, [10**6]), "no real variable"),
        (lambda: instance.doStep(0.3, 0.1), "begins at the end of the one before"),
        (instance.enterInitializationMode, "present mode"),
    ):
        with pytest.raises(Exception, match="fail"):
            act()
        assert message in logged.pop(), message
    put([stiffness], [-1.0])
    with pytest.raises(Exception, match="fail"):
        instance.doStep(0.0, 0.1)
    assert "not finite or not positive" in logged[0]


def test_the_page_states_the_version_of_fmpy() -> None:
    assert f"Tried with FMPy {fmpy().__version__}," in (ROOT / "docs/hosts.md").read_text()
