"""The initial state of a body in space that moves alone, from its `start`."""

from __future__ import annotations

import numpy as np

from derive.errors import Problem, SpecError
from derive.ir.model import Model
from derive.runtime.native_call import Vector
from derive.spec.model.simulation import SpatialStart


def normalised(start: SpatialStart) -> tuple[str, ...]:
    """A note if the quaternion of an initial state has another length than 1, apart from rounding errors."""
    length = float(np.linalg.norm(start.quaternion))
    return () if abs(length - 1.0) < 1e-12 else (f"body.start.rotation: length of the quaternion {length:.9g} -> 1",)


def initial_vectors(model: Model, start: SpatialStart) -> tuple[Vector, Vector]:
    """The coordinates q (nq,) and velocities v (nv,) of an initial state, with the quaternion scaled to length 1.

    Raises SpecError if there are more amplitudes than modes.
    """
    modes = sum(variable.size for variable in model.velocities) - 6
    problems = [
        Problem(f"body.start.{key}", f"there are {len(values)} numbers, and the body has {modes} modes")
        for key, values in (("amplitudes", start.amplitudes), ("amplitude_rates", start.amplitude_rates))
        if len(values) > modes
    ]
    if problems:
        raise SpecError(tuple(problems))
    quaternion = np.array(start.quaternion) / np.linalg.norm(start.quaternion)
    q = np.concatenate([start.position, quaternion, _padded(start.amplitudes, modes)])
    v = np.concatenate([start.velocity, start.angular_velocity, _padded(start.amplitude_rates, modes)])
    return q, v


def _padded(values: tuple[float, ...], size: int) -> Vector:
    return np.array([*values, *(0.0 for _ in range(size - len(values)))])
