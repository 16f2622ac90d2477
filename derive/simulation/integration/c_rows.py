"""Rows of a solution from a C integrator: segment by segment between breaks, with progress and a stop condition."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np

from derive.runtime.integrators.c_integrator import Integration, IntegratorError
from derive.runtime.integrators.observer import Observe
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.integration.failure_diagnosis import diagnose_failure
from derive.simulation.integration.integrator import Settings
from derive.simulation.integration.solution import Cost, Solution, SolutionWriter, row_times
from derive.simulation.integration.time_segments import TimeSegment, rounding, time_segments

Run = Callable[[Vector, Vector, TimeSegment, Observe | None], Integration]
"""A function of q (nq,), v (nv,), a time segment, and an observer: a row at the start and after each interval."""


class CRows:
    """An integration of a compiled model by calls of a C integrator, one for each time segment.

    The integrator starts anew at each break of a function of time. `until` is evaluated in the rows, and where it is
    met between two of them, the integrator runs again from the first one to determine the time to rounding errors.
    """

    def __init__(self, native: NativeScene, run: Run, k: Vector, settings: Settings) -> None:
        self._native, self._run, self._k, self._settings = native, run, k, settings
        self._counts: Counter[str] = Counter()
        self._seconds = 0.0
        self._value: float | None = None  # of the function of `until` in the last row
        self._met = False

    def solution(self, q: Vector, v: Vector, times: Sequence[float] | Vector, notes: tuple[str, ...]) -> Solution:
        """The solution at `times` (n,), s, from the state q (nq,), v (nv,). Raises SimulationError."""
        settings = self._settings
        rows = SolutionWriter(self._native, self._k, row_times(times), settings.drift, True, settings.until)
        y = np.concatenate([q, v])
        rows.append(float(rows.times[0]), y)
        observe = self._observed if settings.progress or settings.until else None
        for segment in time_segments(rows.times, settings.breaks):
            run = self._called(y, segment, observe)
            states = np.hstack([run.q, run.v])
            last = len(states) - 1
            for i in range(1, last + 1 - (segment.to_break or self._met)):
                rows.append(rows.following, states[i])
            if self._met:
                first = max(last - 1, 0)
                return self._stopped(rows, float(run.t[first]), float(run.t[last]), states[first], notes)
            y = states[-1] if segment.to_break else rows.states[rows.count - 1]
        return rows.solution(self._cost(), notes)

    def _observed(self, t: float, row: Vector) -> bool:
        """Report the time (s) of a row [q; v; lambda], and whether the condition is met there."""
        settings = self._settings
        if settings.progress is not None:
            settings.progress(t)
        if settings.until is not None:
            before, self._value = self._value, settings.until.value(t, row[: self._native.nq + self._native.nv])
            self._met = before is not None and settings.until.met(before, self._value)
        return self._met

    def _stopped(self, rows: SolutionWriter, first: float, last: float, y: Vector, notes: tuple[str, ...]) -> Solution:
        """The solution that ends between two rows of the integrator at `first` and `last` (s), with y in the first."""

        def dense(t: float) -> Vector:
            if t - first <= rounding(t):
                return y
            run = self._called(y, TimeSegment(first, t - first, 1), None)
            return np.concatenate([run.q[-1], run.v[-1]])

        stop = rows.stop_time(first, last, dense)
        return rows.stopped_solution(last if stop is None else stop, dense, self._cost(), notes)

    def _called(self, y: Vector, segment: TimeSegment, observe: Observe | None) -> Integration:
        """The integration of a segment from the state y = [q; v]. Raises SimulationError."""
        nq = self._native.nq
        try:
            run = self._run(y[:nq], y[nq:], segment, observe)
        except IntegratorError as error:
            raise self._diagnosed(y, segment.start, error) from error
        self._counts.update(run.counts)
        self._seconds += run.seconds
        return run

    def _cost(self) -> Cost:
        counts = self._counts
        evaluations = counts["accelerations"] + counts["residuals"]
        return Cost(evaluations, counts["steps"], self._seconds, counts["jacobians"], dict(counts))

    def _diagnosed(self, y: Vector, t: float, error: IntegratorError) -> Exception:
        """The error that explains a failure after the last finite row that the C integrator has reached."""
        partial = error.partial
        for row in range(len(partial.t)):
            state = np.concatenate([partial.q[row], partial.v[row]])
            if not np.all(np.isfinite(state)):
                break
            t, y = float(partial.t[row]), state
        return diagnose_failure(self._native, self._k, t, y, None, str(error))
