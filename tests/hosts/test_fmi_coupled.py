"""Two units that exchange a motion and a torque move as one scene of both bodies."""

from __future__ import annotations

import importlib.util

import pytest
from fmus import fmpy

from conftest import ROOT

pytestmark = pytest.mark.hosts


def test_coupled_units_move_as_one_scene() -> None:
    fmpy()
    spec = importlib.util.spec_from_file_location("coupled_units", ROOT / "examples/hosts/coupled_units.py")
    assert spec is not None and spec.loader is not None
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    assert example.main() < 1e-7  # m; that of the Runge-Kutta steps
