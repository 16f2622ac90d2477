"""A truncated beam of second order that bends too far for its frame is named, and the full one goes on."""

from __future__ import annotations

import pytest

import derive
from derive.simulation.errors import MassMatrixNotDefinite
from explicit_motion import moved

THROWN = """
name = "thrown"

[bodies.rod]
ansatz = ["1", "xi", "xi^2", "xi^3", "xi^4", "xi^5"]
frame = { kind = "tangent", at = -1 }
order = 2
terms = "TERMS"
mass = 1
length = 1
bending_stiffness = 1
markers = { right = 1 }
start = { spin = 1 }

[forces.push]
at = "rod.right"
components = ["0", "2*t"]

[simulation]
duration = 0.5
output = 0.1
"""


def test_a_deflection_that_takes_the_mass_matrix_to_its_limit_is_named(tmp_path) -> None:
    (tmp_path / "thrown.toml").write_text(THROWN.replace("TERMS", "truncated"))
    with pytest.raises(MassMatrixNotDefinite, match='terms = "full"') as raised:
        moved(derive.read(tmp_path / "thrown.toml"))
    assert 0.3 < raised.value.t < 0.5


@pytest.mark.long
def test_the_full_model_goes_on(tmp_path) -> None:
    (tmp_path / "thrown.toml").write_text(THROWN.replace("TERMS", "full"))
    assert moved(derive.read(tmp_path / "thrown.toml"))["t"][-1] == 0.5
