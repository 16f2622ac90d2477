"""Axial forces and bending moments of beams as further outputs of a compiled scene: C computes their equilibrium.

Of finite-element bodies there are the loads of forces, torques and springs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, TypeVar

import numpy as np

from derive.simulation.observables.beams import beam_bodies, piece_names
from derive.simulation.validity.bending_planes import bending_planes, spatial_beams
from derive.simulation.validity.loaded_sections import loaded_markers, sections, turned_markers
from derive.simulation.validity.piece_shapes import IN_PLANE
from derive.simulation.validity.spatial_sections import loaded_places, turned_places
from derive.spec.model.beam_pieces import piece_name
from derive.spec.model.instances import identifier
from derive.spec.model.markers import MarkerRef
from derive.spec.model.ports import SceneOutput
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

S = TypeVar("S", bound=AnyScene)

MOMENT_GAP, SHEAR_GAP = "moment_gap", "shear_gap"
"""The outputs of sections."""
ACTING_LOAD, LOAD_NUMBERS = "acting_load", range(1, 7)
"""The outputs of loads on finite-element bodies, and their numbers: three forces and three torques."""
MOST_PIECES = 4
"""Pieces of a beam whose axial force is monitored: evenly spaced ones, both ends among them, where there are more."""


MOST_PIECES_IN_SPACE = 6
"""Beams in space, each piece counted, of a scene whose beams are monitored: more take the compiler long."""
LOADS = ("axial_load", "axial_load_linear", "axial_load_quadratic")


@dataclass(frozen=True)
class MonitoredPiece:
    """A piece of a beam, and the outputs that are the coefficients of its axial force, of xi^0 to xi^2."""

    beam: str
    piece: str
    outputs: tuple[SceneOutput, ...]


def monitored_pieces(scene: AnyScene) -> tuple[MonitoredPiece, ...]:
    """The pieces whose axial force is monitored; their outputs have names that the scene does not use."""
    taken, result = {output.name for output in scene.outputs}, []
    for beam, pieces in _pieces(scene).items():
        for piece in _watched(pieces):
            outputs = tuple(SceneOutput(_name(identifier(k, piece), taken), k, {"component": piece}) for k in LOADS)
            result.append(MonitoredPiece(beam, piece, outputs))
    return tuple(result)


def _pieces(scene: AnyScene) -> dict[str, tuple[str, ...]]:
    """The names of the pieces of each beam."""
    planar = {beam.name: piece_names(beam) for beam in beam_bodies(scene)}
    return planar | {
        beam.name: tuple(piece_name(beam.name, beam.pieces, k) for k in range(beam.pieces))
        for beam in spatial_beams(scene)
    }


def monitored_sections(scene: AnyScene) -> dict[tuple[str, int, Fraction, str], SceneOutput]:
    """The outputs of the moment and the shear force that the shapes miss, by beam, plane, place and kind.

    Moments at the ends that are clamped against rotation, and where something acts within the beam; shear forces at the
    ends that something acts on. A plane is the axis along which the beam deflects; about e1 it twists, and the twisting
    moments at its ends are enough.
    """
    if isinstance(scene, SpatialScene):
        return _sections_in_space(scene)
    taken = {output.name for output in scene.outputs}
    result: dict[tuple[str, int, Fraction, str], SceneOutput] = {}
    if not beam_bodies(scene):
        return result
    every, turned = loaded_markers(scene), turned_markers(scene)
    for beam in beam_bodies(scene):
        loaded = sections(beam, every)
        clamped = [marker for marker in sections(beam, turned) if abs(marker.at) == 1]
        within = [marker for marker in loaded if abs(marker.at) < 1]
        ends = [marker for marker in loaded if abs(marker.at) == 1]
        for kind, markers in ((MOMENT_GAP, (*clamped, *within)), (SHEAR_GAP, ends)):
            for marker in markers:
                name = _name(identifier(kind, beam.name, marker.name), taken)
                section = {"section": MarkerRef(beam.name, marker.name)}
                result[beam.name, IN_PLANE, marker.at, kind] = SceneOutput(name, kind, section)
    return result


def _sections_in_space(scene: SpatialScene) -> dict[tuple[str, int, Fraction, str], SceneOutput]:
    taken = {output.name for output in scene.outputs}
    result: dict[tuple[str, int, Fraction, str], SceneOutput] = {}
    for shapes in bending_planes(scene):
        name, axis = shapes.beam.name, shapes.axis
        loaded, turned = loaded_places(scene, name), turned_places(scene, name)
        ends = {at: m for at, m in turned.items() if abs(at) == 1}
        within = {} if shapes.twists else {at: m for at, m in {**loaded, **turned}.items() if abs(at) < 1}
        moments = {**ends, **within}
        shears = {} if shapes.twists else {at: m for at, m in loaded.items() if abs(at) == 1}
        for kind, places in ((MOMENT_GAP, moments), (SHEAR_GAP, shears)):
            for at, marker in places.items():
                of = _name(identifier(kind, marker.body, marker.marker, str(axis)), taken)
                values = {"section": marker, "axis": axis}
                result[name, axis, at, kind] = SceneOutput(of, kind, values)
    return result


MOST_BEAMS = 30
"""Beams of a scene that are monitored: the vibrations of each involve all bodies, and so does each of its forms."""


def is_monitored(scene: AnyScene) -> bool:
    """Whether the beams of a scene are monitored: there are few enough of them, and in space no loops over bodies."""
    if isinstance(scene, SpatialScene):
        beams = sum(isinstance(body, SpatialBeam) for body in scene.bodies)
        return beams <= MOST_PIECES_IN_SPACE and scene.lowering != "instances"
    return len(beam_bodies(scene)) <= MOST_BEAMS


def monitoring_note(scene: AnyScene) -> tuple[str, ...]:
    """A line on beams that are not monitored, if there are any."""
    if is_monitored(scene) or not (pieces := _pieces(scene)):
        return ()
    if isinstance(scene, SpatialScene):
        if scene.lowering == "instances":
            return ("validity: no beam is monitored: loops over bodies in space do not compute the outputs for it",)
        count = sum(map(len, pieces.values()))
        return (
            f"validity: none of the {count} beams in space, pieces counted, is monitored: it takes the compiler long, "
            f"and at most {MOST_PIECES_IN_SPACE} are",
        )
    many = f"none of the {len(pieces)} beams is monitored"
    return (f"validity: {many}: it takes time with their third power, and at most {MOST_BEAMS} are",)


MOST_LOADED = 6
"""Finite-element bodies of a scene of which the loads are known: they take time with all constraints."""


def loaded_bodies(scene: AnyScene) -> tuple[FlexibleBody, ...]:
    """The finite-element bodies whose loads tell what their modes miss: with a stiffness matrix, in scenes of few."""
    if not isinstance(scene, SpatialScene):
        return ()
    bodies = [body for body in scene.bodies if isinstance(body, FlexibleBody)]
    return tuple(body for body in bodies if body.body.data.stiffness is not None) if len(bodies) <= MOST_LOADED else ()


def acting_loads(scene: AnyScene) -> dict[MarkerRef, tuple[SceneOutput, ...]]:
    """The outputs of the six loads of actions on the markers of `loaded_bodies`; loops over bodies compute none."""
    if not isinstance(scene, SpatialScene):
        return {}
    bodies = {body.name for body in loaded_bodies(scene)}
    taken, actions = {output.name for output in scene.outputs}, (*scene.forces, *scene.torques, *scene.springs)
    markers = dict.fromkeys(m for action in actions for m in scene.markers_of(action) if m.body in bodies)

    def outputs(marker: MarkerRef) -> Iterator[SceneOutput]:
        for number in LOAD_NUMBERS:
            name = _name(identifier(ACTING_LOAD, marker.body, marker.marker, str(number)), taken)
            yield SceneOutput(name, ACTING_LOAD, {"marker": marker, "number": number})

    return {marker: tuple(outputs(marker)) for marker in markers}


def monitoring_outputs(scene: AnyScene) -> tuple[SceneOutput, ...]:
    """All outputs that are monitored, each with one component."""
    in_loops = isinstance(scene, SpatialScene) and scene.lowering == "instances"
    of_bodies = [output for outputs in acting_loads(scene).values() for output in outputs if not in_loops]
    if not is_monitored(scene):
        return tuple(of_bodies)
    of_pieces = (output for piece in monitored_pieces(scene) for output in piece.outputs)
    return (*of_pieces, *monitored_sections(scene).values(), *of_bodies)


def with_monitors(scene: S) -> S:
    """The scene with the outputs that are monitored behind its own."""
    changed: Any = scene
    result: S = replace(changed, outputs=(*scene.outputs, *monitoring_outputs(scene)))
    return result


def _name(name: str, taken: set[str]) -> str:
    while name in taken:
        name += "_"
    return name


def _watched(names: Sequence[str]) -> Iterator[str]:
    for i in dict.fromkeys(np.linspace(0, len(names) - 1, min(len(names), MOST_PIECES)).round().astype(int)):
        yield names[i]
