"""Integration of a scene by the C integrators that are compiled with its model: RK4, generalised-alpha, IDA."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from derive.artifacts import File
from derive.runtime.integrators.c_integrator import CONSISTENT, Integration, IntegratorError
from derive.runtime.integrators.fixed_step import FixedStep
from derive.runtime.integrators.generalised_alpha import GeneralisedAlpha
from derive.runtime.integrators.ida import Ida
from derive.runtime.native_body import NativeBody
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import max_norm
from derive.simulation.constraints.projection import UNAVOIDABLE
from derive.simulation.errors import SimulationError
from derive.simulation.integration.failure_diagnosis import diagnose_failure
from derive.simulation.integration.integrator import Integrator, Settings, scene_of
from derive.simulation.integration.solution import Cost, Solution, SolutionWriter, row_times
from derive.simulation.integration.step_limit import rk4_step_limit

STABLE = 0.5
"""The step of RK4, unless it is given, divided by the longest stable step in the initial state."""

MAX_STEPS_PER_ROW = 10**9

STEPS_PER_ROW = 10
"""The steps of the generalised-alpha method between two rows, unless the step is given."""

Run = Callable[[Vector, Vector, float, float, int], Integration]
"""A function of q (nq,), v (nv,), t0 (s), the interval between rows (s) and the number of rows after the first."""


def rk4(files: Sequence[File]) -> Integrator:
    """The classical Runge-Kutta method with fixed steps and projection. Raises CompilerError."""
    host = FixedStep(files)
    native = host.native

    def integrate(k: Vector, q: Vector, v: Vector, times: Vector, settings: Settings) -> Solution:
        settings.refuse_until("rk4")
        if settings.step is None and isinstance(native, NativeBody):
            raise SimulationError("rk4 needs a step for a single body: add --step, or step=... in Python")
        step = settings.step or STABLE * rk4_step_limit(native, k, float(times[0]), q, v)

        def run(q0: Vector, v0: Vector, t0: float, interval: float, rows: int) -> Integration:
            every = equal_steps(interval, step)
            steps = rows * every
            return host.run(q0, v0, step=interval / every, steps=steps, every=every, k=k, t0=t0, tolerance=_met(q0))

        return _solution(native, run, k, q, v, times, settings)

    return Integrator(native, integrate)


def generalised_alpha(files: Sequence[File]) -> Integrator:
    """The generalised-alpha method with fixed steps. Raises CompilerError, LibraryMissing."""
    host = GeneralisedAlpha(files)
    native = scene_of(host.native, "generalised-alpha")

    def integrate(k: Vector, q: Vector, v: Vector, times: Vector, settings: Settings) -> Solution:
        settings.refuse_until("generalised-alpha")

        def run(q0: Vector, v0: Vector, t0: float, interval: float, rows: int) -> Integration:
            step = settings.step or interval / STEPS_PER_ROW
            every = equal_steps(interval, step)
            steps = rows * every
            return host.run(q0, v0, step=interval / every, steps=steps, every=every, k=k, t0=t0, consistent=_met(q0))

        return _solution(native, run, k, q, v, times, settings)

    return Integrator(native, integrate)


def ida(files: Sequence[File]) -> Integrator:
    """IDA of SUNDIALS with the stabilised form of index 2. Raises CompilerError, LibraryMissing."""
    host = Ida(files)
    native = scene_of(host.native, "c_ida")

    def integrate(k: Vector, q: Vector, v: Vector, times: Vector, settings: Settings) -> Solution:
        settings.refuse_step("c_ida")
        settings.refuse_until("c_ida")

        def run(q0: Vector, v0: Vector, t0: float, interval: float, rows: int) -> Integration:
            rtol, met = settings.tolerance, _met(q0)
            return host.run(q0, v0, interval=interval, rows=rows + 1, rtol=rtol, k=k, t0=t0, consistent=met)

        return _solution(native, run, k, q, v, times, settings)

    return Integrator(native, integrate)


def _met(q: Vector) -> float:
    """The |g| (m, rad) up to which constraints are met in the state q (nq,), which may be far from the origin."""
    return max(CONSISTENT, UNAVOIDABLE * max_norm(q))


def _solution(
    native: NativeScene | NativeBody,
    run: Run,
    k: Vector,
    q: Vector,
    v: Vector,
    times: Sequence[float] | Vector,
    settings: Settings,
) -> Solution:
    """The solution, by a call of `run` for each part of `times` with equal intervals. Raises SimulationError."""
    instants = row_times(times)
    rows = SolutionWriter(native, k, len(instants), settings.drift, projected=True)
    rows.append(float(instants[0]), np.concatenate([q, v]))
    evaluations = steps = jacobians = 0
    seconds = 0.0
    for first, last in _equal_intervals(instants):
        t0, interval = float(instants[first]), float((instants[last] - instants[first]) / (last - first))
        try:
            part = run(q, v, t0, interval, last - first)
        except IntegratorError as error:
            raise _diagnosed(native, k, np.concatenate([q, v]), t0, error) from error
        for i in range(1, last - first + 1):
            rows.append(float(instants[first + i]), np.concatenate([part.q[i], part.v[i]]))
        q, v = rows.states[last, : native.nq], rows.states[last, native.nq :]
        evaluations += part.counts.get("accelerations", 0) + part.counts.get("residuals", 0)
        steps, jacobians = steps + part.counts["steps"], jacobians + part.counts.get("jacobians", 0)
        seconds += part.seconds
        if settings.progress is not None:
            settings.progress(float(instants[last]))
    cost = Cost(evaluations, steps, seconds, jacobians)
    return rows.solution(instants, cost, _shortened(instants, settings.step))


def _shortened(times: Vector, step: float | None) -> tuple[str, ...]:
    """A note if the step (s) that was given does not divide the intervals between rows, so that it is shortened."""
    if step is None:
        return ()
    intervals = [float(times[last] - times[first]) / (last - first) for first, last in _equal_intervals(times)]
    used = {interval: interval / equal_steps(interval, step) for interval in intervals}
    return tuple(
        f"step: {step:g} s -> {short:.6g} s between rows that are {interval:.6g} s apart: rows are ends of steps"
        for interval, short in used.items()
        if short < step * (1 - 1e-9)
    )


def equal_steps(interval: float, step: float) -> int:
    """The number of equal steps, at most as long as `step` (s), in an interval (s) between two rows.

    Raises SimulationError if there are too many.
    """
    count = interval / step * (1 - 1e-12)
    if not count <= MAX_STEPS_PER_ROW:
        raise SimulationError(
            f"steps of {step:g} s are {count:.3g} steps between two rows, and at most {MAX_STEPS_PER_ROW:g} are taken; "
            "give a longer step, or choose an integrator with adaptive steps, such as dop853"
        )
    return max(1, math.ceil(count))


def _equal_intervals(times: Vector) -> list[tuple[int, int]]:
    """The first and the last index of each longest part of `times` (n,) whose intervals are equal."""
    intervals = np.diff(times)
    changes = [i + 1 for i in range(len(intervals) - 1) if abs(intervals[i + 1] / intervals[i] - 1) > 1e-6]
    return list(pairwise([0, *changes, len(intervals)])) if len(intervals) else []


def _diagnosed(native: NativeScene | NativeBody, k: Vector, y: Vector, t: float, error: IntegratorError) -> Exception:
    """The error that explains a failure after the last finite row that the C integrator has reached."""
    partial = error.partial
    for row in range(len(partial.t)):
        state = np.concatenate([partial.q[row], partial.v[row]])
        if not np.all(np.isfinite(state)):
            break
        t, y = float(partial.t[row]), state
    return diagnose_failure(native, k, t, y, None, str(error))
