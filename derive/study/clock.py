"""The same integration of one scene in two frames, by turns."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import median

from derive.runtime.integrators.run import FixedStep
from derive.runtime.native import NativeScene
from derive.simulation.integration.step_limit import rk4_step_limit
from derive.study.matrices import State
from derive.study.repeat import Repeater

INTEGRATION, CALLS = 0.2, 0.05
"""CPU seconds of one measurement of the integration, and of `accel` or `force` alone."""

SAFE = 0.5
"""The step is this part of the longest one for which the classical Runge-Kutta method is stable at the start."""

DRIFT = 1e-9
"""Constraints (m, rad) and their rates are kept below this: far above rounding, where corrections would be chance."""

ROWS = 32
"""About so many states of the motion are those in which functions alone are timed."""


@dataclass(frozen=True)
class Ratio:
    """Of paired measurements, first over second: median, smallest and largest."""

    median: float
    least: float
    most: float


@dataclass(frozen=True)
class Times:
    """CPU seconds of the two frames, measured by turns; medians, and ratios of the pairs.

    `step` (s), `steps` and `simulated` (s) are those of the integration: RK4 in C with projection after each step;
    `accelerations` and `corrections` are what one integration of each frame took. `per_step`, `accel` and `force` are
    seconds of a step and of a call of each frame.
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
    ways: Sequence[Callable[[], float]], runs: int, progress: Callable[[int], None] = lambda _: None
) -> list[tuple[float, ...]]:
    """What each way gives, one after the other, `runs` times: what disturbs one of a pair disturbs the other."""
    found = []
    for run in range(runs):
        progress(run)
        found.append(tuple(way() for way in ways))
    return found


def ratio(pairs: Sequence[tuple[float, float]]) -> Ratio:
    """The ratio of each pair, first over second, and their spread."""
    ratios = [a / b for a, b in pairs]
    return Ratio(median(ratios), min(ratios), max(ratios))


def times(
    hosts: tuple[FixedStep, FixedStep],
    starts: tuple[State, State],
    duration: float,
    runs: int,
    progress: Callable[[int], None],
) -> Times:
    """Time two frames by turns. Raises HostError, ModelError."""
    step = common_step(hosts, starts)
    both = list(zip(hosts, starts, strict=True))
    trial = [_run(host, start, step, min(200, math.ceil(duration / step)), 1) for host, start in both]
    cost = max(seconds for _, _, seconds in trial)
    steps = max(1, min(math.ceil(duration / step), round(INTEGRATION / cost)))
    copies = max(1, round(INTEGRATION / cost / steps))
    repeater = Repeater()
    ways: list[Callable[[], float]] = [_integration(host, start, step, steps, copies) for host, start in both]
    for function in ("accel", "force"):
        for host, start in both:
            ways.append(_calls(repeater, host, start, function, step, steps))
    rows = interleaved(ways, runs, progress)
    integration, accel, force = ([(row[i], row[i + 1]) for row in rows] for i in (0, 2, 4))
    counts = [_run(host, start, step, steps, 1)[0] for host, start in both]
    return Times(
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
    natives = map(native_of, hosts)
    limits = [rk4_step_limit(one, one.setup(), *start) for one, start in zip(natives, starts, strict=True)]
    return SAFE * min(limits)


def native_of(host: FixedStep) -> NativeScene:
    """The scene that a host integrates."""
    assert isinstance(host.native, NativeScene)
    return host.native


def _run(host: FixedStep, start: State, step: float, steps: int, copies: int) -> tuple[dict[str, int], float, float]:
    """Counts, CPU seconds, and seconds a step."""
    t, q, v = start
    states = [q] * copies, [v] * copies
    found = host.run(*states, step=step, steps=steps, every=steps, t0=t, tolerance=DRIFT)
    return found.counts, found.seconds, found.seconds / steps / copies


def _integration(host: FixedStep, start: State, step: float, steps: int, copies: int) -> Callable[[], float]:
    return lambda: _run(host, start, step, steps, copies)[2]


def _calls(
    repeater: Repeater, host: FixedStep, start: State, function: str, step: float, steps: int
) -> Callable[[], float]:
    """Calls of a function in states along the motion."""
    t, q, v = start
    every = max(1, steps // ROWS)
    rows = host.run(q, v, step=step, steps=steps, every=every, t0=t, tolerance=DRIFT)
    native = native_of(host)
    once = repeater.seconds(native, function, 100, rows.t, rows.q, rows.v)
    calls = max(1, round(CALLS / max(once, 1e-9)))
    return lambda: repeater.seconds(native, function, calls, rows.t, rows.q, rows.v)


def _medians(pairs: Sequence[tuple[float, float]]) -> tuple[float, float]:
    return median(a for a, _ in pairs), median(b for _, b in pairs)
