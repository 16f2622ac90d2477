"""The functions that importers may call in each mode, and the errors of calls in another mode."""

from __future__ import annotations

import ctypes
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmus import LIVING, VERSIONS, fmpy, prepared, unit
from host_models import PUSHED

from derive.export.fmi.variables import fmi_variables

pytestmark = pytest.mark.hosts

JUMP = PUSHED.replace('"pushed"', '"jump"').replace(
    'components = [{ input = "push" }, 0]', 'components = [{ input = "push" }, "piecewise(t < 0.125, 0, 5)"]'
)
REAL = ctypes.c_double
OK, DISCARD, ERROR = 0, 2, 3


class Raw:
    """An instance of the pushed pendulum, whose functions of FMI are called as they are."""

    def __init__(self, version: int, exchange: bool, folder: Path, text: str = PUSHED) -> None:
        model = prepared(text)
        path = unit(model, version, folder)
        self.version, self.logged = version, list[str]()
        self.kind = "ModelExchange" if exchange else "CoSimulation"
        self.description = fmpy().read_model_description(str(path))
        self.fmu: Any = fmpy().instantiate_fmu(
            fmpy().extract(str(path)), self.description, self.kind, logger=lambda *a: self.logged.append(str(a))
        )
        LIVING.append(self.fmu)
        self.references = {x.name: x.reference for x in fmi_variables(model)}
        self.nx = sum(x.state for x in fmi_variables(model))

    def call(self, name: str, *arguments: Any) -> int:
        """The status of a function."""
        function = getattr(self.fmu.dll, f"fmi{self.version}{name}")
        function.argtypes = function.restype = None
        function.restype = ctypes.c_int
        result: int = function(ctypes.c_void_p(getattr(self.fmu.component, "value", self.fmu.component)), *arguments)
        return result

    def initialise(self, start: float = 0.0, stop: float | None = None) -> int:
        given = (ctypes.c_int(0), REAL(0), REAL(start), ctypes.c_int(stop is not None), REAL(stop or 0.0))
        if self.version == 2:
            assert self.call("SetupExperiment", *given) == OK
            assert self.call("EnterInitializationMode") == OK
        else:
            assert self.call("EnterInitializationMode", *given) == OK
        return self.call("ExitInitializationMode")

    def vector(self, name: str, values: list[float] | None = None) -> int:
        array = (REAL * self.nx)(*(values or [0.1] * self.nx))
        return self.call(name, array, ctypes.c_size_t(self.nx))

    def set(self, name: str, value: float) -> int:
        sizes = (ctypes.c_size_t(1),) if self.version == 3 else ()
        reference, number = (ctypes.c_uint * 1)(self.references[name]), (REAL * 1)(value)
        return self.call(
            "SetReal" if self.version == 2 else "SetFloat64", reference, ctypes.c_size_t(1), number, *sizes
        )

    def get(self, name: str) -> float:
        get = self.fmu.getReal if self.version == 2 else self.fmu.getFloat64
        return float(get([self.references[name]])[0])

    def event(self) -> int:
        if self.version == 2:
            return self.call("NewDiscreteStates", ctypes.create_string_buffer(64))
        return self.call("UpdateDiscreteStates", *(ctypes.create_string_buffer(8) for _ in range(6)))

    def step(self, t: float, h: float) -> int:
        results = [ctypes.create_string_buffer(8) for _ in range(4)] if self.version == 3 else []
        return self.call("DoStep", REAL(t), REAL(h), ctypes.c_int(1), *results)

    def completed(self) -> int:
        return self.call(
            "CompletedIntegratorStep", ctypes.c_int(1), *(ctypes.create_string_buffer(8) for _ in range(2))
        )


@pytest.mark.parametrize("version", VERSIONS)
def test_model_exchange_alternates_between_two_modes(version: int, tmp_path: Path) -> None:
    raw = Raw(version, True, tmp_path)
    continuous = {
        "states": lambda: raw.vector("SetContinuousStates"),
        "completed": raw.completed,
        "event mode": lambda: raw.call("EnterEventMode"),
    }
    event = {
        "update": raw.event,
        "parameter": lambda: raw.set("EI", 11.0),
        "continuous-time mode": lambda: raw.call("EnterContinuousTimeMode"),
    }
    everywhere = {"time": lambda: raw.call("SetTime", REAL(0.0)), "input": lambda: raw.set("push", 0.4)}
    never = {
        "step": lambda: raw.step(0.0, 0.1),
        "initialisation": lambda: raw.call("ExitInitializationMode"),
        "state": lambda: raw.set("rod.phi", 0.1),
    }

    def statuses(*groups: dict[str, Any]) -> dict[str, int]:
        return {name: act() for group in groups for name, act in group.items()}

    wrong = {**continuous, "update": raw.event, "time": everywhere["time"], "step": never["step"]}
    assert set(statuses(wrong).values()) == {ERROR}
    assert raw.initialise() == OK
    assert set(statuses(continuous, never).values()) == {ERROR}
    assert set(statuses(everywhere, event).values()) == {OK}
    assert set(statuses(event, never).values()) == {ERROR}
    assert set(statuses(everywhere, continuous).values()) == {OK}
    assert raw.call("Terminate") == OK
    assert set(statuses(continuous, event, everywhere, never).values()) == {ERROR}
    assert all("present mode" in text or "no other variable" in text for text in raw.logged)
    assert raw.call("Reset") == OK
    assert raw.initialise() == OK


