"""Notes on finite-element bodies whose modes miss the deformation under the forces of joints, and on no others."""

from __future__ import annotations

from typing import Any

import pytest

import derive
from explicit_motion import moved
from spring_lattice import lattice


@pytest.mark.parametrize(
    ("modes", "noted"),
    [({"component_modes": "free", "modes": 3}, True), ({"component_modes": "craig_bampton", "modes": 3}, False)],
)
def test_modes_of_a_clamped_body(modes: dict[str, Any], noted: bool) -> None:
    """Three free modes of a lattice that a joint fixes miss most of its motion; three of the fixed body suffice."""
    held = {} if noted else {"interface": ["left"]}
    body = {"nodes": lattice(1), "units": "SI", "markers": {"left": {"nodes": [0, 1, 2, 3]}}, **modes, **held}
    scene = derive.spatial_scene(
        "held",
        gravity=[0, 0, -0.1],
        ground={"o": (0, 0, 0)},
        bodies={"truss": body},
        joints={"h": {"kind": "fixed", "between": ["ground.o", "truss.left"]}},
    )
    run = moved(scene, duration=0.5, output=0.05)
    assert any("under the forces of its joints its 3 modes imply" in note for note in run.notes) == noted
    assert any("of its deformation" in note or "in its deformation" in note for note in run.notes) == noted
