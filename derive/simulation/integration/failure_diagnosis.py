"""Why an integration cannot go on: a dead centre, a drive that cannot be followed, or something else."""

from __future__ import annotations

import numpy as np

from derive.runtime.native import ModelError, Vector
from derive.simulation.compiled_scene import Mechanism
from derive.simulation.constraints.neighbouring_states import drives_of
from derive.simulation.constraints.redundancy import involved
from derive.simulation.constraints.scaling import spectrum
from derive.simulation.errors import (
    DriftTooLarge,
    DriveCannotBeFollowed,
    IntegrationStopped,
    SimulationError,
    SingularConfiguration,
)

NEAR = 1e-3
"""A singular value of scaled constraints below this, where an integrator is stuck, is taken for the reason."""


def reason_to_stop(
    native: Mechanism,
    k: Vector,
    t: float,
    y: Vector,
    refused: tuple[float, ModelError] | None,
    message: str,
) -> SimulationError:
    """The error that explains why nothing goes on from the last state y = [q; v], near t.

    `refused`: when a model last refused a state, and how; `message`: what the integrator has to say.
    """
    if (dead_centre := _dead_centre(native, k, t, y)) is not None:
        return dead_centre
    reason = f"{message.rstrip('.')}" + (f"; {refused[1]} at t = {refused[0]:.9g} s" if refused else "")
    return IntegrationStopped(t, reason)


def explained(native: Mechanism, k: Vector, t: float, y: Vector, error: ModelError | DriftTooLarge) -> SimulationError:
    """What is behind an error after the last good state y = [q; v] at t: a dead centre, or what the error says."""
    if isinstance(error, DriftTooLarge):
        return _dead_centre(native, k, t, y) or error
    return reason_to_stop(native, k, t, y, None, str(error))


def _dead_centre(native: Mechanism, k: Vector, t: float, y: Vector) -> SingularConfiguration | None:
    if not np.all(np.isfinite(y)):
        return None
    found = spectrum(native, k, t, y[: native.nq])
    if found.smallest >= NEAR:
        return None
    names = involved(found, native.multipliers, NEAR)
    driven = [name for name in names if name in drives_of(native, k, t, y[: native.nq])]
    if driven:
        return DriveCannotBeFollowed(t, found.smallest, names, driven)
    return SingularConfiguration(t, found.smallest, names)
