"""Why an integration cannot go on: a dead centre, a drive that cannot be followed, or something else."""

from __future__ import annotations

from derive.native import ModelError, Vector
from derive.simulation.constraints import involved
from derive.simulation.errors import (
    DriveCannotBeFollowed,
    IntegrationStopped,
    SimulationError,
    SingularConfiguration,
)
from derive.simulation.least_change import largest
from derive.simulation.mechanism import Mechanism
from derive.simulation.nearby import drives_of
from derive.simulation.scaling import spectrum

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
    q = y[: native.nq]
    if largest(y) < float("inf"):
        found = spectrum(native, k, t, q)
        if found.smallest < NEAR:
            names = involved(found, native.multipliers, NEAR)
            driven = [name for name in names if name in drives_of(native, k, t, q)]
            if driven:
                return DriveCannotBeFollowed(t, found.smallest, names, driven)
            return SingularConfiguration(t, found.smallest, names)
    reason = f"{message.rstrip('.')}" + (f"; {refused[1]} at t = {refused[0]:.9g} s" if refused else "")
    return IntegrationStopped(t, reason)
