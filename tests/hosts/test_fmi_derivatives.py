"""Directional and adjoint derivatives of units: those of differences, for all unknowns and knowns."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmus import VERSIONS, fmpy, model_of, unit
from host_models import LINKS
from numpy.typing import NDArray

from derive.export.fmi.variables import Causality, FmiVariable, fmi_variables

pytestmark = pytest.mark.hosts

STEP = 1e-6


class Exchange:
    """An instance for model exchange in its consistent state, moved off it a little."""

    def __init__(self, name: str, version: int, folder: Path) -> None:
        model = model_of(name)
        path = unit(model, version, folder)
        self.version, self.variables = version, fmi_variables(model)
        self.fmu: Any = fmpy().instantiate_fmu(
            fmpy().extract(str(path)), fmpy().read_model_description(str(path)), "ModelExchange"
        )
        if version == 2:
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.fmu.enterContinuousTimeMode()
        self.knowns = [x for x in self.variables if x.state or x.causality in (Causality.INPUT, Causality.PARAMETER)]
        self.unknowns = [x for x in self.variables if x.derivative_of is not None or x.causality is Causality.OUTPUT]
        values = self.values(self.knowns)
        self.point = values + 1e-3 * np.random.default_rng(7).standard_normal(len(values)) * np.maximum(
            1.0, abs(values)
        )

    def values(self, variables: list[FmiVariable]) -> NDArray[np.float64]:
        get = self.fmu.getReal if self.version == 2 else self.fmu.getFloat64
        return np.array(get([x.reference for x in variables]))

    def at(self, point: NDArray[np.float64]) -> NDArray[np.float64]:
        """The unknowns where the knowns have these values."""
        states = np.array([value for x, value in zip(self.knowns, point, strict=True) if x.state])
        given = [(x.reference, value) for x, value in zip(self.knowns, point, strict=True) if not x.state]
        put = self.fmu.setReal if self.version == 2 else self.fmu.setFloat64
        self.fmu.enterEventMode()  # for the parameters
        put([reference for reference, _ in given], [value for _, value in given])
        self.fmu.enterContinuousTimeMode()
        self.fmu.setContinuousStates(states.ctypes.data_as(fmpy().fmi2.POINTER(fmpy().fmi2.c_double)), len(states))
        return self.values(self.unknowns)

    def directional(self, seed: NDArray[np.float64]) -> NDArray[np.float64]:
        knowns, unknowns = ([x.reference for x in part] for part in (self.knowns, self.unknowns))
        return np.array(self.fmu.getDirectionalDerivative(unknowns, knowns, list(seed)))

    def adjoint(self, seed: NDArray[np.float64]) -> NDArray[np.float64]:
        knowns, unknowns = ([x.reference for x in part] for part in (self.knowns, self.unknowns))
        return np.array(self.fmu.getAdjointDerivative(unknowns, knowns, list(seed), len(knowns)))


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", ["crank_slider_3", "pushed", "steered", "free_beam_mean", "block", *LINKS])
def test_derivatives_are_those_of_differences(name: str, version: int, tmp_path: Path) -> None:
    exchange = Exchange(name, version, tmp_path)
    count = len(exchange.knowns)
    exchange.at(exchange.point)
    exact = np.column_stack([exchange.directional(seed) for seed in np.eye(count)])
    steps = STEP * np.maximum(1.0, abs(exchange.point))
    differences = np.column_stack(
        [
            (exchange.at(exchange.point + step) - exchange.at(exchange.point - step)) / (2 * size)
            for step, size in zip(np.diag(steps), steps, strict=True)
        ]
    )
    sizes = np.max(np.abs(exact), axis=1, keepdims=True) + 1.0  # of each unknown
    assert np.max(np.abs(exact - differences) / sizes) < 2e-6
    assert np.max(np.abs(exact)) > 1.0
    if version == 3:
        exchange.at(exchange.point)
        transposed = np.vstack([exchange.adjoint(seed) for seed in np.eye(len(exchange.unknowns))])
        assert np.max(np.abs(transposed - exact) / sizes) < 1e-9


def test_derivatives_of_others_are_refused(tmp_path: Path) -> None:
    exchange = Exchange("pushed", 3, tmp_path)
    for unknown, known in ((exchange.knowns[0], exchange.knowns[0]), (exchange.unknowns[0], exchange.unknowns[0])):
        with pytest.raises(Exception, match="DirectionalDerivative"):
            exchange.fmu.getDirectionalDerivative([unknown.reference], [known.reference], [1.0])


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("name", ["linkage", "steered", "block"])
def test_derivatives_of_the_initial_state(name: str, version: int, tmp_path: Path) -> None:
    """In the initialisation the consistent state moves with the parameters and inputs, as differences do."""
    path = unit(model_of(name), version, tmp_path)
    fmu: Any = fmpy().instantiate_fmu(
        fmpy().extract(str(path)), fmpy().read_model_description(str(path)), "ModelExchange"
    )
    if version == 2:
        fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    variables = fmi_variables(model_of(name))
    knowns = [x for x in variables if x.causality in (Causality.INPUT, Causality.PARAMETER)]
    unknowns = [x for x in variables if x.state or x.derivative_of is not None or x.causality is Causality.OUTPUT]
    of, by = [x.reference for x in unknowns], [x.reference for x in knowns]
    get, put = (fmu.getReal, fmu.setReal) if version == 2 else (fmu.getFloat64, fmu.setFloat64)

    def at(reference: int, value: float) -> NDArray[np.float64]:
        put([reference], [value])
        return np.array(get(of))

    exact = np.array([fmu.getDirectionalDerivative(of, [x], [1.0]) for x in by]).reshape(len(by), len(of))
    start = get(by)
    for row, x, value in zip(exact, by, start, strict=True):
        h = 1e-5 * max(1.0, abs(value))
        difference = (at(x, value + h) - at(x, value - h)) / (2 * h)
        put([x], [value])
        assert np.max(np.abs(row - difference)) < 1e-6 * (1.0 + np.max(np.abs(difference)))
    states = [of.index(x.reference) for x in unknowns if x.state]
    assert (np.max(np.abs(exact[:, states]), initial=0.0) > 0.1) == (name != "block")
    if version == 3:
        seeds = np.random.default_rng(5).normal(size=len(of))
        adjoint = np.array(fmu.getAdjointDerivative(of, by, list(seeds), len(by)))
        assert adjoint == pytest.approx(exact @ seeds, rel=1e-10, abs=1e-10)
    with pytest.raises(Exception, match="DirectionalDerivative"):
        fmu.getDirectionalDerivative(of, [unknowns[0].reference], [1.0])
