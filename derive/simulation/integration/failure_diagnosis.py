"""Diagnosis of failures: a dead centre, a drive that cannot be followed, or another reason of the integrator."""

from __future__ import annotations

import numpy as np

from derive.roles import Role
from derive.runtime.native_call import ModelError, Vector
from derive.simulation.compiled_scene import ConstrainedSystem, coordinates_with
from derive.simulation.constraints.mass_definiteness import lost_inertia_of, nearly_indefinite
from derive.simulation.constraints.neighbouring_states import driven_multipliers, neighbouring_states
from derive.simulation.constraints.redundancy import held_along_beams, involved
from derive.simulation.constraints.scaling import spectrum
from derive.simulation.errors import (
    DriftTooLarge,
    DriveCannotBeFollowed,
    InextensibleBeam,
    IntegrationStopped,
    MassMatrixNotDefinite,
    SimulationError,
    SingularConfiguration,
)

NEARLY_SINGULAR = 1e-3
"""A singular value of the scaled constraints below this counts as the reason why an integrator fails."""


def diagnose_failure(
    native: ConstrainedSystem, k: Vector, t: float, y: Vector, refused: tuple[float, ModelError] | None, message: str
) -> SimulationError:
    """The error that explains why an integrator cannot continue from its last state y = [q; v], near t (s).

    refused: the time and the error with which the model last refused a state. message: that of the integrator.
    """
    # An indefinite M comes first, since constraints scaled by it may look dependent.
    if np.all(np.isfinite(y)) and nearly_indefinite(native, k, y[: native.nq]):
        in_space = bool(coordinates_with(native, Role.QUATERNION).any())
        return MassMatrixNotDefinite(t, *(lost_inertia_of(native, k, y[: native.nq]) if in_space else ()))
    if (dead_centre := _dead_centre(native, k, t, y)) is not None:
        return dead_centre
    reason = f"{message.rstrip('.')}" + (f"; {refused[1]} at t = {refused[0]:.9g} s" if refused else "")
    return IntegrationStopped(t, reason)


def diagnose_error(
    native: ConstrainedSystem, k: Vector, t: float, y: Vector, error: ModelError | DriftTooLarge
) -> SimulationError:
    """The error that explains an error after the last good state y = [q; v] at t (s): a dead centre, or itself."""
    if isinstance(error, DriftTooLarge):
        return _dead_centre(native, k, t, y) or error
    return diagnose_failure(native, k, t, y, None, str(error))


def _dead_centre(
    native: ConstrainedSystem, k: Vector, t: float, y: Vector
) -> SingularConfiguration | InextensibleBeam | None:
    """The error for a dead centre at y = [q; v], or for beams that joints hold along their axes there, if any."""
    if not native.nlambda or not np.all(np.isfinite(y)):
        return None
    try:
        singular = spectrum(native, k, t, y[: native.nq])
    except ValueError:  # the state is finite, and so large that M or G is not
        return None
    if singular.smallest >= NEARLY_SINGULAR:
        return None
    names = involved(singular, native.multipliers, NEARLY_SINGULAR)
    driven = [name for name in names if name in driven_multipliers(native, k, t, y[: native.nq])]
    # A model that resolves redundant joints comes after one that does not, unless a drive is the reason.
    if (driven or native.proximal) and _always_held(native, k, t, y[: native.nq]):
        return InextensibleBeam(t, names, native.in_space)
    if driven:
        locked = not any(time > t for time, _ in neighbouring_states(native, k, t, y[: native.nq]))
        return DriveCannotBeFollowed(t, singular.smallest, names, driven, locked)
    return SingularConfiguration(t, singular.smallest, names)


def _always_held(native: ConstrainedSystem, k: Vector, t: float, q: Vector) -> bool:
    """Whether joints hold beams along their axes at q (nq,), and nearly so in neighbouring states: no motion passes."""
    around = (spectrum(native, k, *state).smallest for state in neighbouring_states(native, k, t, q))
    nearly = max(around, default=0.0) < NEARLY_SINGULAR
    return nearly and held_along_beams(native, k, t, q, limit=NEARLY_SINGULAR)
