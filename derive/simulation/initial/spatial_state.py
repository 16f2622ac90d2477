"""The size and the initial state of a body in space that moves alone."""

from __future__ import annotations

import numpy as np

from derive.errors import Problem, SpecError
from derive.ir.model import Model
from derive.runtime.native_call import Vector
from derive.simulation.free_body import RIGID
from derive.simulation.initial.initial_state import InitialState
from derive.spec.model.body import NodalBody
from derive.spec.model.simulation import SpatialStart


def body_size(body: NodalBody) -> float:
    """The diagonal (m) of the box around all nodes; 1 of a point."""
    return float(np.linalg.norm(np.ptp(body.data.positions, axis=0))) or 1.0


def spatial_state(model: Model, start: SpatialStart) -> InitialState:
    """The initial state of a body, with the quaternion scaled to length 1, which a note mentions.

    Raises SpecError if there are more amplitudes than modes.
    """
    modes = sum(variable.size for variable in model.velocities) - RIGID
    problems = [
        Problem(f"body.start.{key}", f"there are {len(values)} numbers, and the body has {modes} modes")
        for key, values in (("amplitudes", start.amplitudes), ("amplitude_rates", start.amplitude_rates))
        if len(values) > modes
    ]
    if problems:
        raise SpecError(tuple(problems))
    length = float(np.linalg.norm(start.quaternion))
    scaled = abs(length - 1.0) >= 1e-12  # apart from rounding errors
    notes = (f"body.start.rotation: length of the quaternion {length:.9g} -> 1",) if scaled else ()
    q = np.concatenate([start.position, np.array(start.quaternion) / length, _padded(start.amplitudes, modes)])
    v = np.concatenate([start.velocity, start.angular_velocity, _padded(start.amplitude_rates, modes)])
    return InitialState(0.0, q, v, 0.0, 0.0, False, False, remainders=notes)


def _padded(values: tuple[float, ...], size: int) -> Vector:
    return np.array([*values, *(0.0 for _ in range(size - len(values)))])
