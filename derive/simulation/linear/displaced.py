"""A scene displaced along a mode, and its lines in a motion, for pictures and animations."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from derive.roles import Role
from derive.runtime.native_call import Matrix, ModelError, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import constraint_matrix, mass_matrix
from derive.simulation.configurations import displaced as changed
from derive.simulation.configurations import rate_matrix, velocities_with
from derive.simulation.linear.eigenmodes import ComplexVector, Mode
from derive.simulation.linear.modes import Modes
from derive.simulation.linear.run_time_inputs import scene_with_values
from derive.simulation.observables.beams import axis_points, beam_bodies, piece_at, piece_names
from derive.simulation.observables.marker_positions import marker_positions
from derive.simulation.observables.motion import Array, SceneMotion, outline, planar, transformed
from derive.simulation.simulated_scene import FreeBeam, beam_scene
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene
from derive.spec.model.simulation import NOT_GIVEN

DISPLACEMENT = 0.1
"""The largest displacement of a point of a displaced scene, in sizes of the scene."""
ROTATION = 0.2
"""The largest rotation (rad) of a body in an animation: larger ones deform beams, whose axes keep their length."""
NEWTON_STEPS = 6
"""The number of Newton steps by which a displaced scene returns to its constraints."""
MANY_COORDINATES = 100
"""Coordinates of a scene from which on generated code brings displaced states back to the constraints."""
PROBE = 1e-6
"""The amplitude from which the displacements of points are extrapolated."""
POINTS = 17
"""The number of points of the line of a piece of a beam."""


@dataclass(frozen=True, eq=False)
class ModeLines:
    """The lines of a scene (points, 2), m, in its state, and their complex displacements by a mode.

    The lines are those of `scene_lines`. amplitude: the factor of the shape of the mode that gives the displacements,
    the largest of which is DISPLACEMENT.
    """

    lines: list[Array]
    displacements: list[NDArray[np.complex128]]
    amplitude: float


def mode_lines(modes: Modes, mode: Mode) -> ModeLines:
    """The lines of a scene and their displacements by a mode, linear in the shape."""
    linear = modes.linear
    shapes = (mode.shape.real, mode.shape.imag)
    motion = scene_motion(modes, [linear.q, *(linear.q + s * PROBE * shape for shape in shapes for s in (1, -1))])
    lines = scene_lines(motion)
    slopes = [((x[1] - x[2]) + 1j * (x[3] - x[4])) / (2 * PROBE) for x in lines]
    largest = max(float(np.sqrt((np.abs(slope) ** 2).sum(axis=1)).max()) for slope in slopes)
    size = float(np.ptp(np.concatenate([x[0] for x in lines]), axis=0).max()) or 1.0
    amplitude = DISPLACEMENT * size / largest if largest else 0.0
    return ModeLines([x[0] for x in lines], [amplitude * slope for slope in slopes], amplitude)


def displaced(modes: Modes, mode: Mode, phases: Vector) -> SceneMotion:
    """A scene at the phases (n,), rad, of a mode: displaced by a Re(shape exp(i phase)), at the time of the state.

    The amplitude a makes displacements at most DISPLACEMENT and rotations at most ROTATION. The states are brought back
    to the constraints, which the displacements meet to first order.
    """
    states = displaced_states(modes, drawn_scene(modes)[1], mode, phases, mode_lines(modes, mode).amplitude)
    return scene_motion(modes, states)


def displaced_states(modes: Modes, native: NativeScene, mode: Mode, phases: Vector, amplitude: float) -> list[Vector]:
    """The configurations (nq,) at the phases (n,), rad, of a mode, on the constraints; rotations are at most ROTATION.

    amplitude: the factor of the shape of the mode.
    """
    linear = modes.linear
    change: ComplexVector = mode.shape
    if native.nq != native.nv:  # quaternions change by rotation vectors
        change = np.linalg.pinv(rate_matrix(native, linear.q, modes.k)) @ mode.shape
    largest = float(np.abs(change[velocities_with(native, Role.ROTATION)]).max(initial=0.0))
    amplitude = min(amplitude, ROTATION / largest) if largest else amplitude
    states = [changed(native, linear.q, amplitude * (change * np.exp(1j * phase)).real) for phase in phases]
    if native.nq > MANY_COORDINATES:
        with suppress(ModelError):  # constraints that are redundant, or a mass matrix that is not definite
            return [_projected(native, modes.k, linear.t, q) for q in states]
    compliance: Matrix = np.linalg.inv(mass_matrix(native, linear.q, modes.k)).astype(np.float64)
    return [_on_constraints(native, modes.k, linear.t, q, compliance) for q in states]


def _on_constraints(native: NativeScene, k: Vector, t: float, q: Vector, compliance: Matrix) -> Vector:
    """The state closest to q (nq,) on the constraints, by Newton's method in the metric of the undisplaced scene.

    compliance: the inverse of its mass matrix. The truncated mass matrix of a beam of second order need not be definite
    at the size of a drawing.
    """
    for _ in range(NEWTON_STEPS if native.nlambda else 0):
        G = constraint_matrix(native, t, q, k)
        multipliers = np.linalg.lstsq(G @ compliance @ G.T, -native.constraints(t, q, k), rcond=None)[0]
        q = changed(native, q, compliance @ G.T @ multipliers)
    return q


def _projected(native: NativeScene, k: Vector, t: float, q: Vector) -> Vector:
    """The state next to q (nq,) on the constraints, in the metric of each iterate, whose effort is that of the C."""
    for _ in range(NEWTON_STEPS):
        q = changed(native, q, native.project_velocity(t, q, k, -native.constraints(t, q, k)))
    return q


def scene_motion(modes: Modes, states: list[Vector]) -> SceneMotion:
    """The motion through states (nq,) of a scene, or of a beam alone, at rest at the time of the linearisation."""
    scene, native = drawn_scene(modes)
    q = np.array(states)
    return SceneMotion(scene, native, modes.k, np.full(len(q), modes.linear.t), q, np.zeros_like(q))


def drawn_scene(modes: Modes) -> tuple[Scene, NativeScene]:
    """The scene that is drawn, and its compiled model. Raises TypeError for a body in space."""
    if isinstance(modes.spec, Scene):
        return scene_with_values(modes.spec), modes.native
    if isinstance(modes.spec, PlanarBeam):
        return beam_scene(replace(modes.spec, start=NOT_GIVEN)), FreeBeam(modes.native, modes.spec)
    raise TypeError(f"{modes.spec.name} is a body in space, not a planar one")


def scene_lines(motion: SceneMotion) -> list[Array]:
    """The lines (n, points, 2), m, of all bodies and springs of a scene at its n instants.

    A beam has its deformed axis, and a point for each mass that is attached to it; another body has the closed hull of
    its markers, which may be one point; a spring has the line between its ends.
    """
    lines: list[Array] = []
    xi = np.linspace(-1.0, 1.0, POINTS)
    for beam in beam_bodies(motion.scene):
        pieces = piece_names(beam)
        lines.append(np.concatenate([axis_points(motion, beam, piece, xi) for piece in pieces], axis=1))
        for mass in beam.beam.masses:
            piece, place = piece_at(beam, mass.at)
            lines.append(axis_points(motion, beam, pieces[piece], np.array([place])))
    for body in planar(motion.scene).bodies:
        if not isinstance(body, BeamBody) and (corners := outline(body)):
            points = [transformed(motion.pose(body.name), np.array(corner)) for corner in (*corners, corners[0])]
            lines.append(np.stack(points, axis=1))
    for spring in motion.scene.springs:
        lines.append(np.stack([marker_positions(motion, end) for end in spring.markers], axis=1))
    return lines
