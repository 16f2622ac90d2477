"""Bodies whose motion is prescribed: energies and powers count the mass and inertia given, and say what is missing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from derive.cli.main import main
from derive.spec.toml.read import parse
from explicit_motion import moved

CRANK = """
name = "driven"
ground.markers = { o = [0, 0] }
scene.gravity = [0, -10]
[bodies.crank]
GIVEN
centre = [0.3, 0]
markers = { hub = [0, 0], pin = [0.5, 0] }
[bodies.rod]
mass = 0.5
inertia = 0.04
markers = { left = [-0.5, 0] }
[joints.bearing]
kind = "revolute"
between = ["ground.o", "crank.hub"]
[joints.pin]
kind = "revolute"
between = ["crank.pin", "rod.left"]
[drives.motor]
joint = "bearing"
motion = "2*t + t^2"
[simulation]
duration = 0.1
output = 1e-3
tolerance = 1e-11
"""
OUTPUTS = '[outputs.e]\nkind = "energy"\n[outputs.p]\nkind = "power"\n'
AS_ZERO = (
    "not given -> 0 in energies, powers, reactions and forces of drives; its motion is prescribed and does not depend "
    "on them"
)


@pytest.mark.parametrize(
    ("given", "missing"),
    [("mass = 2\ninertia = 0.7", ""), ("mass = 2", "inertia"), ("inertia = 0.7", "mass"), ("", "mass and inertia")],
)
def test_what_is_not_given_counts_as_zero_and_powers_balance(given: str, missing: str) -> None:
    run = moved(parse(CRANK.replace("GIVEN", given) + OUTPUTS))
    assert run.notes == ((f"crank: {missing}: {AS_ZERO}",) if missing else ())
    mass, inertia = 2.0 * ("mass =" in given), 0.7 * ("inertia =" in given)
    angle, spin = run.t * (2 + run.t), 2 + 2 * run.t
    without = moved(parse(CRANK.replace("GIVEN", "") + OUTPUTS))
    kinetic = 0.5 * (mass * 0.3**2 + inertia) * spin**2
    np.testing.assert_allclose(run["e_kinetic"] - without["e_kinetic"], kinetic, rtol=0, atol=1e-8)
    potential = mass * 10 * 0.3 * np.sin(angle)
    np.testing.assert_allclose(run["e_gravity"] - without["e_gravity"], potential, rtol=0, atol=1e-8)
    rate = (run["e_total"][2:] - run["e_total"][:-2]) / 2e-3
    power = run["p_loads"] + run["p_drives"] + run["p_dissipated"]
    np.testing.assert_allclose(rate, power[1:-1], rtol=0, atol=1e-4 * np.abs(power).max())


def test_build_and_simulate_say_it_where_an_output_counts_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    spec = tmp_path / "driven.toml"
    for text, count in (
        (CRANK, 0),
        (CRANK + '[outputs.x]\nkind = "position"\nmarker = "rod.left"\n', 0),
        (CRANK + OUTPUTS, 1),
    ):
        spec.write_text(text.replace("GIVEN", "mass = 2"))
        for command in ("build", "simulate"):
            assert main([command, str(spec), "--out", str(tmp_path / "out")]) == 0
            assert capsys.readouterr().out.count(f"crank: inertia: {AS_ZERO}") == count, command
