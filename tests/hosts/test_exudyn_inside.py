"""bench/exudyn_inside.py: one rod in Tisserand, inside Exudyn and by Exudyn, against an independent reference."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from programs import package, program

from conftest import ROOT

pytestmark = pytest.mark.hosts


@pytest.fixture(scope="module")
def exu() -> ModuleType:
    module = package("exudyn")
    module.config.printToConsole = False
    return module


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "bench"))
    return import_module("exudyn_inside")


def size(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def test_the_reference_is_reproduced(bench: ModuleType) -> None:
    """With fewer polynomials it is nearly that of the file, which states its own error."""
    rod = bench.rod
    few = rod.exact_rod(7, tolerance=1e-7)
    assert rod.error(few) < 2e-5 and rod.uncertainty() < 1e-5
    assert rod.error(np.zeros(rod.ROWS)) > 0.3


def test_our_rod_of_second_order_is_the_exact_one(bench: ModuleType) -> None:
    """The error is 2e-5 of the peak with six shapes; at first order 3 % are missing, whatever the shapes."""
    run = bench.own(6, 2, 1e-8)
    assert bench.rod.error(run.deflection()) < 2.5e-5 and run.seconds() > 0
    assert 0.02 < bench.rod.error(bench.own(4, 1, 1e-8).deflection()) < 0.04


def in_exudyn(bench: ModuleType, exu: ModuleType, build: Callable[[], Any], steps: int, name: str = "") -> np.ndarray:
    run = bench.inside(exu, name, build, steps)
    assert run.seconds() > 0
    return np.asarray(run.deflection())


def test_the_generated_body_is_ours(bench: ModuleType, exu: ModuleType, tmp_path: Path) -> None:
    """Its difference from ours is the error of the trapezoidal rule: a quarter with twice the steps."""
    program("gcc")
    made = bench.exported(6, 2, tmp_path)
    ours = bench.own(6, 2, 1e-8).deflection()
    runs = [in_exudyn(bench, exu, lambda: bench.generated(exu, *made), n, bench.GENERATED) for n in (2000, 4000)]
    off = [size(run - ours) for run in runs]
    assert 3.5 < off[0] / off[1] < 4.5 and off[1] < 1e-4 * np.abs(ours).max()


def test_the_floating_frame_body_is_the_generated_one(bench: ModuleType, exu: ModuleType, tmp_path: Path) -> None:
    """Step by step, up to the tolerance of Newton's method."""
    program("gcc")
    made = bench.exported(4, 1, tmp_path)
    theirs = in_exudyn(bench, exu, lambda: bench.floating_frame(exu, 4), 1000)
    generated = in_exudyn(bench, exu, lambda: bench.generated(exu, *made), 1000, bench.GENERATED)
    assert np.max(np.abs(theirs - generated)) < 1e-6 * np.abs(generated).max()


def test_cables_and_beams_have_the_reference_as_their_limit(bench: ModuleType, exu: ModuleType) -> None:
    errors = [bench.rod.error(in_exudyn(bench, exu, lambda n=n: bench.cables(exu, n), 2000)) for n in (4, 8)]
    assert errors[0] < 1e-3 and errors[1] < 1e-4
    errors = [bench.rod.error(in_exudyn(bench, exu, lambda n=n: bench.beams(exu, n), 2000)) for n in (4, 8)]
    assert 1e-3 < errors[0] < 1e-2 and errors[1] < 2e-4
