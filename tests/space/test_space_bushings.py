"""Bushings in space with matrices of stiffness and damping: against the oracle, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from space_kernels import disagreements, space_model

from derive.errors import SpecError
from derive.mechanics.multibody.space.springs import bushing_unit
from derive.simulation.prepared_run import PreparedRun
from derive.spec.as_tables import specification_tables
from derive.spec.construction.scenes import spatial_scene
from derive.spec.toml.read import parse

SCENE = """
name = "mounted"
[scene]
gravity = [0.3, 0.5, -9.81]
[ground.markers]
wall = { at = [0.1, 0, 0], rotation = { angles = [0.2, 0.5, -0.1], sequence = "xyz" } }
[bodies.engine]
mass = 1.2
centre = [0.2, 0.01, 0]
inertia = [1e-2, 4e-2, 4e-2, 1e-3, 0, 2e-3]
markers = { mount = { at = [0, 0.02, 0], rotation = { angles = [0.4, 0, 0.3], sequence = "zxz" } } }
[springs.mount]
kind = "bushing"
between = ["ground.wall", "engine.mount"]
stiffness = STIFFNESS
damping = DAMPING
[outputs.E]
kind = "energy"
[simulation]
duration = 0.3
output = 0.01
tolerance = 1e-10
"""


def matrix(seed: int, size: float) -> list[list[float]]:
    """A symmetric matrix that is positive definite, of decimal numbers."""
    half = np.random.default_rng(seed).uniform(-1, 1, (6, 6))
    return np.round(size * (half @ half.T + np.eye(6)), 3).tolist()


STIFFNESS, DAMPING = matrix(1, 40.0), matrix(2, 0.2)
SIX = [30.0, 20.0, 40.0, 1.0, 2.0, 3.0]


def text(stiffness: object = STIFFNESS, damping: object = DAMPING) -> str:
    """The scene with this stiffness and damping."""
    return SCENE.replace("STIFFNESS", str(stiffness)).replace("DAMPING", str(damping))


@pytest.mark.parametrize(
    "damping", [pytest.param(DAMPING, marks=pytest.mark.long), SIX], ids=["matrices", "a matrix and six numbers"]
)
def test_generated_code_is_that_of_the_oracle(damping: object, tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(text(damping=damping))
    model = space_model(path, complete=False)
    assert disagreements(model, 1) == [] and disagreements(model, 2) == []


def test_six_numbers_are_a_diagonal_matrix_and_parameters_are_entries() -> None:
    zero = [0.0] * 6
    runs = []
    symbol = "{ symbol = 'k', default = 30.0 }"
    for stiffness in (SIX, np.diag(SIX).tolist(), f"[{symbol}, 20, 40, 1, 2, 3]", _with_symbol(symbol)):
        runs.append(PreparedRun(parse(text(stiffness, zero)), complete=False).trajectory())
    for run in runs:
        assert run["E_strain"] == pytest.approx(runs[0]["E_strain"], abs=1e-9)
        assert np.ptp(run["E_total"]) < 1e-8
    assert [tuple(run.motion.native.parameters) for run in runs] == [(), (), ("k",), ("k",)]


def _with_symbol(symbol: str) -> str:
    return str(np.diag(SIX).tolist()).replace("30.0", symbol, 1)


def test_matrices_are_written_back() -> None:
    scene = parse(text())
    assert spatial_scene(specification_tables(scene)) == scene


TWO = "[{ symbol = 'k', default = 30.0 }, 20, 40, { symbol = 'c', default = 1.5, unit = 'kNm' }, 2, 3]"


def test_parameters_have_units_and_are_written_back() -> None:
    scene = parse(text(TWO, _with_symbol("{ symbol = 'd', default = 0.4 }")))
    stiffness, damping = (scene.springs[0].values[key] for key in ("stiffness", "damping"))
    assert (stiffness[0].unit, stiffness[3].unit, damping[0][0].unit) == ("N/m", "kNm", "N s/m")
    assert spatial_scene(specification_tables(scene)) == scene
    assert [[bushing_unit("stiffness", i, j) for j in (1, 5)] for i in (0, 4)] == [["N/m", "N"], ["N", "N m/rad"]]


def test_symbols_of_parameters_are_unique() -> None:
    taken = text(TWO).replace("mass = 1.2", "mass = { symbol = 'k', default = 1.2 }").replace("'c'", "'engine_c1'")
    with pytest.raises(SpecError) as caught:
        parse(taken)
    first, second = str(caught.value).splitlines()
    assert 'stiffness[0].symbol: "k" is the symbol of mass of the body engine, with the unit kg, not N/m' in first
    assert 'stiffness[3].symbol: "engine_c1" is taken: it is a coordinate' in second


def _changed(i: int, j: int, value: float) -> list[list[float]]:
    result = [list(row) for row in STIFFNESS]
    result[i][j] = value
    return result


@pytest.mark.parametrize(
    ("stiffness", "message"),
    [
        (_changed(1, 3, 5.0), r"entries of y, rx and of rx, y are 5 and .* a symmetric matrix is needed"),
        (_changed(2, 2, -1.0), r"not positive semidefinite: the motion .*z 1.* would supply energy"),
        (STIFFNESS[:5], "a list of 6 rows is needed"),
        ([*STIFFNESS[:5], [1.0]], "a list of 6 numbers is needed"),
        ([1, 2, 3, 4, -5, 6], "that of ry is -5; zero or a positive number is needed"),
        ([1, 2, 3], "a list of 6 numbers is needed"),
    ],
)
def test_other_matrices_are_refused(stiffness: object, message: str) -> None:
    with pytest.raises(SpecError, match=message):
        parse(text(stiffness))
    with pytest.raises(SpecError, match=message):
        parse(text(damping=stiffness))
