"""The pipeline from a specification file to generated files, with the time and the size of each stage."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from warnings import warn

from derive.artifacts import File
from derive.backends.model_files import model_files as emitted_files
from derive.derivation import derive, lower, lowered_form
from derive.errors import SpecError, TisserandError
from derive.ir.model import Model
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import IndexedEquations
from derive.notes.model_notes import build_notes
from derive.spec.model.scene import Scene, Specification
from derive.spec.toml.read import read, warnings, with_lines


@dataclass(frozen=True)
class Stage:
    """A stage of the pipeline: wall-clock time in seconds, and sizes (None where a size does not apply)."""

    name: str
    seconds: float
    terms: int | None = None
    operations: int | None = None
    nonzeros: int | None = None


@dataclass(frozen=True)
class Built:
    """The results of all stages for a specification; `notes` are lines of text for the user."""

    spec: Specification
    equations: Equations
    model: Model
    files: tuple[File, ...]
    stages: tuple[Stage, ...]
    notes: tuple[str, ...] = ()


def build(path: Path, progress: Callable[[str], None] = lambda _: None, sensitivities: bool = False) -> Built:
    """Run all stages on a specification file, without writing the generated files.

    `path` is the TOML file; `progress` is called with a description of each stage when it begins; `sensitivities`: see
    `lower`. Raises SpecError, with line numbers of the file, if the specification is invalid.
    """
    clock = [time.perf_counter()]

    def lap() -> float:
        clock.append(time.perf_counter())
        return clock[-1] - clock[-2]

    progress("reading the specification")
    spec = read(path)
    reading = Stage("read", lap())
    progress("deriving the equations of motion")
    try:
        derived = derive(spec)
        deriving = Stage("derive", lap())
        progress("lowering to kernels")
        model = lower(derived, sensitivities)
    except SpecError as error:  # a numerical fault that shows only during the derivation
        raise with_lines(error, path) from None
    if isinstance(spec, Scene) and spec.plots:
        _check_plots(spec, model, path)
    equations = lowered_form(derived, model)
    operations, nonzeros = model.kernel("mass_force").operations, model.pattern("mass", "M").full_nnz
    lowering = Stage("lower", lap(), operations=operations, nonzeros=nonzeros)
    deriving = replace(deriving, terms=len(equations.terms))
    if not isinstance(equations, IndexedEquations):
        deriving = replace(deriving, nonzeros=sum(entry != 0 for entry in equations.mass))
    if isinstance(spec, Scene):
        progress("computing the initial state")
    model, failure = _with_start(spec, model)
    starting = (Stage("start", lap()),) if isinstance(spec, Scene) else ()
    progress("emitting C and Python")
    files = emitted_files(model, spec)
    emitting = Stage("emit", lap())
    notes = (*build_notes(spec, model), *(f"warning: {text}" for text in (*failure, *warnings(path))))
    return Built(spec, equations, model, files, (reading, deriving, lowering, *starting, emitting), notes)


def _check_plots(scene: Scene, model: Model, path: Path) -> None:
    """Raise SpecError if plots show columns that a trajectory does not have."""
    from derive.simulation.prepared_run import plots_of_nothing
    from derive.simulation.trajectory import column_units

    known = tuple(name for name, _ in column_units(scene, model))
    if problems := tuple(plots_of_nothing(scene.plots, known)):
        raise with_lines(SpecError(problems), path)


def model_files(model: Model, spec: Specification, backends: Sequence[str] = ("c", "python")) -> tuple[File, ...]:
    """The files of a model as `tisserand build` writes them: of the backends of these names, and the manifest.

    spec: the specification that the model was made from. The files of a scene contain its initial state as the function
    NAME_start; where there is no initial state, a warning of Python says why. Raises UnknownNameError for a name that
    is not in `BACKENDS`.
    """
    complete, failure = _with_start(spec, model)
    for text in failure:
        warn(text, stacklevel=2)
    return emitted_files(complete, spec, backends)


def _with_start(spec: Specification, model: Model) -> tuple[Model, tuple[str, ...]]:
    """The model with the initial state of a scene or, if there is none, a line that says why.

    Run-time inputs have their values at the start of a simulation, since a prescribed motion may be one of them.
    """
    if not isinstance(spec, Scene) or model.start is not None:
        return model, ()
    from derive.simulation.initial.start_state import start_state
    from derive.simulation.inputs import with_functions

    try:
        simulated = replace(with_functions(spec, {}), outputs=())
        start = start_state(simulated, lower(derive(simulated)) if spec.inputs else model)
        return replace(model, start=start), ()
    except TisserandError as error:
        reason = str(error).splitlines()[0]
        return model, (f"no function {model.name}_start, since there is no initial state: {reason}",)
