"""The axial forces of beams as further outputs of a compiled scene, so that C computes them from equilibrium."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from derive.runtime.native_call import Matrix, Vector
from derive.simulation.observables.beams import beam_bodies, piece_names
from derive.simulation.observables.motion import SceneMotion
from derive.spec.model.ports import SceneOutput
from derive.spec.model.scene import BeamBody, Scene

MOST_PIECES = 4
"""Pieces of a beam whose axial force is monitored: evenly spaced ones, both ends among them, where there are more."""


@dataclass(frozen=True)
class MonitoredPiece:
    """A piece of a beam, and the output that is its axial force."""

    beam: str
    piece: str
    output: SceneOutput


def monitored_pieces(scene: Scene) -> tuple[MonitoredPiece, ...]:
    """The pieces whose axial force is monitored; their outputs have names that the scene does not use."""
    taken, result = {output.name for output in scene.outputs}, []
    for beam in beam_bodies(scene):
        for piece in _watched(beam):
            name = f"axial_load_{piece}"
            while name in taken:
                name += "_"
            result.append(MonitoredPiece(beam.name, piece, SceneOutput(name, "axial_load", {"component": piece})))
    return tuple(result)


def with_monitors(scene: Scene) -> Scene:
    """The scene with the outputs that are monitored behind its own; a scene without beams as it is."""
    return replace(scene, outputs=(*scene.outputs, *(m.output for m in monitored_pieces(scene))))


def _watched(beam: BeamBody) -> Iterator[str]:
    names = piece_names(beam)
    for i in dict.fromkeys(np.linspace(0, len(names) - 1, min(len(names), MOST_PIECES)).round().astype(int)):
        yield names[i]


@dataclass(frozen=True, eq=False)
class AxialLoads:
    """The axial forces (n,), N, in the middle of the monitored pieces by their names, and the accelerations (n, nv)."""

    forces: dict[str, Vector]
    accelerations: Matrix


def axial_loads(motion: SceneMotion) -> AxialLoads:
    """The axial forces of a motion, whose scene was compiled with the outputs of `with_monitors`."""
    native, k = motion.native, motion.k
    pieces = monitored_pieces(motion.scene)
    columns = [native.outputs.index(m.output.name) for m in pieces]
    forces, accelerations = np.empty((len(motion.t), len(pieces))), np.empty((len(motion.t), native.nv))
    for i, (time, q, v) in enumerate(zip(motion.t, motion.q, motion.v, strict=True)):
        vdot, multipliers = native.solve(float(time), q, v, k)
        accelerations[i] = vdot
        if motion.outputs is not None:
            forces[i] = motion.outputs[i, columns]
            continue
        forces[i] = native.evaluate_outputs(float(time), q, v, vdot, multipliers, k)[columns]
    return AxialLoads({m.piece: forces[:, j] for j, m in enumerate(pieces)}, accelerations)
