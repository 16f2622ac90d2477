"""A finite-element body displaced along a mode about its undeformed state, for pictures and animations."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from derive.runtime.native_call import Vector
from derive.simulation.linear.displaced import DISPLACEMENT
from derive.simulation.linear.eigenmodes import Mode
from derive.simulation.linear.modes import Modes
from derive.simulation.observables.motion import Array
from derive.simulation.observables.spatial_player_data import DrawnBody


def body_displacements(drawn: DrawnBody, mode: Mode) -> tuple[NDArray[np.complex128], float]:
    """The complex displacements (n, 3), m, of the points of a body by a mode, and the factor of its shape in them.

    The body is not rotated, so that the displacement is dc + 2 de x X + sum Phi_i dalpha_i, with the change de of the
    vector part of the quaternion. The largest displacement is the part DISPLACEMENT of the size of the body.
    """
    shift, vector, amplitudes = mode.shape[:3], mode.shape[4:7], mode.shape[7:]
    moved = shift + 2 * np.cross(vector, drawn.x) + np.tensordot(amplitudes, drawn.phi, axes=1)
    largest = float(np.sqrt((np.abs(moved) ** 2).sum(axis=1)).max())
    size = float(np.ptp(drawn.x, axis=0).max())
    factor = DISPLACEMENT * size / largest if largest else 0.0
    return factor * moved, factor


def displaced_body(modes: Modes, mode: Mode, drawn: DrawnBody, phases: Vector) -> Array:
    """The coordinates (n, nq) of a body at the phases (n,), rad, of a mode, with unit quaternions."""
    _, factor = body_displacements(drawn, mode)
    q: Array = modes.linear.q + factor * (mode.shape * np.exp(1j * phases)[:, None]).real
    q[:, 3:7] /= np.linalg.norm(q[:, 3:7], axis=1)[:, None]
    return q
