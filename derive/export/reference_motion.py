"""The motion with which a sample program of an export compares its own: states at some times, as Tisserand has them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from derive.export.host_model import HostModel
from derive.runtime.loading import load
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.constraints.projection import project
from derive.simulation.integration.scipy_methods import integrate

ROWS = 11
DURATION = 1.0
"""The duration (s) for a specification without a `simulation`."""
TOLERANCE = 1e-9
ACCEPTED = 1e-5
"""The difference of a state that is accepted, relative to the largest value of its kind (q or v)."""


@dataclass(frozen=True, eq=False)
class ReferenceMotion:
    """States x = [q; v] (ROWS, nq + nv) at the times (ROWS,), s, and the accepted differences (nq + nv,)."""

    times: Vector
    states: Matrix
    tolerances: Vector


def reference_motion(model: HostModel) -> ReferenceMotion:
    """The motion of a model over the first tenth of its simulation, too short to become unpredictable.

    The inputs keep their start values, and the rates of those that prescribe motions are zero, to which the start state
    is projected. Raises CompilerError, and what `integrate` raises.
    """
    given = model.spec.simulation
    times = np.linspace(0.0, 0.1 * (given.duration if given is not None else DURATION), ROWS)
    native = load(model.files)
    k = native.with_inputs(native.setup(), model.constant_inputs)
    q, v = project(
        native, k, 0.0, *(np.array([x.start for x in part]) for part in (model.coordinates, model.velocities))
    )
    solution = integrate(native, k, q, v, times, tolerance=TOLERANCE)
    sizes = [np.full(part.shape[1], np.max(np.abs(part), initial=0.0)) for part in (solution.q, solution.v)]
    accepted = ACCEPTED * np.maximum(np.concatenate(sizes), 1e-6)
    return ReferenceMotion(times, np.hstack([solution.q, solution.v]), accepted)
