"""The picture of the shape functions of beams in reports: a panel for each kind of deformation."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

import pytest

import derive
from derive.mechanics.bodies.section_fields import section_shapes
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.model_lowering import lowered_form
from derive.report.document.page import Details, Paragraph, Picture
from derive.report.sections.beam_shapes import beam_shape_picture, beam_shapes_of_scene
from derive.report.sections.mechanism import body_blocks
from derive.spec.model.beam_pieces import in_pieces
from derive.spec.model.spatial_beam import SpatialBeam

ROD: dict[str, Any] = {
    "length": 1,
    "mass": 2,
    "bending_stiffness": 100,
    "rotary_inertia": 1e-3,
    "ansatz": ["1", "xi", "xi^2", "xi^3"],
    "torsion": {"ansatz": ["xi"], "stiffness": 10},
}
KINDS = ["deflection along e2", "deflection along e3", "torsion"]


def rods(**others: dict[str, Any]) -> derive.SpatialScene:
    """A scene of a rod and others that differ from it by some keys."""
    return derive.spatial_scene("rods", bodies={"rod": ROD, **{name: {**ROD, **of} for name, of in others.items()}})


def texts(svg: str) -> list[str]:
    """The texts of a picture."""
    return re.findall(r"<text[^>]*>([^<]*)</text>", svg)


def scaled(values: list[float]) -> list[float]:
    """Values between 0 and 1."""
    return [(value - min(values)) / (max(values) - min(values)) for value in values]


def test_the_curves_are_the_shapes_of_both_planes_and_of_torsion() -> None:
    scene = rods()
    (picture,) = (block for block in beam_shapes_of_scene(scene) if isinstance(block, Picture))
    shown = texts(picture.svg)
    assert [text for text in shown if text in KINDS] == KINDS
    (rod,) = scene.bodies
    assert isinstance(rod, SpatialBeam)
    curves = [path for path in re.findall(r'<path d="([^"]*)"', picture.svg) if path.count("L") == 100]
    places = [Fraction(k, 50) - 1 for k in range(101)]
    for shape, curve in zip(section_shapes(rod), curves, strict=True):
        heights = [-float(point.split()[1]) for point in re.split("[ML]", curve)[1:]]
        assert scaled(heights) == pytest.approx(scaled([float(shape.of.at(xi)) for xi in places]), abs=1e-3)


def test_beams_with_the_same_shapes_are_shown_once_and_pieces_as_their_beam() -> None:
    scene = in_pieces(rods(heavy={"mass": 5, "pieces": 2}, chord={"frame": "chord"}))
    blocks = beam_shapes_of_scene(scene)
    captions = [block.caption for block in blocks if isinstance(block, Picture)]
    assert captions == ["Shape functions of rod and heavy", "Shape functions of chord"]
    assert [block.summary for block in blocks if isinstance(block, Details)][1] == "The 5 shape functions of chord"
    assert any(isinstance(block, Paragraph) and "divided into pieces" in str(block.text[0]) for block in blocks)


def test_a_planar_beam_that_stretches_has_two_panels() -> None:
    beam = derive.planar_beam("rod", frame="mean", axial={"ansatz": ["xi"], "stiffness": 100})
    shown = texts(beam_shape_picture(beam).svg)
    assert "displacement along the axis" in shown and KINDS[0] in shown and KINDS[1] not in shown


def test_a_piece_is_described_as_a_part_of_its_beam() -> None:
    derived = derive.derive(rods(arm={"pieces": 2}))
    assert isinstance(derived, SpatialMechanism)
    model = derive.lower(derived, explicit=True)
    described = str(body_blocks(derived.scene, model, lowered_form(derived, model))).replace(r"\xa0", " ")
    assert "piece 2 of 2 of arm, a beam in space" in described and "the whole beam: 2 kg" in described
    assert "torsional stiffness 10 N m²" in described
