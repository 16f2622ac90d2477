"""The runs of a ladder: one compiled model, integrated with several tolerances, with its motion and its cost."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from statistics import median
from typing import NamedTuple

import numpy as np

from derive.artifacts import File
from derive.errors import TisserandError, first_line
from derive.generated_models import generated, generated_explicit, load_derivation
from derive.ir.model import Model
from derive.percentages import implied_percent, percent
from derive.remaining_time import RemainingTime
from derive.runtime.compiler import QUICK_FLAGS
from derive.runtime.integrators.adaptive import Adaptive, AdaptiveRun
from derive.runtime.integrators.c_integrator import CONSISTENT
from derive.runtime.interpreted_scene import with_iteration_matrix
from derive.runtime.loading import load_data, model_library
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.initial.initial_state import InitialState
from derive.simulation.integration.adaptive import adaptive
from derive.simulation.integration.integrator import Integrator, Settings
from derive.simulation.integration.solution import Solution
from derive.simulation.integration.tolerances import absolute_tolerances, consistent_tolerance
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.observables.plots import PlotCurve, plot_curves
from derive.simulation.output_times import output_times
from derive.simulation.redundant_joints import with_redundant_joints
from derive.simulation.scene_start import size_of, state_of
from derive.simulation.trajectory import RunSettings, Trajectory
from derive.simulation.validity.axial_loads import missing_stiffness_notes
from derive.simulation.validity.measure import validity
from derive.simulation.validity.mode_content import ModeError, mode_errors
from derive.simulation.validity.monitoring_outputs import with_monitors
from derive.simulation.validity.monitors import ERROR_LIMIT, Monitor
from derive.simulation.validity.watched_beam import scene_watch
from derive.spec.model.beam_pieces import in_pieces
from derive.spec.model.plots import Plot
from derive.spec.model.scene_functions import breaks
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import LadderModel
from derive.study.accuracy.models import model_scene
from derive.study.computed_ahead import ComputedAhead
from derive.study.timing import interleaved

Curves = tuple[PlotCurve, ...]

CALLED = {
    "accelerations": ("accel",),
    "constraints": ("constraints", "constraint_rates"),
    "corrections": ("project_velocity",),
}
"""The functions of a model that an evaluation of each count calls."""

SAME = 0.01
"""Errors of runs with two tolerances that differ by less, relatively, are those of the model."""
LONG = 0.5
"""CPU seconds from which on a run is timed only once, as disturbances are small against it."""
NEARLY = 0.5
"""The part of `LONG` from which on a run may take so long."""


@dataclass(frozen=True, eq=False)
class CompiledLadderModel:
    """A model of a ladder that is ready to run: its scene, its code, its consistent start.

    columns: the code without the outputs that monitor its validity. files: the generated files.
    """

    model: LadderModel
    scene: AnyScene
    code: Model
    files: tuple[File, ...]
    columns: Model
    native: NativeScene
    k: Vector
    start: InitialState

    @property
    def coordinates(self) -> int:
        """The number of coordinates."""
        return int(self.native.nq)

    def operations(self, counts: Mapping[str, int]) -> int:
        """Arithmetic operations of the evaluations of an explicit method, factorisations and projections included."""
        known = {kernel.name: kernel.operations for kernel in self.code.kernels}
        called = ((counts[count], name) for count, names in CALLED.items() for name in names)
        return sum(times * known.get(name, 0) for times, name in called)


LADDER_FLAGS = QUICK_FLAGS
"""Compiler options of models whose runs are timed: straight-line code runs as fast with -O1 as with -O2, within 1 %,
and the compiler takes a third less. Charts state them."""


class ModelVariant(NamedTuple):
    """A model of a ladder as it is compiled.

    monitored: with the outputs that watch its validity. explicit: for `adaptive` alone. flags: of the compiler.
    """

    model: LadderModel
    monitored: bool = True
    explicit: bool = True
    flags: tuple[str, ...] = LADDER_FLAGS


@dataclass(frozen=True, eq=False)
class PreparedModel:
    """A model of a ladder that is derived and compiled, with its consistent start; it can be sent to another process.

    own: the number of outputs without those that monitor its validity. name, library: of the compiled code.
    """

    variant: ModelVariant
    scene: AnyScene
    code: Model
    files: tuple[File, ...]
    own: int
    name: str
    library: bytes
    start: InitialState


def prepared(scene: AnyScene, variant: ModelVariant) -> PreparedModel:
    """A model of a scene, derived and compiled. Raises SpecError, SimulationError, CompilerError."""
    changed = in_pieces(model_scene(scene, variant.model))
    return with_redundant_joints(changed, lambda changed: _prepared(changed, variant))


def _prepared(changed: AnyScene, variant: ModelVariant) -> PreparedModel:
    """The model of a scene that has been changed to it."""
    complete = with_monitors(changed) if variant.monitored else changed
    code, files = generated_explicit(complete) if variant.explicit else generated(complete)
    name, library = model_library(files, variant.flags)
    native = with_iteration_matrix(NativeScene(load_data(library), name), code)
    own = len(code.outputs) - len(complete.outputs) + len(changed.outputs)
    start = state_of(changed, native, native.setup())
    return PreparedModel(variant, changed, code, tuple(files), own, name, library, start)


def opened(of: PreparedModel) -> CompiledLadderModel:
    """A prepared model, ready to run in this process."""
    native = NativeScene(load_data(of.library), of.name)
    columns = replace(of.code, outputs=of.code.outputs[: of.own])
    return CompiledLadderModel(of.variant.model, of.scene, of.code, of.files, columns, native, native.setup(), of.start)


Preparation = ComputedAhead[ModelVariant, PreparedModel]
"""The models of one scene, which are prepared ahead."""


def preparation(scene: AnyScene, workers: int = 0) -> Preparation:
    """The models of a scene, prepared in that many processes before they are needed."""
    return ComputedAhead(partial(prepared, scene), workers, load_derivation)


def compiled(
    scene: AnyScene, model: LadderModel, monitored: bool = True, flags: tuple[str, ...] = LADDER_FLAGS
) -> CompiledLadderModel:
    """A model of a scene that is ready to run. Raises SpecError, SimulationError, CompilerError."""
    return opened(prepared(scene, ModelVariant(model, monitored, flags=flags)))


def motion(of: CompiledLadderModel, tolerance: float, monitored: bool = False) -> Trajectory:
    """The motion over the time of the simulation, with the monitors of its validity. Raises SimulationError."""
    simulation = of.scene.simulation
    assert simulation is not None
    watch = scene_watch(of.scene, of.native, of.k, 0.0, of.start.q, of.start.v).watch if monitored else None
    settings = Settings(tolerance=tolerance, size=size_of(of.scene), breaks=breaks(of.scene), watch=watch)
    integrator = adaptive(of.native, through_python=_no_python)
    times = output_times(simulation)
    solution: Solution = integrator.integrate(of.k, of.start.q, of.start.v, times, settings)
    moved = SceneMotion(of.scene, of.native, of.k, solution.t, solution.q, solution.v)
    run = RunSettings(simulation, "adaptive")
    monitors = validity(moved, solution.watched) if monitored else ()
    return Trajectory(of.scene, of.columns, of.start, moved, solution, run, monitors)


def _no_python(_: NativeScene) -> Integrator:
    raise AssertionError("a ladder has no functions in Python")


def end_run(of: CompiledLadderModel, tolerance: float) -> AdaptiveRun:
    """The integration of `motion` without rows in between, whose cost is measured. Raises AdaptiveError."""
    assert of.scene.simulation is not None
    size = size_of(of.scene)
    return Adaptive(of.native).run(
        of.start.q,
        of.start.v,
        np.array([0.0, of.scene.simulation.duration]),
        rtol=tolerance,
        atol=absolute_tolerances(of.native, tolerance, size, of.start.q),
        k=of.k,
        consistent=consistent_tolerance(CONSISTENT, size, of.start.q),
        breaks=breaks(of.scene),
    )


@dataclass(frozen=True)
class Point:
    """A run of a model: its error against the reference, and its cost.

    tolerance: that of the adaptive method; of others it is 0, and they have a step, s. rms, worst: of the quantity,
    divided by the peak of the reference. seconds: median, least and largest CPU time of interleaved runs. evaluations:
    of the accelerations, or of the residuals; operations: arithmetic ones of all evaluations, 0 where they are not
    known because a library factorises.
    """

    tolerance: float
    rms: float
    worst: float
    seconds: tuple[float, float, float]
    evaluations: int
    operations: int
    step: float = 0.0

    @property
    def setting(self) -> str:
        """The tolerance, or the step."""
        return f"step {self.step:.3g} s" if self.step else f"tolerance {self.tolerance:g}"


@dataclass(frozen=True)
class Line:
    """A model with its runs, from coarse to fine.

    warning: the monitor with the largest implied error, of those that are beyond their limits in the finest run, if
    there is one. failure: why a run failed, or why there is none; empty if there is nothing. integrator: the method of
    its runs. spins: the notes on finite-element bodies that spin fast or are loaded along, by their names. missed: the
    finite-element bodies of which a run notes that their modes do not suffice, in the finest run; a model stays valid,
    as a run has no warning then. curves: those of the plots in the finest run.
    """

    model: LadderModel
    coordinates: int
    points: tuple[Point, ...]
    warning: Monitor | None = None
    failure: str = ""
    integrator: str = "adaptive"
    spins: Mapping[str, str] = field(default_factory=dict, hash=False)
    missed: tuple[ModeError, ...] = ()
    curves: Curves = field(default=(), repr=False, compare=False)

    @property
    def label(self) -> str:
        """The model, and the integrator if it is another one."""
        return self.model.label + (f", {self.integrator}" if self.integrator != "adaptive" else "")

    @property
    def valid(self) -> bool:
        """Whether the model has run without failure, and no monitor warns."""
        return self.warning is None and not self.failure

    @property
    def noted(self) -> bool:
        """Whether a run notes that finite-element bodies miss modes, or stiffness that loads or spin add."""
        return bool(self.spins or self.missed)

    @property
    def implied(self) -> float | None:
        """The largest error that a warning or a note implies; None if there is none."""
        return max((of.error for of in (self.warning, *self.missed) if of is not None), default=None)

    @property
    def best(self) -> float:
        """The root mean square error of the finest run."""
        return self.points[-1].rms

    @property
    def outcome(self) -> str:
        """The text of the result: error, implied error and time of the finest run, and a failure."""
        if not self.points:
            return self.failure
        implied = "" if self.implied is None else f", a monitor implies {implied_percent(self.implied)}"
        failure = f"; {self.failure}" if self.failure else ""
        return f"{percent(self.best)}{implied} in {1e3 * self.points[-1].seconds[0]:.3g} ms{failure}"


Progress = Callable[[str], None]


def measured(
    of: CompiledLadderModel,
    plots: Sequence[Plot],
    tolerances: Sequence[float],
    alone: Callable[[], None] = lambda: None,
) -> Line:
    """The line of a compiled model: its errors against the references of `plots`, and its cost, in one run each.

    tolerances: from coarse to fine. Those beyond two runs with about the same error are left out: they cost more, and
    the error is that of the model. alone: called before a run whose time is not measured again, see `retimed`, so that
    nothing else runs beside it.
    """
    points: list[Point] = []
    warning, failure, spins, missed, curves = None, "", dict[str, str](), tuple[ModeError, ...](), Curves()
    for tolerance in tolerances:
        try:
            moved = motion(of, tolerance, monitored=True)
            rms, worst = plot_errors(plots, moved)
            if moved.solution.cost.seconds > NEARLY * LONG:
                alone()
            run = end_run(of, tolerance)
        except TisserandError as error:
            warning, missed, failure = None, (), f"tolerance {tolerance:g}: {first_line(error)}"
            break
        q, v, curves = moved.solution.q, moved.solution.v, curves_of(plots, moved)
        spins = missing_stiffness_notes(of.scene, of.native, of.k, moved.solution.t, q, v, beams=False)
        errors = mode_errors(of.scene, of.native, of.k, moved.solution.t, q, v)
        missed = tuple(error for error in errors if error.error > ERROR_LIMIT)
        cost = run.counts["accelerations"], of.operations(run.counts)
        points.append(Point(tolerance, rms, worst, (run.seconds,) * 3, *cost))
        warning = max((m for m in moved.validity if m.passed), key=lambda monitor: monitor.error, default=None)
        if len(points) > 1 and abs(points[-2].rms - rms) <= SAME * rms:
            break
    return Line(of.model, of.coordinates, tuple(points), warning, failure, spins=spins, missed=missed, curves=curves)


def retimed(
    lines: Sequence[Line], ready: Mapping[LadderModel, CompiledLadderModel], runs: int, progress: Progress
) -> list[Line]:
    """The lines with the CPU times of interleaved runs; runs that take long are not repeated, and keep their time."""
    timed = [(line, p) for line in lines for p in line.points if p.seconds[0] < LONG]
    clocks = [partial(_seconds, ready[line.model], p.tolerance) for line, p in timed]
    remaining = RemainingTime(runs)
    rows = interleaved(clocks, runs, lambda _: progress(f"timing, run {remaining.next()} ...")) if clocks else []
    times = {
        (line.model, p.tolerance): (median(of), min(of), max(of))
        for (line, p), of in zip(timed, zip(*rows, strict=True), strict=True)
    }
    return [
        replace(
            line,
            points=tuple(replace(p, seconds=times.get((line.model, p.tolerance), p.seconds)) for p in line.points),
        )
        for line in lines
    ]


def _seconds(of: CompiledLadderModel, tolerance: float) -> float:
    return end_run(of, tolerance).seconds


def plot_errors(plots: Sequence[Plot], moved: Trajectory) -> tuple[float, float]:
    """The largest errors of the curves of plots. Raises TisserandError where there is no part in common."""
    known = []
    for plot in plots:
        for curve in curves_of([plot], moved):
            if curve.error is None:
                raise NothingInCommon(f"{plot.name}: the motion has no part in common with the reference")
            known.append(curve.error)
    return max(e[0] for e in known), max(e[1] for e in known)


def curves_of(plots: Sequence[Plot], moved: Trajectory) -> Curves:
    """The curves of plots in a motion."""
    return tuple(curve for plot in plots for curve in plot_curves(plot, moved, ""))


class NothingInCommon(TisserandError):
    """A motion cannot be compared with a reference."""
