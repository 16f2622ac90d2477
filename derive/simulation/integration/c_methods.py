"""Integration of a scene by the C integrators that are compiled with its model: RK4, generalised-alpha, IDA."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from derive.artifacts import File
from derive.runtime.compiler import ESSENTIAL, WITHOUT_BATCHES
from derive.runtime.integrators.c_integrator import CONSISTENT, Integration
from derive.runtime.integrators.fixed_step import FixedStep
from derive.runtime.integrators.generalised_alpha import GeneralisedAlpha
from derive.runtime.integrators.ida import Ida
from derive.runtime.integrators.observer import Observe
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.errors import IntegrationStopped, SimulationError
from derive.simulation.integration.c_rows import CRows, Run
from derive.simulation.integration.integrator import Integrator, Settings, scene_of
from derive.simulation.integration.solution import Solution
from derive.simulation.integration.step_error import step_notes
from derive.simulation.integration.step_limit import RK4_LIMIT, rk4_step_limit
from derive.simulation.integration.time_segments import TimeSegment, time_segments
from derive.simulation.integration.tolerances import absolute_tolerances, consistent_tolerance, rounding_note

STABLE = 0.5
"""The step of RK4, unless it is given, divided by the longest stable step in the initial state."""

MAX_STEPS_PER_ROW = 10**9

NEWTON = 1e-11
"""The tolerance of Newton's method of the generalised-alpha method."""

STEPS_PER_ROW = 10
"""The steps of the generalised-alpha method between two rows, unless the step is given."""


def rk4(files: Sequence[File]) -> Integrator:
    """The classical Runge-Kutta method with fixed steps and projection. Raises CompilerError."""
    host = FixedStep(files, ESSENTIAL)
    native = host.native

    def integrate(k: Vector, q: Vector, v: Vector, times: Vector, settings: Settings) -> Solution:
        if settings.step is None and not native.is_scene:
            raise SimulationError("rk4 needs a step for a single body: add --step, or step=... in Python")
        limit = rk4_step_limit(native, k, float(times[0]), q, v) if native.is_scene else math.inf
        step = settings.step or STABLE * limit
        longest = max(
            (segment.interval / equal_steps(segment.interval, step) for segment in time_segments(times)), default=0.0
        )
        unstable = (
            f"step: {longest:.6g} s is above the stability limit of rk4, {limit:.3g} s in the initial state, where the "
            f"highest natural frequency is {RK4_LIMIT / limit:.6g} rad/s: errors grow from step to step; take a "
            "shorter one, or leave --step out"
        )
        notes = (*_shortened(times, settings), *((unstable,) if longest > limit else ()))

        def run(q0: Vector, v0: Vector, segment: TimeSegment, observe: Observe | None) -> Integration:
            every = equal_steps(segment.interval, step)
            steps, length = segment.count * every, segment.interval / every
            met = consistent_tolerance(CONSISTENT, settings.size, q0)
            return host.run(
                q0, v0, step=length, steps=steps, every=every, k=k, t0=segment.start, tolerance=met, observe=observe
            )

        try:
            return CRows(native, run, k, settings).solution(q, v, times, notes)
        except SimulationError as error:
            if longest > limit:
                raise SimulationError(f"{unstable}. {error}") from error
            if isinstance(error, IntegrationStopped):
                shorter = f"a step shorter than {longest:.3g} s may pass, such as --step {longest / 10:.2g}"
                raise SimulationError(f"{error} With rk4 {shorter}; adaptive finds its steps itself.") from error
            raise

    return Integrator(native, integrate)


