"""A scene displaced along a mode, and its lines in a motion, for pictures and animations."""

from __future__ import annotations

import numpy as np

from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.constraints.projection import project
from derive.simulation.linear.eigenmodes import Mode
from derive.simulation.linear.modes import Modes
from derive.simulation.observables.beams import beam_bodies, deflections, half_length, piece_names
from derive.simulation.observables.motion import Array, SceneMotion, marker_positions, outline, transformed
from derive.spec.model.scene import BeamBody, Scene

DISPLACEMENT = 0.1
"""The largest displacement of a point of a displaced scene, in sizes of the scene."""
PROBE = 1e-6
"""The amplitude from which the displacements of points are extrapolated."""
POINTS = 17
"""Points of the line of a piece of a beam."""


def displaced(modes: Modes, mode: Mode, phases: Vector) -> SceneMotion:
    """A scene at the phases (n,), rad, of a mode: the states q + a Re(shape exp(i phase)), at the time of the state.

    The amplitude a gives some point a displacement of DISPLACEMENT at most. The states are projected onto the
    constraints, which the displacements meet to first order.
    """
    linear = modes.linear
    probes = [linear.q, linear.q + PROBE * mode.shape.real, linear.q + PROBE * mode.shape.imag]
    before, *after = np.concatenate(scene_lines(scene_motion(modes, probes)), axis=1)
    largest = float(np.sqrt(sum((points - before) ** 2 for points in after).sum(axis=1).max(initial=0.0)))
    size = float(np.ptp(before, axis=0).max(initial=0.0)) or 1.0
    amplitude = PROBE * DISPLACEMENT * size / largest if largest else 0.0
    states = [linear.q + amplitude * (mode.shape * np.exp(1j * phase)).real for phase in phases]
    rest = np.zeros(modes.native.nv)
    return scene_motion(modes, [project(_native(modes), modes.k, linear.t, q, rest)[0] for q in states])


def scene_motion(modes: Modes, states: list[Vector]) -> SceneMotion:
    """States (nq,) of a scene at the time of the linearisation, at rest."""
    assert isinstance(modes.spec, Scene)
    q = np.array(states)
    return SceneMotion(modes.spec, _native(modes), modes.k, np.full(len(q), modes.linear.t), q, np.zeros_like(q))


def _native(modes: Modes) -> NativeScene:
    assert isinstance(modes.native, NativeScene)
    return modes.native


def scene_lines(motion: SceneMotion) -> list[Array]:
    """The lines (n, points, 2), m, of all bodies and springs of a scene at its n instants.

    Of a beam the deformed axis; of another body the hull of its markers, closed, which may be one point; of a spring
    the line between its ends.
    """
    lines: list[Array] = []
    xi = np.linspace(-1.0, 1.0, POINTS)
    for beam in beam_bodies(motion.scene):
        half, points = half_length(beam), []
        for piece in piece_names(beam):
            for x, y in zip(xi * half, deflections(motion, beam, piece, xi).T, strict=True):
                points.append(transformed(motion.pose(piece), np.stack([np.full_like(y, x), y], axis=1)))
        lines.append(np.stack(points, axis=1))
    for body in motion.scene.bodies:
        if not isinstance(body, BeamBody) and (corners := outline(body)):
            points = [transformed(motion.pose(body.name), np.array(corner)) for corner in (*corners, corners[0])]
            lines.append(np.stack(points, axis=1))
    for spring in motion.scene.springs:
        lines.append(np.stack([marker_positions(motion, end) for end in spring.markers], axis=1))
    return lines
