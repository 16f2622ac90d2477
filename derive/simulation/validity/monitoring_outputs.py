"""Axial forces and bending moments of beams as further outputs of a compiled scene: C computes their equilibrium."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, TypeVar

import numpy as np

from derive.simulation.observables.beams import beam_bodies, piece_names
from derive.simulation.validity.loaded_sections import loaded_markers, sections, turned_markers
from derive.spec.model.instances import identifier
from derive.spec.model.markers import MarkerRef
from derive.spec.model.ports import SceneOutput
from derive.spec.model.scene import BeamBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

S = TypeVar("S", bound=AnyScene)

MOMENT_GAP, SHEAR_GAP = "moment_gap", "shear_gap"
"""The outputs of sections."""
MOST_PIECES = 4
"""Pieces of a beam whose axial force is monitored: evenly spaced ones, both ends among them, where there are more."""


@dataclass(frozen=True)
class MonitoredPiece:
    """A piece of a beam, and the outputs that are its axial force: in the middle, and along a lone piece."""

    beam: str
    piece: str
    outputs: tuple[SceneOutput, ...]


def monitored_pieces(scene: AnyScene) -> tuple[MonitoredPiece, ...]:
    """The pieces whose axial force is monitored; their outputs have names that the scene does not use."""
    taken, result = {output.name for output in scene.outputs}, []
    for beam in beam_bodies(scene):
        kinds = ("axial_load", "axial_load_linear", "axial_load_quadratic")[: 3 if beam.pieces == 1 else 1]
        for piece in _watched(beam):
            outputs = tuple(SceneOutput(_name(identifier(k, piece), taken), k, {"component": piece}) for k in kinds)
            result.append(MonitoredPiece(beam.name, piece, outputs))
    return tuple(result)


def monitored_sections(scene: AnyScene) -> dict[tuple[str, Fraction, str], SceneOutput]:
    """The outputs of the moment and the shear force that the shapes miss, by beam, place and kind.

    Moments at the ends that are clamped against rotation, and where something acts within the beam; shear forces at the
    ends that something acts on.
    """
    taken = {output.name for output in scene.outputs}
    result: dict[tuple[str, Fraction, str], SceneOutput] = {}
    if isinstance(scene, SpatialScene) or not beam_bodies(scene):
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
                result[beam.name, marker.at, kind] = SceneOutput(name, kind, section)
    return result


MOST_BEAMS = 30
"""Beams of a scene that are monitored: the vibrations of each involve all bodies, and so does each of its forms."""


def is_monitored(scene: AnyScene) -> bool:
    """Whether the beams of a scene are monitored: there are few enough of them."""
    return len(beam_bodies(scene)) <= MOST_BEAMS


def monitoring_note(scene: AnyScene) -> tuple[str, ...]:
    """A line on beams that are not monitored, if there are any."""
    if is_monitored(scene):
        return ()
    many = f"none of the {len(beam_bodies(scene))} beams is monitored"
    return (f"validity: {many}: it takes time with their third power, and at most {MOST_BEAMS} are",)


def monitoring_outputs(scene: AnyScene) -> tuple[SceneOutput, ...]:
    """All outputs that are monitored, each with one component."""
    if not is_monitored(scene):
        return ()
    of_pieces = (output for piece in monitored_pieces(scene) for output in piece.outputs)
    return (*of_pieces, *monitored_sections(scene).values())


def with_monitors(scene: S) -> S:
    """The scene with the outputs that are monitored behind its own; a scene without beams as it is."""
    changed: Any = scene
    result: S = replace(changed, outputs=(*scene.outputs, *monitoring_outputs(scene)))
    return result


def _name(name: str, taken: set[str]) -> str:
    while name in taken:
        name += "_"
    return name


def _watched(beam: BeamBody) -> Iterator[str]:
    names = piece_names(beam)
    for i in dict.fromkeys(np.linspace(0, len(names) - 1, min(len(names), MOST_PIECES)).round().astype(int)):
        yield names[i]
