"""The planes in which the beams of a scene bend: each beam in the plane once, each beam in space twice.

A beam in space bends along its e2 and e3. To first order each of these is the deflection of a planar beam with its own
shapes and stiffness, whose amplitudes follow each other among those of the body. Its torsion is a third one, of which a
planar beam that stretches has the shapes: see `PieceShapes`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from derive.mechanics.bodies.section_fields import Direction, section_shapes
from derive.simulation.observables.beams import beam_bodies
from derive.simulation.validity.piece_shapes import TWIST, PieceShapes
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import AssumedDeflection, AxialDeformation
from derive.spec.model.beam_pieces import whole_beam
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.quantity import Quantity
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.specification import AnyScene

PLANES = {2: Direction.ALONG_E2, 3: Direction.ALONG_E3}
"""The deflections of a beam in space by their axes."""


def bending_planes(scene: AnyScene) -> tuple[PieceShapes, ...]:
    """The shapes of each beam in each plane in which it bends; those of its torsion, if it twists, follow."""
    planar = (PieceShapes(beam) for beam in beam_bodies(scene))
    return (*planar, *(shapes for beam in spatial_beams(scene) for shapes in _planes(beam)))


def spatial_beams(scene: AnyScene) -> tuple[SpatialBeam, ...]:
    """The beams of a scene in space, those in pieces as a whole."""
    beams = (whole_beam(body) for body in scene.bodies if isinstance(body, SpatialBeam))
    return tuple({beam.name: beam for beam in beams}.values())


def _planes(beam: SpatialBeam) -> Iterator[PieceShapes]:
    every = section_shapes(beam)
    for (axis, direction), of, stiffness in zip(
        PLANES.items(), beam.deflections, beam.bending_stiffnesses, strict=True
    ):
        own = [i for i, shape in enumerate(every) if shape.direction is direction]
        if own:
            yield PieceShapes(BeamBody(beam.name, _planar(beam, of, stiffness), beam.pieces), own[0], axis)
    if beam.torsion is not None:
        twisted = AxialDeformation(beam.torsion.ansatz, beam.torsion.stiffness)
        like = replace(_planar(beam, beam.deflections[0], beam.torsion.stiffness), axial=twisted)
        before = [shape.direction for shape in every].index(Direction.TORSION)
        yield PieceShapes(BeamBody(beam.name, like, beam.pieces), before, TWIST)


def _planar(beam: SpatialBeam, of: AssumedDeflection, stiffness: Quantity) -> PlanarBeam:
    """The planar beam with a deflection and a stiffness of a beam in space."""
    return PlanarBeam(
        name=beam.name,
        ansatz=of.ansatz,
        frame=of.frame,
        mass=beam.mass,
        length=beam.length,
        bending_stiffness=stiffness,
        markers=(),
        orthogonal=of.orthogonal,
        ends=of.ends,
        order=beam.order,
    )
