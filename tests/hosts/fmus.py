"""Functional mock-up units of the models of these tests, and FMPy, which runs them."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from host_models import EVERYWHERE, LINKAGE, LINKS, PUSHED, STEERED
from numpy.typing import NDArray

import derive
from conftest import ROOT
from derive.export.fmi.binaries import this_platform
from derive.export.fmi.fmu import fmu
from derive.export.host_model import HostModel, host_model
from derive.spec.toml.read import parse

VERSIONS = (2, 3)
LIVING: list[object] = []
"""Instances with a logger: FMPy calls the newest one for all units of FMI 2.0, also where its instance is gone."""
KINDS = ("ModelExchange", "CoSimulation")


def fmpy() -> ModuleType:
    """FMPy, with its validation. Its tests are skipped without it, and fail in CI."""
    if os.environ.get("CI"):
        import fmpy.validation
    else:
        pytest.importorskip("fmpy.validation", reason="FMPy is missing: make test-hosts installs it")
    import fmpy

    return fmpy


@cache
def prepared(text: str) -> HostModel:
    """The model of a specification with derivatives, as units have it."""
    return host_model(parse(text, "given.toml"), sensitivities=True)


@cache
def model_of(name: str) -> HostModel:
    """The model of a specification in the folder `scenes`, or of a pendulum, an arm or a linkage with inputs."""
    given = {"pushed": PUSHED, "steered": STEERED, "linkage": LINKAGE, **EVERYWHERE, **LINKS}
    if name in given:
        return prepared(given[name])
    return host_model(derive.read(ROOT / f"scenes/{name}.toml"), sensitivities=True)


_archives: dict[tuple[str, int], bytes] = {}


def unit(model: HostModel, version: int, folder: Path) -> Path:
    """A file with the unit of a model for this platform."""
    path = folder / f"{model.name}{version}.fmu"
    key = model.manifest.text, version
    if key not in _archives:
        _archives[key] = fmu(model, version, [this_platform()])
    path.write_bytes(_archives[key])
    return path


def simulated(path: Path, kind: str, output: list[str], **options: Any) -> NDArray[np.float64]:
    """The rows (times, outputs) that FMPy computes; whatever the unit logs fails."""
    logged: list[str] = []
    rows = fmpy().simulate_fmu(
        str(path), fmi_type=kind, output=output, logger=lambda *args: logged.append(str(args)), **options
    )
    assert logged == []
    table = np.array([list(row) for row in rows])
    interval = options.get("output_interval")
    return table[:, 1:] if interval is None else table[_regular(table[:, 0], interval), 1:]


def _regular(times: NDArray[np.float64], interval: float) -> NDArray[np.intp]:
    """The rows at multiples of an interval; FMPy adds those of events, after which the state counts."""
    numbers = np.rint(times / interval)
    regular = np.flatnonzero(np.abs(times / interval - numbers) < 1e-6)
    return regular[np.append(np.diff(numbers[regular]) > 0, True)]
