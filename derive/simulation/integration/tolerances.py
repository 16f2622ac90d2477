"""Absolute tolerances of a scene: of lengths in proportion to its size, and none below the rounding of positions."""

from __future__ import annotations

import numpy as np

from derive.roles import Role
from derive.runtime.native_call import Vector
from derive.simulation.compiled_scene import ConstrainedSystem, Mask, coordinates_with, max_norm
from derive.simulation.configurations import velocities_with
from derive.simulation.constraints.projection import UNAVOIDABLE


def absolute_tolerances(native: ConstrainedSystem, tolerance: float, size: float, q: Vector) -> Vector:
    """The absolute tolerances (nq + nv,) of q and v for a `tolerance` that the user gives.

    size: that of the scene, m; in one that is smaller than 1 m, a length is as exact as an angle. q: the initial
    coordinates (nq,): the constraints are differences of positions, so that the rounding errors of these are errors of
    all coordinates.
    """
    wanted = np.where(_lengths(native), tolerance * min(1.0, size), tolerance)
    return np.maximum(wanted, UNAVOIDABLE * max_norm(q))


def rounding_note(tolerance: float, q: Vector) -> tuple[str, ...]:
    """A note if the position of the scene with the initial coordinates q (nq,) does not allow a tolerance."""
    least = UNAVOIDABLE * max_norm(q)
    if tolerance >= least:
        return ()
    return (
        f"tolerance: {tolerance:g} -> {least:.2g} absolute, as coordinates of up to {max_norm(q):.2g} are rounded to "
        f"{np.spacing(max_norm(q)):.1g}",
    )


def consistent_tolerance(tolerance: float, size: float, q: Vector) -> float:
    """The |g| (m, rad) up to which constraints count as met in the state q (nq,), for a `tolerance` and a size (m)."""
    return max(tolerance * min(1.0, size), UNAVOIDABLE * max_norm(q))


def _lengths(native: ConstrainedSystem) -> Mask:
    """The mask (nq + nv,) of the coordinates and velocities with a length in their units."""
    q = ~coordinates_with(native, Role.ROTATION, Role.QUATERNION)
    return np.concatenate([q, ~velocities_with(native, Role.ROTATION)])
