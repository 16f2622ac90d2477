"""The pipeline from a specification file to generated files, with the time and the size of each stage."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING
from warnings import warn

import numpy as np

from derive.artifacts import File
from derive.backends.model_files import model_files as emitted_files
from derive.derivation import derive, lower, lowered_form
from derive.errors import SpecError, TisserandError
from derive.ir.model import Model
from derive.lowering.conditioning import condition_warnings
from derive.lowering.spin_limit import spin_notes
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.scene_notes import scene_notes
from derive.spec.model.body import NodalBody
from derive.spec.model.scene import Scene, Specification
from derive.spec.toml.read import read, warnings, with_lines

if TYPE_CHECKING:
    from derive.reduction import BodyProperties
    from derive.reduction.arithmetic import Array


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
    if not equations.indexed:
        deriving = replace(deriving, nonzeros=sum(entry != 0 for entry in equations.mass))
    if isinstance(spec, Scene):
        progress("computing the initial state")
    model, failure = _with_start(spec, model)
    starting = (Stage("start", lap()),) if isinstance(spec, Scene) else ()
    progress("emitting C and Python")
    files = emitted_files(model, spec)
    emitting = Stage("emit", lap())
    notes = (model.choice, *_of_body(spec)) if model.choice else _of_scene(model)
    notes += (*spin_notes(spec), *(scene_notes(spec) if isinstance(spec, Scene) else ()))
    notes += tuple(f"warning: {text}" for text in (*failure, *warnings(path), *condition_warnings(spec)))
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


def _of_scene(model: Model) -> tuple[str, ...]:
    """Return which coordinates of a scene are eliminated and why, and the size of its KKT matrix."""
    if model.kkt is None:
        return ()
    size, entries = model.kkt.pattern.rows, model.kkt.pattern.full_nnz
    solving = (
        f"KKT matrix: {size} x {size}, {entries} non-zeros, fill-in of {model.kkt.fill}; accelerations and multipliers "
        f"take {model.kernel('solve').operations} operations"
    )
    return (*(f"eliminated: {out.what}: {out.reason}" for out in model.eliminated), solving)


def _of_body(spec: Specification) -> tuple[str, ...]:
    """Return the properties of a finite-element body, in which errors of units show; how far its modes were from their
    frame, and which of them have no stiffness."""
    if not isinstance(spec, NodalBody):
        return ()
    from derive.reduction import body_properties, residuals, zero_stiffness_modes

    notes = [*_of_properties(body_properties(spec)), *_of_geometric_stiffness(spec)]
    frame = residuals(spec)
    before, after = frame.before, frame.after
    if spec.frame.kind != "point" and spec.modes != 0:
        asked = "" if spec.frame.kind == "mean" else " (no condition of the frame as given)"
        notes.append(
            f"mean displacement of the modes (17): {before.displacement:.1e} of their size as given, "
            f"{after.displacement:.1e} as used; mean rotation (19): {before.rotation:.1e}, {after.rotation:.1e}{asked}"
        )
    if modes := zero_stiffness_modes(spec):
        numbers = ", ".join(map(str, modes))
        notes.append(f"warning: mode {numbers} has no stiffness; check for loose parts and missing elements")
    return tuple(notes)


def _of_geometric_stiffness(spec: NodalBody) -> Iterator[str]:
    """Yield which geometric stiffness matrices a body has, whether they are used, and which are taken as zero."""
    data = spec.data
    if not data.has_geometric_stiffness:
        return
    arrays = {"K0t": data.K0t, "K0r": data.K0r, "K0omega": data.K0omega, "K0F": data.K0F}
    given = ", ".join(name for name, array in arrays.items() if array is not None)
    if not spec.second_order:
        yield f"warning: geometric stiffness {given} is left out, since order = 1"
        return
    missing = ", ".join(name for name, array in arrays.items() if array is None)
    zero = f"; {missing}: not given, and taken as zero" if missing else ""
    yield f"displacements of second order in the amplitudes, from geometric stiffness {given}{zero}"


FIRST = 6
"""The natural frequencies that `build` prints."""


def _of_properties(body: BodyProperties) -> Iterator[str]:
    """Yield the mass, centre of mass, inertia and first natural frequencies in words."""
    centre = ", ".join(f"{x:.4g}" for x in _rounded(body.centre, float(np.sqrt(np.trace(body.inertia) / body.mass))))
    inertia = _rounded(body.inertia, float(np.trace(body.inertia)))
    moments = ", ".join(f"{inertia[a, a]:.4g}" for a in range(3))
    products = ", ".join(f"{inertia[a, b]:.4g}" for a, b in ((0, 1), (0, 2), (1, 2)))
    yield f"mass {body.mass:.6g} kg; centre of mass at ({centre}) m"
    yield f"inertia about the centre of mass: J11, J22, J33 = {moments} kg m^2; J12, J13, J23 = {products} kg m^2"
    if len(body.frequencies):
        first = ", ".join(f"{f:.5g}" for f in body.frequencies[:FIRST])
        more = f" and {len(body.frequencies) - FIRST} more" if len(body.frequencies) > FIRST else ""
        yield f"natural frequencies of the free body: {first} Hz{more}"


def _rounded(values: Array, size: float) -> Array:
    """Values without those that are rounding errors of numbers of that size."""
    return np.where(np.abs(values) > 1e-12 * size, values, 0.0)
