"""The shape functions of beams, in the plane and in space, as a picture and as formulas, once for beams that are alike.

The pieces of a beam that is cut have the same shapes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from derive.mechanics.bodies.displacement_fields import displacement_fields
from derive.mechanics.bodies.section_fields import Direction, SectionShape, section_shapes
from derive.report.document.formula import Equation, Name
from derive.report.document.page import Block, Details, EquationBlock, Heading, Paragraph, Picture
from derive.report.notation.beam_functions import SHAPE, beam_function
from derive.report.sections.instance_rows import enumeration_of_instances
from derive.simulation.observables.beams import function_values
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.specification import AnyScene
from derive.visual.shape_chart import ShapePanel, shape_chart

PLACES = np.linspace(-1, 1, 101)
"""The points of a curve."""

LETTERS = {Direction.ALONG_E2: SHAPE, Direction.ALONG_E3: SHAPE, Direction.TORSION: "tau", Direction.AXIAL: "chi"}
OF_PLANE = {1: Direction.AXIAL, 2: Direction.ALONG_E2}
"""The kinds of the shapes of a planar beam by the axis of their displacement."""

UNIT = (
    "Each curve is a shape for the amplitude 1, over ξ from -1 (left end) to 1 (right end); the number beside "
    "it is that of its amplitude. e1, e2 and e3 are the axes of the floating frame, e1 along the undeformed beam."
)
TWIST = " In torsion, the sections turn about the axis by the sum of the shapes with their amplitudes, times 2/l."
CUT = " Of a beam that is divided into pieces, the shapes are those of each piece."

Shapes = tuple[SectionShape, ...]


def beam_shape_picture(spec: PlanarBeam) -> Picture:
    """The picture of the shapes of a planar beam."""
    return _picture(_planar_shapes(spec), "")


def beam_shapes_of_scene(scene: AnyScene) -> tuple[Block, ...]:
    """The shapes of the beams of a scene, once for beams with the same shapes; none if there is no beam."""
    owners: dict[Shapes, list[str]] = {}
    cut = False
    for body in scene.bodies:
        if isinstance(body, BeamBody | SpatialBeam):
            shapes = _planar_shapes(body.beam) if isinstance(body, BeamBody) else section_shapes(body)
            owner = body.piece_of.rod.name if isinstance(body, SpatialBeam) and body.piece_of else body.name
            names = owners.setdefault(shapes, [])
            names += [owner] if owner not in names else []
            cut = cut or body.pieces > 1
    if not owners:
        return ()
    twists = any(shape.direction is Direction.TORSION for shapes in owners for shape in shapes)
    text = f"{UNIT}{TWIST if twists else ''}{CUT if cut else ''}"
    blocks: list[Block] = [Heading("Shape functions", "shapes"), Paragraph((text,))]
    for shapes, names in owners.items():
        whose = enumeration_of_instances(names)
        formulas = Details(f"The {len(shapes)} shape functions of {whose}", (EquationBlock(_equations(shapes)),))
        blocks += [_picture(shapes, whose), formulas]
    return tuple(blocks)


def _planar_shapes(spec: PlanarBeam) -> Shapes:
    return tuple(SectionShape(field.of, OF_PLANE[field.axis]) for field in displacement_fields(spec))


def _equations(shapes: Shapes) -> tuple[Equation, ...]:
    return tuple(
        Equation(Name(LETTERS[shape.direction], below=(str(k),)), beam_function(shape.of))
        for k, shape in enumerate(shapes, 1)
    )


def _picture(shapes: Shapes, whose: str) -> Picture:
    """A panel for each kind of deformation that there is."""
    kinds = [d for d in Direction if any(shape.direction is d for shape in shapes)]
    panels = [ShapePanel(kind.value, tuple(_values(shapes, kind))) for kind in kinds]
    of = f" of {whose}" if whose else ""
    kinds_text = ", ".join(kind.value for kind in kinds)
    return Picture(
        shape_chart(panels, f"Shape functions{of}"), f"Shape functions{of}: {kinds_text}", f"Shape functions{of}"
    )


def _values(shapes: Sequence[SectionShape], kind: Direction) -> list[tuple[int, NDArray[np.float64]]]:
    numbered = [(number, shape) for number, shape in enumerate(shapes, 1) if shape.direction is kind]
    return [(number, function_values(shape.of, PLACES)) for number, shape in numbered]
