"""The worker of a sweep: it runs samples of a compiled model, one after the other, with as little Python as possible.

A chunk of samples comes with everything that it needs, so that it can run in any process on any machine of the same
kind. The libraries and initial states that a worker keeps from one chunk to the next follow from the chunk alone: the
results are the same to the bit however samples are divided into chunks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

from derive.errors import SpecError, TisserandError
from derive.ir.model import Model
from derive.runtime.interpreted_scene import with_iteration_matrix
from derive.runtime.loading import load_data
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.drive_jumps import check_drives
from derive.simulation.integration.adaptive import adaptive
from derive.simulation.integration.integrator import Integrator, Settings
from derive.simulation.integration.solution import Solution
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.output_times import output_times
from derive.simulation.scene_start import size_of, state_of
from derive.simulation.stop_condition import state_columns, stop_condition, stop_event
from derive.simulation.trajectory import column_values
from derive.simulation.validity.axial_loads import missing_stiffness_notes
from derive.simulation.validity.measure import validity
from derive.simulation.validity.monitoring_outputs import is_monitored
from derive.simulation.validity.monitors import warnings
from derive.simulation.validity.watched_beam import scene_watch
from derive.spec.model.scene_functions import breaks
from derive.spec.model.specification import AnyScene
from derive.spec.parsing.condition import Row
from derive.study.sweep.dependence import with_defaults
from derive.study.sweep.outputs import SweepOutput, evaluate

KEPT_STARTS, KEPT_MODELS = 256, 16
"""The largest numbers of initial states and of loaded libraries that a worker keeps."""


@dataclass(frozen=True)
class ModelCode:
    """A compiled model: its name, its library and that of the integrator; the names of the columns of its runs.

    initial: the parameters that the initial state depends on. model: what the code was made of, where a start in
    equilibrium or in steady motion needs its iteration matrix, which the library does without.
    """

    name: str
    library: bytes
    integrator: bytes
    columns: tuple[str, ...]
    initial: tuple[str, ...]
    model: Model | None = field(default=None, compare=False)


@dataclass(frozen=True)
class Case:
    """A scene as it is simulated, with its `simulation`, but for the values of parameters; model: its code by number.

    key: the hash of the scene, by which workers distinguish cases.
    """

    scene: AnyScene = field(compare=False)
    model: int = field(compare=False)
    key: str


@dataclass(frozen=True)
class Sample:
    """A run: its number, the number of its case, and the values of the parameters."""

    number: int
    case: int
    values: tuple[float, ...]


@dataclass(frozen=True)
class Chunk:
    """Samples with their cases and models by number, the names of the parameters, and the outputs."""

    models: Mapping[int, ModelCode]
    cases: Mapping[int, Case]
    parameters: tuple[str, ...]
    outputs: tuple[SweepOutput, ...]
    samples: tuple[Sample, ...]


@dataclass(frozen=True)
class Outcome:
    """The outcome of a sample by its number: values of the outputs, NaN with the reason in `failure` if it has none.

    notes: the deviations of the run from the specification, such as an initial value that is corrected.
    """

    number: int
    values: tuple[float, ...]
    failure: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class _Start:
    """An initial state of a scene with the values of its parameters, its size, its breaks and its notes."""

    scene: AnyScene
    q: Vector
    v: Vector
    size: float
    breaks: tuple[float, ...]
    notes: tuple[str, ...]


def run_chunk(chunk: Chunk, losses: int = 0) -> tuple[Outcome, ...]:
    """Run the samples of a chunk. A sample that cannot be run has NaN as its values. Raises CompilerError, OSError.

    losses: the workers that it has lost before, so that executors which cache calls do not reuse an earlier call.
    """
    return tuple(_outcome(chunk, sample) for sample in chunk.samples)


def _outcome(chunk: Chunk, sample: Sample) -> Outcome:
    case = chunk.cases[sample.case]
    code = chunk.models[case.model]
    native, integrator = _loaded(code)
    values = dict(zip(chunk.parameters, sample.values, strict=True))
    try:
        k = native.setup(values)
        start = _start(code, case, tuple((name, values[name]) for name in values if name in code.initial))
        if isinstance(start, str):
            return failed(chunk.outputs, sample, start)
        solution = _solution(code, native, integrator, start, k)
        results = evaluate(chunk.outputs, code.columns, start.scene, native, k, solution)
    except (TisserandError, ArithmeticError, ValueError) as error:
        return failed(chunk.outputs, sample, reason(error))
    return Outcome(sample.number, results, "", (*start.notes, *_unusual(start.scene, solution)))


def monitored(chunk: Chunk) -> dict[int, tuple[str, ...]]:
    """The warnings of the monitors of beams in the samples of a chunk, and notes on fast spin, by their numbers.

    It runs each sample once more.
    """
    result: dict[int, tuple[str, ...]] = {}
    for sample in chunk.samples:
        try:
            texts = _warnings(chunk, sample)
        except (TisserandError, ArithmeticError, ValueError) as error:
            texts = (f"its beams could not be monitored: {reason(error)}",)
        if texts:
            result[sample.number] = texts
    return result


def _warnings(chunk: Chunk, sample: Sample) -> tuple[str, ...]:
    case = chunk.cases[sample.case]
    code = chunk.models[case.model]
    native, integrator = _loaded(code)
    values = dict(zip(chunk.parameters, sample.values, strict=True))
    k = native.setup(values)
    start = _computed_start(code, case, values)
    solution = _solution(code, native, integrator, start, k, watched=True)
    motion = SceneMotion(start.scene, native, k, solution.t, solution.q, solution.v, solution.outputs)
    motions, beams = (solution.t, solution.q, solution.v), not is_monitored(start.scene)
    spins = missing_stiffness_notes(start.scene, native, k, *motions, beams=beams)
    return (*warnings(validity(motion, solution.watched)), *spins.values())


def failed(outputs: Sequence[SweepOutput], sample: Sample, text: str) -> Outcome:
    """The outcome of a sample that has no values, with the reason `text`."""
    return Outcome(sample.number, (float("nan"),) * len(outputs), text)


def reason(error: Exception) -> str:
    """The text of an error on one line."""
    text = "; ".join(problem.message for problem in error.problems) if isinstance(error, SpecError) else str(error)
    return " ".join(text.split()) or type(error).__name__


@lru_cache(KEPT_MODELS)
def _loaded(code: ModelCode) -> tuple[NativeScene, Integrator]:
    native = NativeScene(load_data(code.library), code.name)
    if code.model is not None:
        with_iteration_matrix(native, code.model)
    return native, adaptive(native, library=code.integrator)


@lru_cache(KEPT_STARTS)
def _start(code: ModelCode, case: Case, values: tuple[tuple[str, float], ...]) -> _Start | str:
    """The initial state for these values of the parameters that it depends on, or the reason why there is none."""
    try:
        return _computed_start(code, case, dict(values))
    except (TisserandError, ArithmeticError, ValueError) as error:
        return reason(error)


def _computed_start(code: ModelCode, case: Case, values: Mapping[str, float]) -> _Start:
    native, _ = _loaded(code)
    scene = with_defaults(case.scene, values)
    check_drives(scene)
    state = state_of(scene, native, native.setup(values))
    return _Start(scene, state.q, state.v, size_of(scene), breaks(scene), state.notes)


def _solution(
    code: ModelCode, native: NativeScene, integrator: Integrator, start: _Start, k: Vector, watched: bool = False
) -> Solution:
    simulation = start.scene.simulation
    assert simulation is not None
    condition, _ = stop_condition(simulation, code.columns)

    def row(solution: Solution) -> Row:
        columns = column_values(start.scene, native, k, solution)
        return {name: float(column[0]) for name, column in zip(code.columns, columns, strict=True)}

    settings = Settings(
        tolerance=simulation.tolerance,
        size=start.size,
        breaks=start.breaks,
        until=stop_event(
            condition, row, native, k, state_columns(start.scene, native, code.columns) if condition else {}
        ),
        watch=scene_watch(start.scene, native, k, 0.0, start.q, start.v).watch if watched else None,
        checked=True,
        interruptible=False,
    )
    return integrator.integrate(k, start.q, start.v, output_times(simulation), settings)


def _unusual(scene: AnyScene, solution: Solution) -> Sequence[str]:
    """The notes of a run, without that on a condition that has ended it before its time."""
    assert scene.simulation is not None
    ended = scene.simulation.until is not None and solution.t[-1] < scene.simulation.duration
    return solution.notes[:-1] if ended else solution.notes
