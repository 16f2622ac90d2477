"""Warnings on specifications: units that do not fit, and defaults of masses and the like."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from conftest import ROOT
from derive.cli.main import main
from derive.notes.conditioning import condition_warnings, shape_condition
from derive.spec.construction.bodies import planar_beam
from derive.spec.parsing.units import UnknownUnit, unit_size
from derive.spec.toml.read import warnings


@pytest.mark.parametrize(
    ("text", "scale", "dimension"),
    [
        ("kg", 1, (0, 1, 0)),
        ("g", 1e-3, (0, 1, 0)),
        ("N m^2", 1, (3, 1, -2)),
        ("kN*mm^2", 1e-3, (3, 1, -2)),
        ("kg/(m s^2)", 1, (-1, 1, -2)),
        ("N m s/rad", 1, (2, 1, -1)),
        ("kg m^2 s^-2", 1, (2, 1, -2)),
        ("m/s**2", 1, (1, 0, -2)),
        ("1/min", 1 / 60, (0, 0, -1)),
        ("lbf s^2/in", 175.12683524647636, (0, 1, 0)),
        ("t", 1000, (0, 1, 0)),
        ("ms", 1e-3, (0, 0, 1)),
    ],
)
def test_units(text: str, scale: float, dimension: tuple[int, int, int]) -> None:
    size = unit_size(text)
    assert size.scale == pytest.approx(scale, rel=1e-12) and size.dimension == dimension


@pytest.mark.parametrize(
    "text", ["", "stone", "kg m)", "(kg", "kg^", "kg^m", "/s", "kg^-", "m^999", "2 kg", "m$", "kkg"]
)
def test_texts_that_are_no_units(text: str) -> None:
    with pytest.raises(UnknownUnit):
        unit_size(text)


SCENE = """\
name = "s"
[scene]
gravity = [0, { symbol = "gy", unit = "m/s^2", default = -9.81 }]
[bodies.rod]
mass = { symbol = "m", unit = "g", default = 500 }
bending_stiffness = { symbol = "EI", unit = "N m^2", default = 3 }
[bodies.ball]
mass = { symbol = "mb", unit = "m", default = 2 }
inertia = { symbol = "J", unit = "pint" }
[simulation]
duration = 0.01
output = 0.01
"""
SCENE_WARNINGS = [
    ":4: bodies.rod.length: no length is given, so that it is the parameter l, 1 m by default; write length = 1.0",
    ':5: bodies.rod.mass.unit: the unit "g" is 0.001 kg, and values enter the equations as they are, beside others '
    'in SI units; write unit = "kg" and convert the default',
    ':8: bodies.ball.mass.unit: the unit "m" does not fit: the equations need "kg"',
    ':9: bodies.ball.inertia.unit: the unit "pint" is unknown and not checked; in SI units it is "kg m^2"',
    ":9: bodies.ball.inertia: the parameter J has no default, and gets 1 kg m^2",
]


def test_build_and_simulate_print_the_warnings(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = tmp_path / "s.toml"
    spec.write_text(SCENE)
    assert list(warnings(spec)) == [f"{spec}{text}" for text in SCENE_WARNINGS]
    for command in ("build", "simulate"):
        assert main([command, str(spec), "--out", str(tmp_path / "out")]) == 0
        lines = [line.strip() for line in capsys.readouterr().out.splitlines()]
        assert [line for line in lines if "warning" in line] == [f"warning: {spec}{text}" for text in SCENE_WARNINGS]


def test_a_value_that_is_set_is_no_default(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = tmp_path / "s.toml"
    spec.write_text(SCENE)
    found = warnings(spec, ["bodies.rod.length", "bodies.ball.inertia"])
    assert list(found) == [f"{spec}{text}" for text in SCENE_WARNINGS[1:4]]
    arguments = ["--set", "bodies.rod.length=2", "--set", "J=3", "--json", "--out", str(tmp_path / "out")]
    assert main(["simulate", str(spec), *arguments]) == 0
    assert json.loads(capsys.readouterr().out)["warnings"] == list(found)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("[beam]\nlength = 1\nbending_stiffness = 2", ["2: beam.mass: no mass is given"]),
        (
            '[beam]\nmass = 1\nlength = { symbol = "L", unit = "mm", default = 9 }\nbending_stiffness = 2',
            ["4: beam.length"],
        ),
        ("[beam]\nmass = 1\nlength = 1\nbending_stiffness = 2", []),
        (
            '[body]\nintegrals = "symbolic"\nmodes = 2\ngravity = [0, 0, { symbol = "G", unit = "m/s", default = 1 }]',
            ['5: body.gravity[2].unit: the unit "m/s" does not fit'],
        ),
    ],
)
def test_warnings_on_a_single_body(text: str, expected: list[str], tmp_path: Path) -> None:
    spec = tmp_path / "b.toml"
    spec.write_text(f'name = "b"\n{text}\n')
    found = [line.removeprefix(f"{spec}:") for line in warnings(spec)]
    assert len(found) == len(expected)
    assert all(line.startswith(start) for line, start in zip(found, expected, strict=True))


@pytest.mark.parametrize(("shapes", "warned"), [(8, False), (10, False), (12, True), (18, True)])
def test_monomials_that_are_nearly_dependent_are_warned_of(shapes: int, warned: bool) -> None:
    """Their mass matrix is one of Hilbert's, whose condition grows by a factor of about 35 with two shapes."""
    ansatz = ["1", "xi", *(f"xi^{k}" for k in range(2, shapes + 2))]
    texts = condition_warnings(planar_beam("b", ansatz=ansatz, orthogonal=False))
    assert len(texts) == warned
    assert all("the mass matrix of b has a condition number of " in text for text in texts)


def test_orthogonal_shapes_in_the_mean_frame_have_a_diagonal_mass_matrix() -> None:
    beam = planar_beam("b", ansatz=["1", "xi", "xi^2", "xi^3", "xi^4"])
    assert shape_condition(beam) == pytest.approx(1)
    assert not condition_warnings(beam)


def test_build_prints_the_warning_on_the_condition(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The limit is one that three shapes exceed, so that the model is small."""
    monkeypatch.setattr("derive.notes.conditioning.ILL_CONDITIONED", 10)
    assert main(["build", str(ROOT / "scenes/free_beam_point.toml"), "--out", str(tmp_path)]) == 0
    assert "warning: the mass matrix of free_beam_point has a condition number of 2e+01" in capsys.readouterr().out
