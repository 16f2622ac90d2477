"""A finite-element body of first order that spins fast is noted, from a tenth of its lowest natural frequency."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import derive
from derive.spec.model.simulation import SpatialStart


@pytest.mark.parametrize(("spin", "noted"), [(0.9, False), (1.1, True)])
def test_a_body_that_spins_above_a_tenth_of_its_frequency_is_noted(spin: float, noted: bool) -> None:
    """The square breathes with 10 rad/s; it has its largest moment of inertia about its normal."""
    corners = [[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]]
    breathing = [np.array(corners) / 8**0.5]
    nodes = {"positions": corners, "mass": np.eye(4), "modes": breathing, "modal_stiffness": [[100]]}
    square = derive.nodal_body("square", nodes, units="SI")
    turning = replace(square, start=SpatialStart(angular_velocity=(0.0, 0.0, spin)))
    notes = derive.simulate(turning, duration=0.01, output=0.01).notes
    assert [note for note in notes if "10 rad/s (free)" in note and "centrifugal" in note] == [*notes][: int(noted)]
