"""CPU time of the same integration of one scene in two frames, measured in interleaved runs."""

from __future__ import annotations

import ctypes
import math
import platform
import subprocess
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import numpy as np

from derive.runtime.compiler import FLAGS, compile_shared, compiler
from derive.runtime.integrators.fixed_step import FixedStep
from derive.runtime.native_call import Matrix, ModelError, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.integration.step_limit import rk4_step_limit
from derive.study.states import State

INTEGRATION, CALLS = 0.2, 0.05
"""CPU seconds of one measurement of the integration, and of `accel` or `force` alone."""

STABLE = 0.5
"""The step, divided by the longest one for which the classical Runge-Kutta method is stable in the initial state."""

DRIFT = 1e-9
"""The limit of constraints (m, rad) and their rates: far above rounding errors, where corrections would be random."""

ROWS = 32
"""The approximate number of states of the motion in which single functions are timed."""


@dataclass(frozen=True)
class Ratio:
    """The ratios of paired measurements, first over second: median, smallest and largest."""

    median: float
    least: float
    most: float


@dataclass(frozen=True)
class InterleavedTimes:
    """CPU seconds in two frames, from interleaved measurements: medians, and ratios of the pairs.

    step (s), steps, simulated (s): those of the integration, RK4 in C with projection after each step. accelerations,
    corrections: evaluations of one integration in each frame. per_step, accel, force: seconds of a step and of a call
    in each frame.
    """

    runs: int
    step: float
    steps: int
    simulated: float
    accelerations: tuple[int, int]
    corrections: tuple[int, int]
    per_step: tuple[float, float]
    accel: tuple[float, float]
    force: tuple[float, float]
    integration_ratio: Ratio
    accel_ratio: Ratio
    force_ratio: Ratio


def interleaved(
    measurements: Sequence[Callable[[], float]], runs: int, progress: Callable[[int], None] = lambda _: None
) -> list[tuple[float, ...]]:
    """Take all measurements in turn, `runs` times, so that a disturbance affects all measurements of a run alike."""
    results = []
    for run in range(runs):
        progress(run)
        results.append(tuple(measure() for measure in measurements))
    return results


def ratio(pairs: Sequence[tuple[float, float]]) -> Ratio:
    """The ratio of each pair, first over second, and their spread."""
    ratios = [a / b for a, b in pairs]
    return Ratio(median(ratios), min(ratios), max(ratios))


def interleaved_times(
    hosts: tuple[FixedStep, FixedStep],
    starts: tuple[State, State],
    duration: float,
    runs: int,
    progress: Callable[[int], None],
) -> InterleavedTimes:
    """The times of the same integration in two frames. Raises IntegratorError, ModelError."""
    step = common_step(hosts, starts)
    both = list(zip(hosts, starts, strict=True))
    trial = [_run(host, start, step, min(200, math.ceil(duration / step)), 1) for host, start in both]
    cost = max(seconds for _, _, seconds in trial)
    steps = max(1, min(math.ceil(duration / step), round(INTEGRATION / cost)))
    copies = max(1, round(INTEGRATION / cost / steps))
    repeater = RepeatedCalls()
    measurements: list[Callable[[], float]] = [_integration(host, start, step, steps, copies) for host, start in both]
    for function in ("accel", "force"):
        for host, start in both:
            measurements.append(_calls(repeater, host, start, function, step, steps))
    rows = interleaved(measurements, runs, progress)
    integration, accel, force = ([(row[i], row[i + 1]) for row in rows] for i in (0, 2, 4))
    counts = [_run(host, start, step, steps, 1)[0] for host, start in both]
    return InterleavedTimes(
        runs,
        step,
        steps,
        steps * step,
        (counts[0]["accelerations"], counts[1]["accelerations"]),
        (counts[0]["corrections"], counts[1]["corrections"]),
        _medians(integration),
        _medians(accel),
        _medians(force),
        ratio(integration),
        ratio(accel),
        ratio(force),
    )


def common_step(hosts: Sequence[FixedStep], starts: Sequence[State]) -> float:
    """A step (s) that is stable in every frame."""
    natives = [host.native for host in hosts]
    limits = [rk4_step_limit(native, native.setup(), *start) for native, start in zip(natives, starts, strict=True)]
    return STABLE * min(limits)


