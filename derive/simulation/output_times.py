"""The times of the rows of a trajectory."""

from __future__ import annotations

import math

import numpy as np

from derive.runtime.native_call import Vector
from derive.spec.model.simulation import Simulation


def output_times(simulation: Simulation) -> Vector:
    """The times (n,) of the rows, s: multiples of `output`, and the end."""
    count = math.floor(simulation.duration / simulation.output * (1 + 1e-12))
    times = np.minimum(np.arange(count + 1) * simulation.output, simulation.duration)
    rest = simulation.duration - times[-1]
    return np.append(times, simulation.duration) if rest > 1e-9 * simulation.output else times