def generalised_alpha(files: Sequence[File]) -> Integrator:
    """The generalised-alpha method with fixed steps. Raises CompilerError, LibraryMissing."""
    host = GeneralisedAlpha(files, ESSENTIAL)
    native = scene_of(host.native, "generalised-alpha")

    def integrate(k: Vector, q: Vector, v: Vector, times: Vector, settings: Settings) -> Solution:
        lengths = list[float]()

        def run_with(steps: Callable[[int], int]) -> Run:
            """The runs with another number of steps between two rows than the settings have."""

            def run(q0: Vector, v0: Vector, segment: TimeSegment, observe: Observe | None) -> Integration:
                every = steps(equal_steps(segment.interval, settings.step or segment.interval / STEPS_PER_ROW))
                lengths.append(segment.interval / every)
                return host.run(
                    q0,
                    v0,
                    step=lengths[-1],
                    steps=segment.count * every,
                    every=every,
                    k=k,
                    t0=segment.start,
                    tolerance=NEWTON * min(1.0, settings.size),
                    consistent=consistent_tolerance(CONSISTENT, settings.size, q0),
                    observe=observe,
                )

            return run

        try:
            found = CRows(native, run_with(int), k, settings).solution(q, v, times, _shortened(times, settings))
        except IntegrationStopped as error:
            shorter = f"shorter steps than {lengths[-1]:.3g} s may pass, such as --step {lengths[-1] / 10:.2g}"
            raise SimulationError(
                f"{error} With generalised-alpha {shorter}; adaptive finds its steps itself."
            ) from error
        if not settings.checked:
            return found
        step = max(lengths)

        def run_again(way: int) -> tuple[Matrix, float]:
            lengths.clear()
            other = run_with((lambda n: max(n // 2, 1)) if way > 0 else (lambda n: 2 * n))
            plain = replace(settings, until=None, watch=None, progress=settings.progress and (lambda _: None))
            again = CRows(native, other, k, plain).solution(q, v, found.t, ())
            return again.q, max(lengths) / step

        return replace(found, notes=(*step_notes(native, found.q, step, run_again), *found.notes))

    return Integrator(native, integrate)


def ida(files: Sequence[File]) -> Integrator:
    """IDA of SUNDIALS with the stabilised form of index 2. Raises CompilerError, LibraryMissing."""
    host = Ida(files, (WITHOUT_BATCHES,))
    native = scene_of(host.native, "c_ida")

    def integrate(k: Vector, q: Vector, v: Vector, times: Vector, settings: Settings) -> Solution:
        settings.refuse_step("c_ida")
        weights = absolute_tolerances(native, settings.tolerance, settings.size, q) / settings.tolerance

        def run(q0: Vector, v0: Vector, segment: TimeSegment, observe: Observe | None) -> Integration:
            return host.run(
                q0,
                v0,
                interval=segment.interval,
                rows=segment.count + 1,
                rtol=settings.tolerance,
                weights=weights,
                k=k,
                t0=segment.start,
                consistent=consistent_tolerance(CONSISTENT, settings.size, q0),
                observe=observe,
            )

        return CRows(native, run, k, settings).solution(q, v, times, rounding_note(settings.tolerance, q))

    return Integrator(native, integrate)


def _shortened(times: Vector, settings: Settings) -> tuple[str, ...]:
    """Notes if the step that was given divides neither the intervals between rows nor those to breaks."""
    step = settings.step
    if step is None:
        return ()
    used = {
        segment.interval: segment.interval / equal_steps(segment.interval, step) for segment in time_segments(times)
    }
    notes = tuple(
        f"step: {step:g} s -> {short:.6g} s between rows that are {interval:.6g} s apart: rows are ends of steps"
        for interval, short in used.items()
        if short < step * (1 - 1e-9)
    )
    if any(segment.to_break for segment in time_segments(times, settings.breaks)):
        notes += (f"step: {step:g} s -> shorter ones where functions of time break: breaks are ends of steps",)
    return notes


def equal_steps(interval: float, step: float) -> int:
    """The number of equal steps, at most as long as `step` (s), in an interval (s) between two rows.

    Raises SimulationError if there are too many.
    """
    count = interval / step * (1 - 1e-12)
    if not count <= MAX_STEPS_PER_ROW:
        raise SimulationError(
            f"steps of {step:g} s are {count:.3g} steps between two rows, and at most {MAX_STEPS_PER_ROW:g} are taken; "
            "give a longer step, or choose an integrator with adaptive steps, such as adaptive"
        )
    return max(1, math.ceil(count))
