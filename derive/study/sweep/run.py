"""A sweep from its samples to its result: it is planned, run on an executor, and its finished samples are stored."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from pathlib import Path

import numpy as np

from derive.errors import TisserandError
from derive.progress_line import PATIENCE
from derive.spec.model.specification import Specification
from derive.study.sweep.executors import KILLS, chunk_size, outcomes
from derive.study.sweep.plan import Plan, RunOptions, make_plan
from derive.study.sweep.result import SweepResult
from derive.study.sweep.samples import Samples, SamplesError
from derive.study.sweep.store import SampleStore
from derive.study.sweep.worker import Outcome, monitored
from derive.terminal import SampleProgress, progress_of

UNKNOWN_WORKERS = 8
"""The number of workers for which samples are divided where it is not known."""

Progress = Callable[[int, int], None]
"""A function that is called with the number of finished samples, and that of all."""


class SweepFailed(TisserandError):
    """No sample of a sweep has a result."""


def sweep(
    spec: Specification,
    samples: Samples,
    outputs: Sequence[str] | str,
    *,
    duration: float | None = None,
    interval: float | None = None,
    tolerance: float | None = None,
    until: str | None = None,
    executor: Executor | None = None,
    workers: int | None = None,
    chunk: int | None = None,
    store: Path | None = None,
    resume: bool = False,
    progress: Progress | bool | None = None,
) -> SweepResult:
    """Simulate a scene or a single beam with the values of each sample, and reduce each run to a few numbers.

    Arguments:
        spec: the scene or the beam.
        samples: `grid`, `listed` or `random_samples` of parameters or keys, as `--set` knows them.
        outputs: such as "peak:slider_s", "rms:deflection" or "final:rod_phi", of columns or of plots, one or several.
        duration: the time that is simulated, s; by default that of the `simulation` of the specification.
        interval: that between rows, in which peaks are determined, s; by default likewise.
        tolerance: as for `simulate`.
        until: as for `simulate`.
        executor: any of `concurrent.futures`, such as that of a Dask client; by default processes of this machine.
        workers: the number of these processes, by default one for each processor.
        chunk: the samples that a worker gets at a time, on which no result depends.
        store: a file that keeps finished samples if the sweep is interrupted.
        resume: whether the sweep of this file is continued.
        progress: called with the number of finished samples and that of all; True shows a line with the remaining time,
            False shows none; by default notebooks show one.

    Raises:
        SpecError: if the specification is not valid, or has no duration.
        SamplesError: if samples are not those of this specification.
        OutputError: for an output that is none.
        UnknownNameError: for a parameter, a key or a column that there is not.
        CompilerError: if there is no compiler.
        StaleStore: for the store of another sweep.
        SweepFailed: if all samples fail, each for a reason of its own as in the `failures` of a result.

    Examples:
        >>> import derive
        >>> ball = derive.scene(
        ...     "flight",
        ...     gravity=(0, {"symbol": "g", "default": -10}),
        ...     bodies={"ball": {"mass": 1, "inertia": 1, "start": {"velocity": (0, 10)}}},
        ... )
        >>> result = derive.sweep(ball, derive.grid({"g": [-10, -20]}), ["peak:ball_c2"], duration=2, interval=0.5)
        >>> result["peak:ball_c2"].round(6)  # v^2 / (2 g), m
        array([ 5., 20.])
    """
    if not isinstance(samples, Samples):
        kind = type(samples).__name__
        raise SamplesError(f"samples are those of derive.grid, derive.listed or derive.random_samples, not {kind}")
    outputs = (outputs,) if isinstance(outputs, str) else outputs
    plan = make_plan(spec, samples, outputs, RunOptions(duration, interval, tolerance, until))
    with progress_of(progress, lambda: SampleProgress(plan.name, PATIENCE)) as report:
        return run_plan(plan, executor, workers, chunk, store, resume, report)


def run_plan(
    plan: Plan,
    executor: Executor | None = None,
    workers: int | None = None,
    chunk: int | None = None,
    store: Path | None = None,
    resume: bool = False,
    progress: Progress | None = None,
) -> SweepResult:
    """Run a plan; arguments and errors as those of `sweep`. The store is left, for the caller to remove."""
    kept = None if store is None else SampleStore(store, plan.identity, resume)
    done = {outcome.number: outcome for outcome in (kept.finished if kept else ())}
    resumed = len(done)
    remaining = [run for run in plan.runs if run.number not in done]
    count = workers or (UNKNOWN_WORKERS if executor else processors())
    size = chunk or chunk_size(len(remaining), count)
    report = progress or (lambda finished, total: None)
    report(resumed, len(plan.runs))
    try:
        for batch in outcomes(plan, remaining, executor, min(count, max(1, -(-len(remaining) // size))), size):
            done.update((outcome.number, outcome) for outcome in batch)
            if kept is not None:  # a sample that ended its workers is tried again by the next run
                kept.append([outcome for outcome in batch if outcome.failure != KILLS])
            report(len(done), len(plan.runs))
    finally:
        if kept is not None:
            kept.close()
    damaged = kept.damaged if kept else 0
    return _result(plan, [done[number] for number in range(len(plan.runs))], resumed, damaged)


def processors() -> int:
    """The number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _result(plan: Plan, done: Sequence[Outcome], resumed: int, damaged: int) -> SweepResult:
    failures = {outcome.number: outcome.failure for outcome in done if outcome.failure}
    if len(failures) == len(done):
        first = plan.samples.names, plan.samples.values[0].tolist()
        where = ", ".join(f"{name} = {value:g}" for name, value in zip(*first, strict=True))
        raise SweepFailed(f"none of the {len(done)} samples can be run; that of {where}: {failures[0]}")
    values = np.array([outcome.values for outcome in done], dtype=np.float64).reshape(len(done), -1)
    largest = {int(np.nanargmax(np.abs(column))) for column in values.T}
    return SweepResult(
        plan.name,
        plan.samples,
        plan.outputs,
        values,
        failures,
        {outcome.number: outcome.notes for outcome in done if outcome.notes},
        monitored(plan.chunk(sorted((run for run in plan.runs if run.number in largest), key=lambda r: r.number))),
        len(plan.models),
        plan.initial_states,
        plan.units,
        resumed,
        damaged,
    )