@pytest.mark.parametrize("version", VERSIONS)
def test_co_simulation_has_steps_alone(version: int, tmp_path: Path) -> None:
    raw = Raw(version, False, tmp_path)
    assert raw.step(0.0, 0.1) == ERROR
    assert raw.initialise() == OK
    for act in (
        lambda: raw.call("SetTime", REAL(0.0)),
        lambda: raw.vector("SetContinuousStates"),
        raw.event,
        raw.completed,
        lambda: raw.call("EnterEventMode"),
        lambda: raw.call("EnterContinuousTimeMode"),
    ):
        assert act() == ERROR
    assert raw.set("EI", 11.0) == OK
    assert raw.step(0.0, 0.1) == OK
    assert raw.call("Terminate") == OK
    assert raw.step(0.1, 0.1) == ERROR


@pytest.mark.parametrize("version", VERSIONS)
def test_no_step_passes_the_stop_time(version: int, tmp_path: Path) -> None:
    raw = Raw(version, False, tmp_path)
    assert raw.initialise(0.5, 0.8) == OK
    assert raw.get("time") == 0.5
    assert raw.step(0.5, 0.1) == OK
    assert raw.step(0.6, 0.2 + 1e-16) == OK  # with a rounding error
    assert raw.step(0.8, 0.01) == ERROR
    assert "stop time" in raw.logged[-1]
    assert raw.call("Reset") == OK
    assert raw.initialise() == OK
    assert raw.step(0.0, 1.0) == OK


@pytest.mark.parametrize("version", VERSIONS)
def test_messages_are_those_of_the_categories_that_are_asked_for(version: int, tmp_path: Path) -> None:
    raw = Raw(version, False, tmp_path)
    assert [x.name for x in raw.description.logCategories] == ["logStatusError", "logStatusDiscard"]

    def logged(on: bool, *categories: str) -> list[str]:
        """The categories of an error and a discarded step."""
        names = (ctypes.c_char_p * len(categories))(*(x.encode() for x in categories))
        assert raw.call("SetDebugLogging", ctypes.c_int(on), ctypes.c_size_t(len(categories)), names) == OK
        raw.logged.clear()
        assert raw.step(7.0, 0.1) == ERROR
        assert raw.set("EI", -1.0) == OK
        assert raw.step(0.0, 0.1) == DISCARD
        return re.findall("logStatus[A-Z][a-z]+", " ".join(raw.logged))

    assert raw.initialise() == OK
    both = ["logStatusError", "logStatusDiscard"]
    assert logged(True) == both
    assert logged(False) == []
    assert logged(True, "logStatusError") == both[:1]
    assert logged(False, "logStatusError") == []
    assert logged(True, "logStatusDiscard") == both[1:]
    assert logged(True) == both
    names = (ctypes.c_char_p * 1)(b"logEvents")
    assert raw.call("SetDebugLogging", ctypes.c_int(1), ctypes.c_size_t(1), names) == ERROR
    assert "no such category" in raw.logged[-1]


@pytest.mark.parametrize("version", VERSIONS)
def test_a_state_belongs_to_its_kind_of_simulation(version: int, tmp_path: Path) -> None:
    get, put = ("getFMUstate", "setFMUstate") if version == 2 else ("getFMUState", "setFMUState")
    exchange, steps = (Raw(version, kind, tmp_path) for kind in (True, False))
    early = getattr(exchange.fmu, get)()
    for raw in (exchange, steps):
        assert raw.initialise(0.25, 0.5) == OK
    for raw, other in ((exchange, steps), (steps, exchange)):
        with pytest.raises(Exception, match="SetFMU"):
            getattr(other.fmu, put)(getattr(raw.fmu, get)())
        (message,) = exchange.logged + steps.logged  # FMPy has one logger for all units of FMI 2.0
        assert "none of co-simulation" in message
        del exchange.logged[:], steps.logged[:]
    stored = getattr(steps.fmu, get)()
    assert steps.call("Reset") == OK
    getattr(steps.fmu, put)(stored)  # with its mode, its time and the stop time
    assert (steps.get("time"), steps.step(0.25, 0.25), steps.step(0.5, 0.1)) == (0.25, OK, ERROR)
    getattr(steps.fmu, put)(early)
    assert steps.initialise() == OK


@pytest.mark.parametrize("version", VERSIONS)
def test_functions_of_time_are_smooth_until_the_event(version: int, tmp_path: Path) -> None:
    """A force that jumps at 0.125 s does so in event mode, and nowhere else."""
    raw = Raw(version, True, tmp_path, JUMP)
    assert raw.initialise() == OK
    assert raw.event() == OK

    def acceleration(t: float) -> float:
        assert raw.call("SetTime", REAL(t)) == OK
        return raw.get("der(rod.phidot)")

    at_start = acceleration(0.0)
    assert raw.call("EnterContinuousTimeMode") == OK
    assert acceleration(np.nextafter(0.125, 0.0)) == acceleration(0.125) == at_start
    assert raw.call("EnterEventMode") == OK
    assert abs(acceleration(0.125) - at_start) > 1.0
    assert raw.event() == OK
    assert raw.call("EnterContinuousTimeMode") == OK
    assert abs(acceleration(0.125) - at_start) > 1.0
