"""The study of accuracy: a ladder of models of a scene is run and compared with a reference, and its runs are timed."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from derive.simulation.inputs import with_functions
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.beside import beside, ladders
from derive.study.accuracy.fixed_steps import fixed_step_lines
from derive.study.accuracy.ladder_chart import LadderChart
from derive.study.accuracy.ladder_run import LadderRun
from derive.study.accuracy.measurement import LADDER_FLAGS, Line, ModelVariant, preparation, retimed
from derive.study.accuracy.peers import read_peers
from derive.study.accuracy.reference import compared_plot, plotted_beams, reference, undeformed_note
from derive.study.accuracy.spatial_ladder import linear_reference
from derive.study.computed_ahead import available_workers
from derive.study.studied_scene import COMPARED, flexible_scene
from derive.study.study_options import (
    ACCURACY,
    ERROR,
    FIXED_STEPS,
    RUNS,
    TOLERANCES,
    LadderRange,
    among,
    fraction,
    several,
    whole,
)
from derive.study.timing import machine_description
from derive.terminal import Report, reports_of

BETWEEN = 60.0
"""The time (s) between two records of the part of the ladder that is finished."""

FINER = 0.5
"""The error of a reference from models over the requested one, below which no finer model is run."""

Record = Callable[[LadderChart], None]


def study_accuracy(
    scene: AnyScene,
    *,
    plot: str | None = None,
    error: float = ERROR,
    reference_error: float | None = None,
    own_reference: bool = False,
    orders: Sequence[str] = ACCURACY.orders,
    frames: Sequence[str] = ACCURACY.frames,
    shapes: Sequence[int] = ACCURACY.shapes,
    pieces: Sequence[int] = ACCURACY.pieces,
    sines: Sequence[int] = ACCURACY.sines,
    modes: Sequence[str] = ACCURACY.modes,
    torsion: Sequence[int] = ACCURACY.torsion,
    component_modes: Sequence[str] = ACCURACY.component_modes,
    component_counts: Sequence[int] = ACCURACY.component_counts,
    tolerances: Sequence[float] = TOLERANCES,
    integrators: Sequence[str] = (),
    also: Sequence[AnyScene] = (),
    peers: str | Path | None = None,
    runs: int = RUNS,
    progress: Report | bool | None = None,
    record: Record | None = None,
) -> LadderChart:
    """Run a ladder of models of the flexible bodies of a scene: the error of each against what it costs.

    The command `tisserand study accuracy` calls this function. Times are CPU times of the integration; compiling is
    left out.

    Arguments:
        scene: a scene, in the plane or in space, with a beam or a finite-element body, a simulation and a plot.
        plot: the name of the plot that is compared; by default the first one.
        error: the largest error (rms) that is allowed, relative to the peak of the plot.
        reference_error: the error (rms) of the reference of the plot itself, relative to its peak, if it is known.
        own_reference: whether ever finer models are the reference in place of the curve that the plot refers to.
        orders: those of the displacements, among "first", "truncated" and "full".
        frames: those of polynomials, among "mean", "chord", "point" and "tangent".
        shapes: the numbers of polynomials of one beam, in space of each of its planes.
        pieces: the numbers of beams, with two polynomials each, into which a beam is divided.
        sines: the numbers of half sine waves of one beam.
        modes: other natural modes in the same numbers, among "free-free" and "clamped-free".
        torsion: the numbers of shapes of torsion of a beam in space; by default as the scene has them.
        component_modes: modes of finite-element bodies, among "free", "craig_bampton" and "attachment".
        component_counts: the numbers of these modes, beside the static ones of the interface.
        tolerances: those of the adaptive integrator, with each of which every model is run.
        integrators: integrators with fixed steps beside it, among "rk4" and "generalised-alpha".
        also: scenes with other bodies in place of these, such as a beam in place of a finite-element body, whose models
            are compared with the same reference in the same plot.
        peers: a CSV file of runs of other programs, with the columns model, cpu_s, rms_error and largest_error.
        runs: the number of measurements of the time of each run.
        progress: called with a line of text on each step; True shows a line with the remaining time, False shows none;
            by default notebooks show one.
        record: called now and then with the finished part of the ladder, and with what there is before a
            KeyboardInterrupt, which ends the study.

    Raises:
        SpecError: if the scene has no flexible body, no plot or no simulation, or there is no such plot.
        UnknownNameError: for an order, a frame, modes or an integrator that there is not.
        ValueError: for a number out of its range.
        TypeError: for what is no scene.
        SimulationError: if the reference cannot be computed.
        CompilerError: if there is no compiler.
        WrongPeers: if the file of other programs cannot be used.

    Examples:
        >>> import derive
        >>> arm = derive.scene(
        ...     "arm",
        ...     gravity=(0, -9.81),
        ...     ground={"hub": [0, 0]},
        ...     bodies={"arm": {"mass": 1, "length": 1, "bending_stiffness": 20, "markers": {"root": -1, "tip": 1}}},
        ...     joints={"hub": {"kind": "revolute", "between": ["ground.hub", "arm.root"]}},
        ...     outputs={"tip": {"kind": "position", "marker": "arm.tip"}},
        ...     plots={"height": {"y": "tip_2"}},
        ...     simulation={"duration": 0.3, "output": 0.01},
        ... )
        >>> study = derive.study_accuracy(arm, orders=["first"], shapes=[2], pieces=[], sines=[1], runs=1)
        >>> [line.model.label for line in study.lines]
        ['rigid', '1 sine, first', '1 beam, P2, P3, first']
    """
    limits = LadderRange(orders, frames, shapes, pieces, sines, modes, torsion, component_modes, component_counts)
    integrators = among("integrator with fixed steps", integrators, FIXED_STEPS)
    fractions = {fraction("tolerances", tolerance) for tolerance in several("tolerances", tolerances)}
    error, runs = fraction("error", error), whole("runs", runs)
    if reference_error is not None:
        fraction("reference_error", reference_error)
    given = with_functions(flexible_scene(scene, COMPARED.format("accuracy")), {})
    compared = replace(given, plots=(compared_plot(given, plot),))
    others = tuple(beside(other, compared) for other in several("also", also))
    models = ladders((compared, *others), limits)
    foreign = read_peers(Path(peers)) if peers else ()
    sorted_tolerances = sorted(fractions, reverse=True)
    with reports_of(progress, given.name) as (task, result), preparation(compared, available_workers()) as ahead:
        variants = [ModelVariant(model, explicit=not integrators) for model in models[0]]
        known = reference(
            compared, compared.plots[0], reference_error, own_reference, task, result, ahead, FINER * error, variants
        )
        shown = plotted_beams(compared.plots[0], compared)
        from_models = compared.plots[0].reference is None or own_reference
        notes = linear_reference(compared) if from_models else ()
        notes += undeformed_note([compared.plots[0].name], known.error) if from_models else ()
        empty = LadderChart(compared.name, (), known, error, _machine(), foreign, shown, notes)
        ladder_runs = [LadderRun(compared, known, sorted_tolerances, not integrators, ahead)]
        finished = _Finished(empty, ladder_runs, record)
        try:
            ladder_runs[0].run(models[0], task, result, finished.record_now_and_then)
            ahead.close()
            for other, own in zip(others, models[1:], strict=True):
                with preparation(other, available_workers()) as ahead_of_other:
                    ladder_runs.append(LadderRun(other, known, sorted_tolerances, not integrators, ahead_of_other))
                    ladder_runs[-1].run(own, task, result, finished.record_now_and_then)
            ready = {model: of for ladder_run in ladder_runs for model, of in ladder_run.ready.items()}
            lines = retimed(finished.lines, ready, runs, task)
            fixed = fixed_step_lines(list(ready.values()), integrators, known.plots, runs, task)
        except KeyboardInterrupt:
            finished.record_interruption(sum(map(len, models)))
            raise
    adaptive = {line.model: line for line in lines}
    doubts = [adaptive[of.model] for of in fixed]
    every = (
        *lines,
        *(
            replace(of, warning=doubt.warning, missed=doubt.missed, spins=doubt.spins)
            for of, doubt in zip(fixed, doubts, strict=True)
        ),
    )
    return replace(empty, lines=every, notes=finished.notes)


class _Finished:
    """The part of ladders that is finished, for those who want a record of it."""

    def __init__(self, empty: LadderChart, ladder_runs: Sequence[LadderRun], record: Record | None) -> None:
        self._empty, self._ladders, self._record, self._last = empty, ladder_runs, record, time.monotonic()

    @property
    def lines(self) -> list[Line]:
        """The models that have run."""
        return [line for ladder_run in self._ladders for line in ladder_run.lines]

    @property
    def notes(self) -> tuple[str, ...]:
        """The notes on the reference, and those of all ladders."""
        return (*self._empty.notes, *(note for ladder_run in self._ladders for note in ladder_run.notes))

    def record_now_and_then(self) -> None:
        """Record the part after a while."""
        if time.monotonic() - self._last > BETWEEN:
            self._note("unfinished: more models are being run")
            self._last = time.monotonic()

    def record_interruption(self, models: int) -> None:
        """Record the part of ladders of `models` models before their study ends, if there are runs."""
        missing = models - sum(ladder_run.count for ladder_run in self._ladders)
        if any(line.points for line in self.lines):
            self._note(f"interrupted: {missing} models were not run" if missing > 0 else "interrupted")

    def _note(self, note: str) -> None:
        if self._record is not None:
            self._record(replace(self._empty, lines=tuple(self.lines), notes=(*self.notes, note)))


def _machine() -> str:
    """The processor, the compiler and its flags in a line."""
    known = machine_description(LADDER_FLAGS)
    return f"{known['machine']}; {known['compiler']}, {known['flags']}"
