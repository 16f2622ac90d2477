"""The pipeline: a specification becomes equations of motion, a model with its initial state, and files."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING
from warnings import warn

from derive.artifacts import File
from derive.backends.model_files import emit
from derive.errors import SpecError, TisserandError
from derive.ir.model import Model
from derive.spec.model.beam_pieces import in_pieces
from derive.spec.model.scene import Scene
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene, Specification
from derive.spec.toml.read import read, with_lines

if TYPE_CHECKING:
    from derive.mechanics.equations import Equations
    from derive.mechanics.multibody.space.mechanism import AnyMechanism


@dataclass(frozen=True)
class Built:
    """The results of all stages for a specification; that of a scene in space has all pieces of its beams.

    derived: the equations of a body, or the mechanism of a scene. unstarted: the reason why the files of a scene have
    no function NAME_start; empty where they have one. seconds: the wall-clock time of each stage by its name.
    """

    spec: Specification
    derived: Equations | AnyMechanism
    model: Model
    files: tuple[File, ...]
    unstarted: str = ""
    seconds: Mapping[str, float] = field(default_factory=dict)

    @property
    def equations(self) -> Equations:
        """The form of the equations from which the model was lowered: with sums over the modes, or expanded."""
        from derive.model_lowering import lowered_form

        return lowered_form(self.derived, self.model)


class Stages:
    """The stages of a pipeline: `seconds` has the time of each one; `announce` is called when one begins."""

    def __init__(self, announce: Callable[[str], None] = lambda _: None) -> None:
        self.announce, self.seconds = announce, dict[str, float]()

    @contextmanager
    def stage(self, name: str, doc: str) -> Iterator[None]:
        """Measure the time of a stage, which `doc` describes to the user."""
        self.announce(doc)
        began = time.perf_counter()
        yield
        self.seconds[name] = time.perf_counter() - began


def build(
    path: Path,
    announce: Callable[[str], None] = lambda _: None,
    sensitivities: bool = False,
    functions: Collection[str] = (),
) -> Built:
    """Run all stages on a specification file, without writing the generated files.

    `path` is the TOML file; `announce` is called with a description of each stage when it begins; `sensitivities`,
    `functions`: see `lower`. Raises SpecError, with line numbers of the file, if the specification is invalid.
    """
    stages = Stages(announce)
    with stages.stage("read", "reading the specification"):
        spec = read(path)
    try:
        result = generate(spec, sensitivities, stages=stages, functions=functions)
        if isinstance(spec, (Scene, SpatialScene)):
            _check_plots(spec, result.model)
    except SpecError as error:  # a fault that shows only in the derivation, or in the names of the columns
        raise with_lines(error, path) from None
    return result


def generate(
    spec: Specification,
    sensitivities: bool = False,
    backends: Sequence[str] = ("c", "python"),
    start_needed: bool = False,
    stages: Stages | None = None,
    functions: Collection[str] = (),
) -> Built:
    """Run all stages on a specification: derive, lower, compute the initial state, emit.

    sensitivities, functions: see `lower`. backends: names in `BACKENDS`. start_needed: whether it is an error that a
    scene has no initial state; its inputs without a value are zero there. Raises SpecError, and SimulationError with
    `start_needed`.
    """
    from derive.derivation import derive
    from derive.model_lowering import lower

    written, spec = spec, in_pieces(spec)
    stages = stages or Stages()
    with stages.stage("derive", "deriving the equations of motion"):
        derived, first = derive(spec), _foreseen(spec)
    with stages.stage("lower", "lowering to kernels"):
        model = lower(derived if first is spec else derive(first), sensitivities, functions=functions)
    unstarted = ""
    if isinstance(spec, (Scene, SpatialScene)):
        with stages.stage("start", "computing the initial state"):
            model, unstarted = _started(spec, model, start_needed, first is not spec)
    with stages.stage("emit", "emitting C and Python"):
        files = emit(model, written, backends)
    return Built(spec, derived, model, files, unstarted, stages.seconds)


def model_files(model: Model, spec: Specification, backends: Sequence[str] = ("c", "python")) -> tuple[File, ...]:
    """The files of a model as `tisserand build` writes them: of the backends of these names, and the manifest.

    The files of a scene contain its initial state as the function NAME_start; where there is no initial state, a
    warning of Python says why.

    Arguments:
        model: the kernels that `lower` returns.
        spec: the specification that the model was made from.
        backends: names in `derive.backends.model_files.BACKENDS`: "c", "python".

    Raises:
        UnknownNameError: for a backend that is not registered.
        TypeError: for anything but a model and a specification.

    Examples:
        >>> import derive
        >>> beam = derive.planar_beam("beam")
        >>> model = derive.lower(derive.derive(beam))
        >>> for file in derive.model_files(model, beam):
        ...     print(file.path)
        beam/beam.h
        beam/beam.c
        beam/beam.py
        beam/manifest.json
    """
    if not isinstance(model, Model):
        kind = type(model).__name__
        raise TypeError(f"the model that derive.lower(derive.derive(spec)) returns is needed, not {kind}")
    scene = in_pieces(spec)
    if isinstance(scene, (Scene, SpatialScene)) and model.start is None:
        model, unstarted = _started(scene, model)
        if unstarted:
            warn(unstarted, stacklevel=2)
    return emit(model, spec, backends)


def _foreseen(spec: Specification) -> Specification:
    """The specification whose model is tried first: of some scenes redundant joints are certain."""
    if not isinstance(spec, (Scene, SpatialScene)):
        return spec
    from derive.simulation.redundant_joints import foreseen  # with SciPy, which bodies alone do not need

    return foreseen(spec)


def _started(scene: AnyScene, model: Model, needed: bool = False, resolved: bool = False) -> tuple[Model, str]:
    """The model with its initial state or, unless that is needed, without it and with the reason.

    resolved: whether the model is that of the scene with redundant joints resolved. It is the other one of the two if
    joints prove to be redundant in the initial state, or if that does not help.
    """
    from derive.derivation import derive
    from derive.model_lowering import lower
    from derive.simulation.initial.start_state import start_state
    from derive.simulation.linear.run_time_inputs import with_zero_inputs
    from derive.simulation.redundant_joints import with_redundant_joints

    def again(described: AnyScene) -> Model:
        return lower(derive(described), model.sensitivities, functions=model.requested)

    def started(described: AnyScene) -> Model:
        given = (described is scene) != resolved
        own = model if given else again(described)
        return replace(own, start=start_state(with_zero_inputs(described) if needed else described, own))

    try:
        return with_redundant_joints(scene, started), ""
    except TisserandError as error:
        if needed:
            raise
        reason = str(error).splitlines()[0]
        if resolved:
            model = again(scene)
        return model, f"no function {model.name}_start, since there is no initial state: {reason}"


def _check_plots(scene: AnyScene, model: Model) -> None:
    """Raise SpecError if plots show columns that a trajectory does not have."""
    from derive.simulation.prepared_run import plots_of_nothing
    from derive.simulation.trajectory import column_units

    known = tuple(name for name, _ in column_units(scene, model))
    if problems := tuple(plots_of_nothing(scene.plots, known)):
        raise SpecError(problems)
