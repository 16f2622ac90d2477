"""The runs of a ladder by integrators with fixed steps, beside those of the adaptive one."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from statistics import median

import numpy as np

from derive.errors import TisserandError, first_line
from derive.remaining_time import RemainingTime
from derive.simulation.integration.integrator import Integrator, Settings
from derive.simulation.integration.registry import INTEGRATORS
from derive.simulation.integration.solution import Solution
from derive.simulation.integration.step_limit import RK4_LIMIT, natural_frequencies
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.scene_start import size_of
from derive.simulation.trajectory import RunSettings, Trajectory
from derive.spec.model.plots import Plot
from derive.spec.model.scene_functions import breaks
from derive.study.accuracy.measurement import CompiledLadderModel, Line, Point, Progress, plot_errors
from derive.study.timing import interleaved

STABLE = (0.8, 0.4, 0.2)
"""Steps of the classical Runge-Kutta method, relative to the longest that is stable in the initial state."""
PER_PERIOD = (25, 50, 100, 200)
"""Numbers of steps of the generalised-alpha method in the longest period of the initial state."""
NO_MOTION = 1e-6
"""Frequencies below this part of the highest are those of rigid motion."""


def fixed_step_lines(
    ready: Sequence[CompiledLadderModel],
    integrators: Sequence[str],
    plots: Sequence[Plot],
    runs: int,
    progress: Progress,
) -> list[Line]:
    """The lines of compiled models with these integrators. Their warnings are those of the adaptive runs."""
    lines, clocks = [], list[Callable[[], float]]()
    every = RemainingTime(len(ready) * len(integrators))
    for of in ready:
        for name in integrators:
            progress(f"line {every.next()}: {of.model.label} with {name} ...")
            line, runnable = _line(of, name, plots)
            lines.append(line)
            clocks += runnable
    remaining = RemainingTime(runs)
    rows = interleaved(clocks, runs, lambda _: progress(f"timing, run {remaining.next()} ...")) if clocks else []
    times = iter([(median(of), min(of), max(of)) for of in zip(*rows, strict=True)])
    return [replace(of, points=tuple(replace(p, seconds=next(times)) for p in of.points)) for of in lines]


def _line(of: CompiledLadderModel, name: str, plots: Sequence[Plot]) -> tuple[Line, list[Callable[[], float]]]:
    """The line of a model with an integrator, without times, and the functions that measure them."""
    points, clocks = list[Point](), list[Callable[[], float]]()
    try:
        integrator = INTEGRATORS[name](of.files)
        steps = _steps(of, name)
    except TisserandError as error:
        return Line(of.model, of.coordinates, (), failure=first_line(error), integrator=name), []
    for step in steps:
        try:
            solution = _solution(of, integrator, step)
            rms, worst = plot_errors(plots, _trajectory(of, solution))
        except TisserandError as error:
            failure = f"step {step:.3g} s: {first_line(error)}"
            return Line(of.model, of.coordinates, tuple(points), failure=failure, integrator=name), clocks
        cost = solution.cost
        operations = of.operations(cost.calls) if name == "rk4" else 0
        points.append(Point(0.0, rms, worst, (cost.seconds,) * 3, cost.evaluations, operations, step))
        clocks.append(partial(_seconds, of, integrator, step))
    return Line(of.model, of.coordinates, tuple(points), integrator=name), clocks


def _steps(of: CompiledLadderModel, name: str) -> list[float]:
    """The steps from long to short, s: parts of the stable step, of the longest period, or of the whole motion."""
    simulation = of.scene.simulation
    assert simulation is not None
    frequencies = natural_frequencies(of.native, of.k, 0.0, of.start.q, of.start.v)
    elastic = frequencies[frequencies > NO_MOTION * np.max(frequencies, initial=0.0)]
    if not len(elastic):
        return [simulation.duration / n for n in PER_PERIOD]
    if name == "rk4":
        return [part * RK4_LIMIT / float(elastic[-1]) for part in STABLE]
    return [2 * np.pi / float(elastic[0]) / n for n in PER_PERIOD]


def _solution(of: CompiledLadderModel, integrator: Integrator, step: float) -> Solution:
    simulation = of.scene.simulation
    assert simulation is not None
    steps = max(1, math.ceil(simulation.duration / step))
    rows = max(1, steps // max(1, round(simulation.output / step)))  # as many as specified, at ends of steps
    times = np.linspace(0.0, simulation.duration, rows + 1)
    settings = Settings(size=size_of(of.scene), step=step, breaks=breaks(of.scene))
    return integrator.integrate(of.k, of.start.q, of.start.v, times, settings)


def _seconds(of: CompiledLadderModel, integrator: Integrator, step: float) -> float:
    return _solution(of, integrator, step).cost.seconds


def _trajectory(of: CompiledLadderModel, solution: Solution) -> Trajectory:
    assert of.scene.simulation is not None
    moved = SceneMotion(of.scene, of.native, of.k, solution.t, solution.q, solution.v)
    return Trajectory(of.scene, of.columns, of.start, moved, solution, RunSettings(of.scene.simulation), ())
