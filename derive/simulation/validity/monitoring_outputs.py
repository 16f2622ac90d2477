"""Axial forces and bending moments of beams as further outputs of a compiled scene: C computes their equilibrium."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from derive.simulation.observables.beams import beam_bodies, piece_names, shape_functions
from derive.simulation.validity.end_moments import held_ends, inner_sections
from derive.spec.model.markers import MarkerRef
from derive.spec.model.ports import SceneOutput
from derive.spec.model.scene import BeamBody, Scene

MOST_PIECES = 4
"""Pieces of a beam whose axial force is monitored: evenly spaced ones, both ends among them, where there are more."""


@dataclass(frozen=True)
class MonitoredPiece:
    """A piece of a beam, and its outputs.

    axial: its axial force, in the middle, and along a lone piece. lateral: the accelerations of `LateralInertia` in
    turn; empty of a beam whose bending moment follows from more than its inertia, see `inner_sections`.
    """

    beam: str
    piece: str
    axial: tuple[SceneOutput, ...]
    lateral: tuple[SceneOutput, ...]

    @property
    def outputs(self) -> tuple[SceneOutput, ...]:
        """All outputs."""
        return self.axial + self.lateral


def monitored_pieces(scene: Scene) -> tuple[MonitoredPiece, ...]:
    """The pieces whose forces are monitored; their outputs have names that the scene does not use."""
    taken, result = {output.name for output in scene.outputs}, []
    for beam in beam_bodies(scene):
        kinds = ("axial_load", "axial_load_linear", "axial_load_quadratic")[: 3 if beam.pieces == 1 else 1]
        numbers = range(0 if inner_sections(scene, beam) is None else 2 + len(shape_functions(beam)))
        for piece in _watched(beam):
            own = {"component": piece}
            axial = tuple(SceneOutput(_name(f"{k}_{piece}", taken), k, own) for k in kinds)
            lateral = tuple(
                SceneOutput(_name(f"lateral_inertia_{i}_{piece}", taken), "lateral_inertia", {**own, "number": i})
                for i in numbers
            )
            result.append(MonitoredPiece(beam.name, piece, axial, lateral))
    return tuple(result)


def monitored_sections(scene: Scene) -> dict[tuple[str, Fraction], SceneOutput]:
    """By beam and place, -1 to 1, what the shapes leave of the moment there.

    These are the ends that are held against rotation, and places between the ends at which something acts.
    """
    taken = {output.name for output in scene.outputs}
    return {
        (beam.name, marker.at): SceneOutput(
            _name(f"moment_gap_{beam.name}_{marker.name}", taken),
            "moment_gap",
            {"section": MarkerRef(beam.name, marker.name)},
        )
        for beam in beam_bodies(scene)
        for marker in (*held_ends(scene, beam), *(inner_sections(scene, beam) or ()))
    }


def monitoring_outputs(scene: Scene) -> tuple[SceneOutput, ...]:
    """All outputs that are monitored, each with one component."""
    of_pieces = (output for piece in monitored_pieces(scene) for output in piece.outputs)
    return (*of_pieces, *monitored_sections(scene).values())


def with_monitors(scene: Scene) -> Scene:
    """The scene with the outputs that are monitored behind its own; a scene without beams as it is."""
    return replace(scene, outputs=(*scene.outputs, *monitoring_outputs(scene)))


def _name(name: str, taken: set[str]) -> str:
    while name in taken:
        name += "_"
    return name


def _watched(beam: BeamBody) -> Iterator[str]:
    names = piece_names(beam)
    for i in dict.fromkeys(np.linspace(0, len(names) - 1, min(len(names), MOST_PIECES)).round().astype(int)):
        yield names[i]
