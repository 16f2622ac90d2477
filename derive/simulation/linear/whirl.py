"""The whirl of modes about the axis of a steady rotation in space: forward with it or backward, in inertial axes."""

from __future__ import annotations

import math

import numpy as np

from derive.simulation.linear.displaced_bodies import bodies_displacements
from derive.simulation.linear.eigenmodes import Mode
from derive.simulation.linear.modes import Modes
from derive.simulation.observables.spatial_scene_player import drawn_bodies
from derive.spec.model.spatial_scene import SpatialScene

CIRCULAR = 1e-4
"""The part of the opposite circle up to which the points of a mode move in circles."""


def whirls(modes: Modes) -> tuple[float | None, ...] | None:
    """The whirl frequency of each mode in inertial axes (Hz), positive forward; None without a rotation in space.

    It is known of modes whose points all move in circles about the axis, as those of a rotor that is the same in all
    directions; others are ellipses, which have no frequency in other axes, and are None.
    """
    if modes.steady is None or modes.steady.rotation is None or not modes.steady.spin:
        return None
    axis = modes.steady.rotation / modes.steady.spin
    across = np.linalg.svd(axis[None])[2][1:]
    first, second = across if np.linalg.det([*across, axis]) > 0 else across[::-1]
    return tuple(_whirl(modes, mode, first, second) for mode in modes.modes)


def _whirl(modes: Modes, mode: Mode, first: np.ndarray, second: np.ndarray) -> float | None:
    """The whirl frequency of a mode; the plane across the axis is spanned by two directions."""
    assert isinstance(modes.spec, SpatialScene) and modes.steady is not None
    if not mode.eigenvalue.imag:
        return None
    moved = np.concatenate(bodies_displacements(modes, mode, drawn_bodies(modes.spec, 0))[1])
    forward, backward = (np.linalg.norm(moved @ first + sense * moved @ second) for sense in (1j, -1j))
    if not min(forward, backward) <= CIRCULAR * max(forward, backward):
        return None
    sense = 1.0 if forward > backward else -1.0
    return float((sense * mode.eigenvalue.imag + modes.steady.spin) / (2 * math.pi))
