"""The plan of a sweep: its samples checked and resolved, its models compiled, each once, before the first run."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from derive.backends.model_files import fingerprint
from derive.errors import Problem, SpecError
from derive.kept_objects import package_hash
from derive.runtime.compiler import RUN_FLAGS
from derive.runtime.integrators.adaptive import adaptive_library
from derive.runtime.loading import load_scene, model_library
from derive.short_text import full_text
from derive.simulation.inputs import with_functions
from derive.simulation.prepared_run import PreparedRun
from derive.simulation.redundant_joints import refuse_dependent, with_redundant_joints
from derive.simulation.simulate import with_simulation
from derive.simulation.simulated_scene import beam_scene
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_pieces import in_pieces
from derive.spec.model.specification import AnyScene, Specification
from derive.spec.set_values import SetValue, with_values
from derive.study.studied_scene import without_initial_values
from derive.study.sweep.dependence import initial_parameters
from derive.study.sweep.outputs import SweepOutput, output
from derive.study.sweep.samples import Samples, SamplesError
from derive.study.sweep.worker import Case, Chunk, ModelCode, Sample
from derive.version import VERSION

MOST_MODELS = 64
"""The largest number of models that a sweep compiles."""

SCENES = "a sweep runs scenes and single beams; for a body in space, call derive.simulate in a loop"
"""The message of the error for other specifications."""


@dataclass(frozen=True)
class RunOptions:
    """Values in place of those of the specification: duration and interval between rows, s; tolerance; `until`."""

    duration: float | None = None
    interval: float | None = None
    tolerance: float | None = None
    until: str | None = None


@dataclass(frozen=True, eq=False)
class Plan:
    """A sweep that is ready to run.

    units: those of the names that are parameters. changes: the keys that are set, with the first values. parameters:
    the names whose values are parameters of the compiled code; the others, `remaining`, make several cases, and models
    where equations depend on them. initial_states: their number. identity: everything on which the results depend, by a
    name for each part.
    """

    name: str
    samples: Samples
    outputs: tuple[SweepOutput, ...]
    units: Mapping[str, str]
    changes: tuple[SetValue, ...]
    parameters: tuple[str, ...]
    remaining: tuple[str, ...]
    models: tuple[ModelCode, ...]
    cases: tuple[Case, ...]
    runs: tuple[Sample, ...]
    initial_states: int
    identity: Mapping[str, str]

    def chunk(self, runs: Sequence[Sample]) -> Chunk:
        """The chunk of these runs, with the cases and models that a worker needs for them."""
        cases = {run.case: self.cases[run.case] for run in runs}
        models = {case.model: self.models[case.model] for case in cases.values()}
        return Chunk(models, cases, self.symbols, self.outputs, tuple(runs))

    @property
    def symbols(self) -> tuple[str, ...]:
        """The symbols of the parameters, in the order of the values of a run."""
        by_name = {change.key: change.symbol for change in self.changes}
        return tuple(by_name.get(name) or name for name in self.parameters)


Changed = Callable[[Mapping[str, str]], tuple[Specification, tuple[SetValue, ...]]]
"""A specification with other values by their names, as `with_values` gives it."""


def make_plan(
    spec: Specification,
    samples: Samples,
    outputs: Sequence[str],
    options: RunOptions,
    progress: Callable[[str], None] = lambda _: None,
    changed: Changed | None = None,
) -> Plan:
    """Check a sweep, and compile its models. progress: called with a line on each task.

    changed: the specification with the values of a sample, where it is made anew with other numbers of instances.

    Raises SpecError, SamplesError, UnknownNameError, OutputError, CompilerError.
    """
    if not isinstance(spec, AnyScene | PlanarBeam):
        raise SpecError((Problem("", SCENES),))
    firsts, changed = first_values(samples), changed or partial(with_values, spec)
    _, changes = changed(firsts)
    symbols = {name: _symbol(name, changes) for name in samples.names}
    parameters = tuple(name for name in samples.names if symbols[name] is not None)
    remaining = tuple(name for name in samples.names if symbols[name] is None)
    _check_symbols(symbols)
    for name in parameters:  # errors of extreme values are reported before the first run
        for value in (samples.axis(name).min(), samples.axis(name).max()):
            changed({**firsts, name: number_text(float(value))})
    keys = [_part(row, samples, remaining) for row in samples.values.tolist()]
    builder = _Models(progress)
    scenes = []
    for number, values in enumerate(dict.fromkeys(keys)):
        progress(f"checking the values: {number + 1}")
        texts = dict(zip(remaining, map(number_text, values), strict=True))
        scenes.append(builder.add(_simulated(changed({**_defaults(changes, samples), **texts})[0], options)))
    cases = tuple(Case(scene, model, _hash(full_text(scene))) for scene, model in scenes)
    chosen = tuple(output(text, builder.runs[0].scene, builder.runs[0].units) for text in outputs)
    check_outputs(chosen, builder.codes)
    number_of = {values: number for number, values in enumerate(dict.fromkeys(keys))}
    runs = [
        Sample(i, number_of[key], tuple(_part(row, samples, parameters)))
        for i, (row, key) in enumerate(zip(samples.values.tolist(), keys, strict=True))
    ]
    order, states = _order(runs, cases, builder.codes, tuple(symbols[name] or "" for name in parameters))
    identity = {
        "Tisserand": f"{VERSION} {package_hash()}",
        "the specification": _hash(*(fingerprint(case.scene) + full_text(case.scene) for case in cases)),
        "the samples": _hash(repr(samples.names), samples.values.tobytes().hex()),
        "the outputs": full_text(chosen),
    }
    known = {parameter.name: parameter.unit for parameter in builder.runs[0].model.parameters}
    return Plan(
        name=builder.runs[0].scene.name,
        samples=samples,
        outputs=chosen,
        units={name: known.get(symbol or "", "") for name, symbol in symbols.items()},
        changes=changes,
        parameters=parameters,
        remaining=remaining,
        models=tuple(builder.codes),
        cases=cases,
        runs=order,
        initial_states=states,
        identity=identity,
    )


def _defaults(changes: Sequence[SetValue], samples: Samples) -> dict[str, str]:
    """The values that turn keys into parameters: their numbers, so that the model does not depend on samples.

    A key with a function of time in the specification gets the first value.
    """
    added = (change for change in changes if change.symbol is not None and change.symbol not in samples.names)
    return {change.key: change.old if _is_number(change.old) else change.new for change in added}


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


class _Models:
    """The models of a sweep: scenes whose equations are the same share one."""

    def __init__(self, progress: Callable[[str], None]) -> None:
        self._progress = progress
        self._numbers: dict[str, int] = {}
        self.codes: list[ModelCode] = []
        self.runs: list[PreparedRun] = []

    def add(self, scene: AnyScene) -> tuple[AnyScene, int]:
        """The scene as it is simulated, and the number of its model."""
        scene = with_functions(scene, {})
        key = fingerprint(without_initial_values(scene))
        if key not in self._numbers:
            if len(self.codes) >= MOST_MODELS:
                raise SamplesError(
                    f"more than {MOST_MODELS} models would have to be derived and compiled, since values change the "
                    "equations; sweep fewer values of them, or make them parameters, whose values one model takes"
                )
            self._numbers[key] = len(self.codes)
            self._progress(f"{scene.name}: deriving and compiling model {len(self.codes) + 1}")
            run = with_redundant_joints(scene, _prepared)
            name, library = model_library(run.files, RUN_FLAGS)
            initial = tuple(sorted(initial_parameters(run.scene, run.complete_model)))
            needed = run.complete_model if run.complete_model.has_iteration_matrix else None
            self.runs.append(run)
            self.codes.append(ModelCode(name, library, adaptive_library(), tuple(run.units), initial, needed))
        return replace(scene, plots=()), self._numbers[key]


def _prepared(scene: AnyScene) -> PreparedRun:
    """The run of a scene. Raises the errors for redundant joints."""
    run = PreparedRun(scene, complete=False)
    refuse_dependent(run.scene, load_scene(run.files, RUN_FLAGS))
    return run


def _simulated(spec: Specification, options: RunOptions) -> AnyScene:
    assert isinstance(spec, AnyScene | PlanarBeam), "values do not change what is specified"
    scene = beam_scene(spec) if isinstance(spec, PlanarBeam) else spec
    return in_pieces(with_simulation(scene, options.duration, options.interval, options.tolerance, options.until))


def _symbol(name: str, changes: Sequence[SetValue]) -> str | None:
    """The symbol of the parameter that a name sets; None for another key."""
    return next((change.symbol for change in changes if name in (change.key, change.symbol)), None)


def _check_symbols(symbols: Mapping[str, str | None]) -> None:
    first: dict[str, str] = {}
    for name, symbol in symbols.items():
        if symbol is not None and first.setdefault(symbol, name) != name:
            raise SamplesError(f"{first[symbol]} and {name} are one parameter, {symbol}; give one set of values")


def check_outputs(outputs: Sequence[SweepOutput], models: Sequence[ModelCode]) -> None:
    """Raise SamplesError if an output is no column of all models, or if two have one label."""
    labels = [chosen.label for chosen in outputs]
    for chosen in outputs:
        if chosen.deflection is None and any(chosen.name not in model.columns for model in models):
            raise SamplesError(f"{chosen.name} is no column of all models of this sweep; choose another output")
        if labels.count(chosen.label) > 1:
            raise SamplesError(f"the output {chosen.label} is given twice")


def _order(
    runs: Sequence[Sample], cases: Sequence[Case], codes: Sequence[ModelCode], symbols: Sequence[str]
) -> tuple[tuple[Sample, ...], int]:
    """The runs in an order in which those with one initial state follow each other, and the number of these states."""

    def state(run: Sample) -> tuple[int, tuple[float, ...]]:
        initial = codes[cases[run.case].model].initial
        return run.case, tuple(x for symbol, x in zip(symbols, run.values, strict=True) if symbol in initial)

    return tuple(sorted(runs, key=lambda run: (state(run), run.number))), len({state(run) for run in runs})


def _part(row: Sequence[float], samples: Samples, names: Sequence[str]) -> tuple[float, ...]:
    return tuple(row[samples.names.index(name)] for name in names)


def first_values(samples: Samples) -> dict[str, str]:
    """The values of the first sample as texts, by their names."""
    return dict(zip(samples.names, map(number_text, samples.values[0].tolist()), strict=True))


def number_text(value: float) -> str:
    """The text of a number in TOML: whole numbers as integers, which some keys require."""
    return str(int(value)) if value == int(value) and abs(value) < 2.0**53 else repr(value)


def _hash(*parts: str) -> str:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(f"{len(part)}\0{part}".encode())
    return digest.hexdigest()
