"""Functional mock-up units of the models of these tests, and FMPy, which runs them."""

from __future__ import annotations

import os
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from derive.export.fmi import fmu
from derive.export.fmi_binaries import this_platform
from derive.export.host_model import HostModel

VERSIONS = (2, 3)
KINDS = ("ModelExchange", "CoSimulation")


def fmpy() -> ModuleType:
    """FMPy, with its validation. Its tests are skipped without it, and fail in CI."""
    if os.environ.get("CI"):
        import fmpy.validation
    else:
        pytest.importorskip("fmpy.validation", reason="FMPy is missing: make test-hosts installs it")
    import fmpy

    return fmpy


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
    return np.array([list(row) for row in rows])[:, 1:]
