"""Explicit integration of a compiled scene in C: adaptive Runge-Kutta steps, projected onto the constraints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from derive.runtime.integrators.adaptive import OFF, Adaptive, AdaptiveError, AdaptiveRun
from derive.runtime.integrators.c_integrator import CONSISTENT
from derive.runtime.native_call import ModelError, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.constraints.projection import UNAVOIDABLE, check_drift
from derive.simulation.errors import (
    DriftTooLarge,
    DriveCannotBeFollowed,
    SimulationError,
    SingularConfiguration,
    TooNearDeadCentre,
)
from derive.simulation.integration.failure_diagnosis import diagnose_error, diagnose_failure
from derive.simulation.integration.integrator import Integrator, Settings
from derive.simulation.integration.scipy_methods import MAX_STEPS_PER_ROW
from derive.simulation.integration.solution import Cost, Solution, row_times
from derive.simulation.integration.time_segments import smooth_ends
from derive.simulation.integration.tolerances import absolute_tolerances, consistent_tolerance, rounding_note


def adaptive(
    native: NativeScene,
    through_python: Callable[[NativeScene], Integrator] | None = None,
    library: bytes | None = None,
) -> Integrator:
    """The method of Dormand and Prince of order 8 in C. Raises CompilerError.

    through_python: the method for functions in Python, which C does not call, if there may be any. library: the
    compiled method, see `Adaptive`.
    """
    host = Adaptive(native, library)

    def integrate(k: Vector, q: Vector, v: Vector, times: Vector, settings: Settings) -> Solution:
        settings.refuse_step("adaptive")
        instants, until, progress = row_times(times), settings.until, settings.progress
        notes = rounding_note(settings.tolerance, q)

        def observe(t: float, row: Vector) -> bool:
            if progress is not None:
                progress(t)
            return False

        holds_at_start = until is not None and until.holds(until.value(float(instants[0]), np.concatenate([q, v])))
        try:
            run = host.run(
                q,
                v,
                instants,
                rtol=settings.tolerance,
                atol=absolute_tolerances(native, settings.tolerance, settings.size, q),
                k=k,
                consistent=_consistent(native, settings.size, q),
                drift=settings.drift,
                steps_max=MAX_STEPS_PER_ROW * len(instants),
                breaks=smooth_ends(instants, settings.breaks)[:-1] if len(instants) > 1 else (),
                event=until.value if until else None,
                crossing=until.crossing if until else False,
                observe=observe if settings.interruptible else None,
                watch=settings.watch,
            )
        except AdaptiveError as error:
            raise _diagnosed(native, k, settings, error) from error
        if until is not None:
            notes += until.notes(float(run.t[-1]), float(instants[0]) if holds_at_start else None, run.met)
        return _solution(run, notes)

    if through_python is None:
        return Integrator(native, integrate)

    def noted(driven: NativeScene) -> Integrator:
        integrator = through_python(driven)

        def integrate_noted(k: Vector, q: Vector, v: Vector, times: Vector, settings: Settings) -> Solution:
            solution = integrator.integrate(k, q, v, times, settings)
            note = "integrator: adaptive -> dop853, since functions in Python give the inputs"
            return replace(solution, notes=(note, *solution.notes))

        return replace(integrator, integrate=integrate_noted)

    return Integrator(native, integrate, noted)


def _solution(run: AdaptiveRun, notes: tuple[str, ...]) -> Solution:
    cost = Cost(run.counts["accelerations"], run.counts["steps"], run.seconds)
    return Solution(run.t, run.q, run.v, run.lam, run.drift, run.drift_before, cost, notes, run.outputs, run.watched)


def _consistent(native: NativeScene, size: float, q: Vector) -> float:
    """The |g| and |gdot| up to which constraints count as met.

    Where joints may pass a singular position, at a distance of epsilon (rad), an error c of g is one of c/epsilon in
    the coordinates and of c/epsilon^3 in accelerations, so that rounding errors alone are left of it.
    """
    return UNAVOIDABLE if native.proximal else consistent_tolerance(CONSISTENT, size, q)


def _diagnosed(native: NativeScene, k: Vector, settings: Settings, error: AdaptiveError) -> SimulationError:
    """The error that explains why the C integrator cannot continue from its last state."""
    reason = _reason(native, k, settings.drift, error)
    if native.proximal and isinstance(reason, SingularConfiguration) and not isinstance(reason, DriveCannotBeFollowed):
        return TooNearDeadCentre(reason, settings.tolerance)
    return reason


def _reason(native: NativeScene, k: Vector, limit: float, error: AdaptiveError) -> SimulationError:
    """The error without regard to the proximal term."""
    refused = None
    if error.refused is not None:
        code, t = error.refused
        if code == OFF and error.code == OFF:
            try:
                check_drift(native, k, t, error.trial[: native.nq], error.trial[native.nq :], limit)
            except DriftTooLarge as drift:
                return diagnose_error(native, k, error.t, error.y, drift)
        if code != OFF:
            refused = t, ModelError(f"{native.name}_accel", code)
    return diagnose_failure(native, k, error.t, error.y, refused, error.meaning)
