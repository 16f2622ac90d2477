"""The surroundings of a beam as its monitors see them, in the plane and in each plane of a beam in space."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from derive.simulation.observables.motion import planar, si_value
from derive.simulation.validity.bending_planes import spatial_beams
from derive.simulation.validity.loaded_sections import free_ends, held_ends
from derive.simulation.validity.monitoring_outputs import monitored_pieces, monitored_sections
from derive.simulation.validity.piece_shapes import PieceShapes
from derive.simulation.validity.spatial_sections import held_in_plane, loaded_places
from derive.spec.model.beam_parts import AttachedMass
from derive.spec.model.beam_pieces import piece_of, place_in_piece
from derive.spec.model.spatial_beam_parts import SpatialAttachedMass
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene


@dataclass(frozen=True)
class Surroundings:
    """The ends of a beam, and the outputs that monitor it.

    held: the ends at which a torque can act on it; free: whether it bends, and nothing acts on the left and on the
    right end. gaps: the outputs of what the shapes miss, by the place xi and the kind. axial: those of the axial force
    of pieces, which torsion has nothing to do with. masses: the attached ones, kg, with their pieces and places there.
    """

    held: tuple[int, ...]
    free: tuple[bool, bool]
    gaps: Mapping[tuple[Fraction, str], str]
    axial: Mapping[str, tuple[str, ...]]
    masses: tuple[tuple[int, float, float], ...]


def surroundings(scene: AnyScene, shapes: PieceShapes) -> Surroundings:
    """The surroundings of a beam in one of the planes in which it bends."""
    beam = shapes.beam
    masses: Sequence[AttachedMass | SpatialAttachedMass]
    if isinstance(scene, SpatialScene):
        held = tuple(int(at) for at in held_in_plane(scene, beam.name, shapes.axis))
        masses = next(of.masses for of in spatial_beams(scene) if of.name == beam.name)
        loaded = {*loaded_places(scene, beam.name)} | {mass.at for mass in masses}
        free = (not shapes.twists and Fraction(-1) not in loaded, not shapes.twists and Fraction(1) not in loaded)
    else:
        masses = beam.beam.masses
        held = tuple(int(marker.at) for marker in held_ends(planar(scene), beam))
        free = free_ends(planar(scene), beam)
    gaps = {
        (at, kind): output.name
        for (name, axis, at, kind), output in monitored_sections(scene).items()
        if (name, axis) == (beam.name, shapes.axis)
    }
    axial = {
        of.piece: tuple(output.name for output in of.outputs)
        for of in monitored_pieces(scene)
        if of.beam == beam.name and not shapes.twists
    }
    n = beam.pieces
    attached = ((piece_of(m.at, n), float(place_in_piece(m.at, n)), si_value(m.mass)) for m in masses)
    return Surroundings(held, free, gaps, axial, tuple(attached))