def _run(host: FixedStep, start: State, step: float, steps: int, copies: int) -> tuple[dict[str, int], float, float]:
    """Run an integration; returns the counts, the CPU seconds, and the seconds per step."""
    t, q, v = start
    states = [q] * copies, [v] * copies
    result = host.run(*states, step=step, steps=steps, every=steps, t0=t, tolerance=DRIFT)
    return result.counts, result.seconds, result.seconds / steps / copies


def _integration(host: FixedStep, start: State, step: float, steps: int, copies: int) -> Callable[[], float]:
    return lambda: _run(host, start, step, steps, copies)[2]


def _calls(
    repeater: RepeatedCalls, host: FixedStep, start: State, function: str, step: float, steps: int
) -> Callable[[], float]:
    """A measurement of calls of a function in states along the motion."""
    t, q, v = start
    every = max(1, steps // ROWS)
    rows = host.run(q, v, step=step, steps=steps, every=every, t0=t, tolerance=DRIFT)
    native = host.native
    once = repeater.seconds(native, function, 100, rows.t, rows.q, rows.v)
    calls = max(1, round(CALLS / max(once, 1e-9)))
    return lambda: repeater.seconds(native, function, calls, rows.t, rows.q, rows.v)


def _medians(pairs: Sequence[tuple[float, float]]) -> tuple[float, float]:
    return median(a for a, _ in pairs), median(b for _, b in pairs)


SOURCE = """\
typedef int function(double t, const double *q, const double *v, const double *k, double *result);

int repeat(function *f, long calls, long states, int nq, int nv, const double *t, const double *q, const double *v,
           const double *k, double *result)
{
    for (long i = 0, s = 0; i < calls; i++, s = s + 1 < states ? s + 1 : 0) {
        const int code = f(t[s], q + s * nq, v + s * nv, k, result);
        if (code != 0) {
            return code;
        }
    }
    return 0;
}
"""
"""The C source of a loop that calls a function f(t, q, v, k) in one state after the other, cyclically."""


class RepeatedCalls:
    """Calls a function of a compiled model repeatedly from a compiled loop, without the overhead of Python."""

    def __init__(self) -> None:
        with tempfile.TemporaryDirectory(prefix="tisserand-") as folder:
            source = Path(folder) / "repeat.c"
            source.write_text(SOURCE, encoding="utf-8")
            self._library = ctypes.CDLL(str(compile_shared([source], Path(folder) / "repeat.so")))
        long, whole, address = ctypes.c_long, ctypes.c_int, ctypes.c_void_p
        self._library.repeat.argtypes = [address, long, long, whole, whole, *[address] * 5]

    def seconds(self, native: NativeScene, function: str, calls: int, t: Vector, q: Matrix, v: Matrix) -> float:
        """CPU seconds per call of `accel` or `force`, over `calls` calls in the states t (n,), q (n, nq), v (n, nv).

        Raises ModelError.
        """
        address = ctypes.cast(native.function(function), ctypes.c_void_p)
        arrays = [np.ascontiguousarray(x) for x in (t, q, v, native.setup())] + [np.empty(native.nv)]
        given = [x.ctypes.data for x in arrays]
        before = time.thread_time()
        code = self._library.repeat(address, calls, len(t), native.nq, native.nv, *given)
        taken = time.thread_time() - before
        if code:
            raise ModelError(f"{native.name}_{function}", code)
        return taken / calls


def machine_description(flags: Sequence[str] = FLAGS) -> dict[str, str]:
    """The compiler, flags and processor, on which times depend, without names of machines and paths."""
    return {"compiler": _compiler(), "flags": " ".join(flags), "machine": _machine()}


def _compiler() -> str:
    done = subprocess.run([*compiler(), "--version"], capture_output=True, text=True, check=False)
    return done.stdout.splitlines()[0] if done.stdout else "unknown"


def _machine() -> str:
    info = Path("/proc/cpuinfo")
    fields = (
        dict(line.split(":", 1) for line in info.read_text(encoding="utf-8").splitlines() if ":" in line)
        if info.exists()
        else {}
    )
    model = {key.strip(): value.strip() for key, value in fields.items()}.get("model name", "")
    return ", ".join(part for part in (model, platform.system(), platform.machine()) if part)
