"""`build` mentions a beam whose frame and shapes make it lose its stiffness at a lower spin than it should."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from steady_spin import beam_of

from conftest import ROOT
from derive.cli.build_notes import build_notes
from derive.notes.spin_limit import spin_limits, spin_notes
from derive.pipeline import build
from derive.spec.model.beam_parts import AttachedMass, AxialDeformation
from derive.spec.model.quantity import Parameter
from derive.spec.parsing.values import shape

MIDPOINT = {"kind": "point", "at": 0}
BEAM = """
name = "rod"
[beam]
ansatz = ["1", "xi", "xi^2", "xi^3", "xi^4", "xi^5"]
frame = { kind = "point", at = 0 }
"""


def test_it_states_the_spin_that_is_lost_with_these_shapes_and_with_two(tmp_path: Path) -> None:
    path = tmp_path / "rod.toml"
    path.write_text(BEAM)
    (note,) = (note for note in build_notes(build(path), path) if "loses its stiffness" in note)
    assert note == (
        "rod: to first order in its point frame, a free beam with these 4 shapes loses its stiffness at a spin of "
        "21.21 sqrt(EI/(m l^3)), with the first 2 at 26.83; in the mean frame at its first natural frequency, 22.56; "
        "with order = 2 it stiffens"
    )


@pytest.mark.parametrize(
    ("shapes", "frame", "order"),
    [(6, "mean", 1), (6, "chord", 1), (2, MIDPOINT, 1), (3, MIDPOINT, 1), (4, MIDPOINT, 2)],
)
def test_it_says_nothing_where_the_frame_lowers_no_limit(shapes: int, frame: Any, order: int) -> None:
    """The midpoint frame with three shapes is still as good as the mean frame: what is lost begins with xi^5."""
    assert spin_notes(beam_of(shapes, frame, order)) == ()


def test_attached_masses_damping_and_stretching_leave_the_limit_of_the_beam() -> None:
    plain = beam_of(4, MIDPOINT, 1)
    mass = AttachedMass("tip", Fraction(1), Parameter("mt", "kg", 0.3), Fraction(0))
    axial = AxialDeformation((shape("xi"),), Parameter("EA", "N", 1e3), Fraction(0))
    assert spin_limits(replace(plain, masses=(mass,), axial=axial)) == spin_limits(plain)


def test_a_scene_has_a_line_for_each_such_beam() -> None:
    path = ROOT / "scenes/spun_up_cantilever.toml"
    (note,) = (note for note in build_notes(build(path), path) if "loses its stiffness" in note)
    assert note.startswith("beam: to first order in its tangent frame, a free beam with these 3 shapes")
    assert "5.604 sqrt(EI/(m l^3)), with the first 2 at 5.606;" in note


def test_the_limit_in_the_mean_frame_is_the_natural_frequency_of_the_free_beam() -> None:
    limits = spin_limits(beam_of(6, "mean", 1))
    assert limits.spins[-1] == pytest.approx(limits.natural_frequency) == pytest.approx(22.37350, abs=1e-5)
    assert spin_limits(beam_of(6, "chord", 1)).natural_frequency == pytest.approx(limits.natural_frequency)
    assert spin_notes(beam_of(6, {"kind": "tangent", "at": -1}, 1))
