"""Bodies in space displaced along a mode, alone or in a scene, for pictures and animations."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from derive.runtime.native_call import Vector
from derive.simulation.free_body import POSE, FreeBody
from derive.simulation.linear.displaced import DISPLACEMENT, PROBE, displaced_states
from derive.simulation.linear.eigenmodes import Mode
from derive.simulation.linear.modes import Modes
from derive.simulation.observables.motion import Array, SceneMotion
from derive.simulation.observables.spatial_player_data import BodyPath, DrawnBody, placed
from derive.simulation.observables.spatial_scene_player import body_paths
from derive.spec.model.spatial_scene import SpatialScene


def bodies_displacements(
    modes: Modes, mode: Mode, drawn: Sequence[DrawnBody]
) -> tuple[list[Array], list[NDArray[np.complex128]], float]:
    """The places (points, 3), m, of bodies, their complex displacements by a mode, and the factor of its shape there.

    The displacements are linear in the shape; the largest is the part DISPLACEMENT of the size of the scene.
    """
    q, shapes = modes.linear.q, (mode.shape.real, mode.shape.imag)
    motion = _motion(modes, [q, *(q + s * PROBE * shape for shape in shapes for s in (1, -1))])
    places = [placed(body, path) for body, path in zip(drawn, body_paths(drawn, motion), strict=True)]
    slopes = [((x[1] - x[2]) + 1j * (x[3] - x[4])) / (2 * PROBE) for x in places]
    largest = max(float(np.sqrt((np.abs(slope) ** 2).sum(axis=1)).max(initial=0.0)) for slope in slopes)
    size = float(np.ptp(np.concatenate([x[0] for x in places]), axis=0).max()) or 1.0
    factor = DISPLACEMENT * size / largest if largest else 0.0
    return [x[0] for x in places], [factor * slope for slope in slopes], factor


def displaced_paths(modes: Modes, mode: Mode, drawn: Sequence[DrawnBody], phases: Vector) -> list[BodyPath]:
    """The motions of bodies through the phases (n,), rad, of a mode, on the constraints."""
    factor = bodies_displacements(modes, mode, drawn)[2]
    return body_paths(drawn, _motion(modes, displaced_states(modes, modes.native, mode, phases, factor)))


def _motion(modes: Modes, states: Sequence[Vector]) -> SceneMotion:
    """The motion through configurations (nq,), at rest at the time of the linearisation."""
    assert isinstance(modes.spec, SpatialScene)
    q, n = np.array(states), len(states)
    times, rest = np.full(n, modes.linear.t), np.zeros((n, modes.native.nv))
    return SceneMotion(modes.spec, modes.native, modes.k, times, q, rest)


def body_displacements(drawn: DrawnBody, mode: Mode) -> tuple[NDArray[np.complex128], float]:
    """The complex displacements (n, 3), m, of the points of a body by a mode, and the factor of its shape in them.

    The body is not rotated, so that the displacement is dc + 2 de x X + sum Phi_i dalpha_i, with the change de of the
    vector part of the quaternion. The largest displacement is the part DISPLACEMENT of the size of the body.
    """
    own = FreeBody(len(mode.shape) - POSE)
    shift, vector, amplitudes = (mode.shape[at] for at in (own.position, own.quaternion, own.amplitudes))
    moved = shift + 2 * np.cross(vector[1:], drawn.x) + np.tensordot(amplitudes, drawn.phi, axes=1)
    largest = float(np.sqrt((np.abs(moved) ** 2).sum(axis=1)).max())
    size = float(np.ptp(drawn.x, axis=0).max())
    factor = DISPLACEMENT * size / largest if largest else 0.0
    return factor * moved, factor


def displaced_body(modes: Modes, mode: Mode, drawn: DrawnBody, phases: Vector) -> Array:
    """The coordinates (n, nq) of a body at the phases (n,), rad, of a mode, with unit quaternions."""
    _, factor = body_displacements(drawn, mode)
    q: Array = modes.linear.q + factor * (mode.shape * np.exp(1j * phases)[:, None]).real
    quaternions = q[:, FreeBody(0).quaternion]
    quaternions /= np.linalg.norm(quaternions, axis=1)[:, None]
    return q
