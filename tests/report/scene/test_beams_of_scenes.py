"""Pages of scenes list what is on a beam in space: attached masses, distributed loads, its second order."""

from __future__ import annotations

from typing import Any

import pytest

import derive
from derive.report.document.page import EquationBlock, Heading
from derive.report.sections.body_values import body_values, section_mass_blocks
from derive.report.sections.loads import load_blocks
from derive.report.sections.second_order import scene_second_order_blocks
from derive.spec.model.beam_pieces import in_pieces

ROD: dict[str, Any] = {
    "length": 2,
    "mass": 3,
    "bending_stiffness": 100,
    "lateral": {"bending_stiffness": 20},
    "rotary_inertia": "1/1000",
    "torsion": {"ansatz": ["xi"], "stiffness": 10},
    "ansatz": ["1", "xi", "xi^2"],
    "damping": {"ratio": 0.01},
    "masses": {"tip": {"at": 1, "mass": 0.5, "inertia": [0.01, 0.02, 0.02, 0, 0.001, 0], "centre": [0.1, 0, 0]}},
    "loads": {"wind": {"force": [0, "10*xi^2 - 10", 1], "torque": ["2*xi", 0, 0], "time": "sin(t)", "frame": "body"}},
}


def scene(**changes: Any) -> Any:
    """A free rod, in pieces if it is cut."""
    return in_pieces(derive.spatial_scene("free", bodies={"rod": ROD | changes}))


@pytest.mark.parametrize("pieces", [1, 2])
def test_masses_and_loads_are_listed_once(pieces: int) -> None:
    """Every entry of a mass and every component of a load is there, once for all pieces."""
    of = scene(pieces=pieces)
    masses, loads = str(section_mass_blocks(of)).replace("\\xa0", " "), str(load_blocks(of))
    assert masses.count("0.5 kg") == 1
    assert "Jxx = 0.01 kg m²" in masses
    assert "Jxz = 0.001 kg m²" in masses
    assert "[0.1, 0, 0] m" in masses
    assert loads.count("rod, [0, 10 ξ² - 10, 1] N/m and [2 ξ, 0, 0] N m/m in the body frame, times sin(t)") == 1
    assert "damping ratio 0.01" in body_values(of.bodies[0]).replace("\xa0", " ")


def test_second_order_of_a_beam_in_space() -> None:
    """The fields of sections, their rotation s and, where the stiffnesses differ, the energy of third order."""
    assert scene_second_order_blocks(scene()) == ()
    coupled = scene_second_order_blocks(scene(order=2))
    assert sum(isinstance(block, Heading) for block in coupled) == 1
    equations = [row for block in coupled if isinstance(block, EquationBlock) for row in block.rows]
    alike = scene_second_order_blocks(scene(order=2, lateral={"bending_stiffness": 100}))
    assert len(equations) == len([r for block in alike if isinstance(block, EquationBlock) for r in block.rows]) + 1
