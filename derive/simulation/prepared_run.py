"""A simulation that is ready to run: its specification has been checked completely."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from derive.artifacts import File
from derive.errors import Problem, SpecError, quoted
from derive.generated_models import generated, generated_explicit
from derive.runtime.interpreted_scene import with_iteration_matrix
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.constraints.dependence_note import dependence_note
from derive.simulation.constraints.redundancy import dependence
from derive.simulation.drive_jumps import check_drives
from derive.simulation.drive_obstacle import drive_obstacle
from derive.simulation.earlier_run import EarlierRun
from derive.simulation.errors import RedundantConstraints, SimulationError
from derive.simulation.initial.initial_state import InitialState
from derive.simulation.initial.spatial_state import body_size, spatial_state
from derive.simulation.inputs import DrivenScene, InputFunction, with_functions
from derive.simulation.integration.integrator import Integrator, Settings
from derive.simulation.integration.registry import EXPLICIT, INTEGRATORS, PASSING, RESOLVING
from derive.simulation.integration.solution import Progress, Solution
from derive.simulation.observables.default_plots import default_plots, output_columns, plots_note
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.observables.stresses import stress_columns
from derive.simulation.output_times import output_times
from derive.simulation.redundant_joints import foreseen, with_redundant_joints
from derive.simulation.scene_start import size_of, state_of
from derive.simulation.simulated_scene import surroundings
from derive.simulation.space.half_turns import half_turn_notes
from derive.simulation.space.joint_limits import joint_limit_notes
from derive.simulation.stop_condition import state_columns, stop_condition, stop_event
from derive.simulation.trajectory import RunSettings, Trajectory, column_units, column_values
from derive.simulation.validity.axial_loads import missing_stiffness_notes
from derive.simulation.validity.far_deformation import far_deformation_notes
from derive.simulation.validity.measure import validity
from derive.simulation.validity.mode_content import mode_notes
from derive.simulation.validity.monitoring_outputs import (
    is_monitored,
    monitoring_note,
    monitoring_outputs,
    with_monitors,
)
from derive.simulation.validity.watched_beam import scene_watch
from derive.spec.checks.plotted_columns import missing_columns
from derive.spec.model.body import NodalBody
from derive.spec.model.plots import Plot
from derive.spec.model.scene_functions import breaks
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.spec.parsing.condition import Row
from derive.spec.parsing.faults import names_text, path_text

NO_INPUTS = "a body in space has no run-time inputs; make it part of a scene, or leave `inputs` out"
"""The message of the error for run-time inputs of a body."""


class PreparedRun:
    """The simulation of a scene, or of a body in space alone, with its columns and its plots; `trajectory` runs it.

    scene: what is simulated, with functions in place of its run-time inputs; a body alone is in an empty scene. size:
    of the scene or the body, m. model: the kernels; complete_model: those with the outputs that monitor its validity.
    files: the generated files that are compiled. units: those of the columns by their names.
    """

    def __init__(
        self,
        spec: AnyScene | NodalBody,
        integrator: str = "adaptive",
        step: float | None = None,
        inputs: Mapping[str, InputFunction] | None = None,
        complete: bool = True,
    ) -> None:
        """Arguments as for `simulate`; the specification has a `simulation`.

        complete: whether the model of a scene has all functions, or only those that the integrator calls, which takes
        half the time. Raises SpecError, UnknownNameError, SimulationError.
        """
        assert spec.simulation is not None, "with_simulation makes it"
        self.settings, self.inputs = RunSettings(spec.simulation, integrator, step), dict(inputs or {})
        self.body = spec if isinstance(spec, NodalBody) else None
        if self.body and self.inputs:
            raise SimulationError(NO_INPUTS)
        self.scene = with_functions(surroundings(spec), self.inputs)
        self.spec = self.body or self.scene
        self.size = body_size(self.body) if self.body else size_of(self.scene)
        check_drives(self.scene)
        self._compile, self._complete = INTEGRATORS[integrator], bool(self.body) or complete
        self._generate(foreseen(self.scene))
        columns = column_units(self.scene, self.model, self.body)
        self.units = dict(columns)
        problems = [
            *_repeated(self.scene, [name for name, _ in columns]),
            *plots_of_nothing(self.scene.plots, tuple(self.units)),
        ]
        self._until, wrong = stop_condition(spec.simulation, tuple(self.units))
        if problems or wrong:
            raise SpecError((*problems, *wrong))
        self._spatial = spatial_state(self.model, self.body.start) if self.body else None
        self._notes = (*monitoring_note(self.scene), *plots_note(self.scene, self.model))
        stresses = tuple(stress_columns(self.scene, self.body))
        self.plots = (*self.scene.plots, *default_plots(self.scene, self.model, stresses))

    def _generate(self, scene: AnyScene) -> None:
        """Generate the model, of `scene` in place of the scene that is simulated."""
        self._redundancy = scene.redundant
        if self._complete or self.settings.integrator not in EXPLICIT:
            self.complete_model, self.files = generated(self.body or with_monitors(scene))
        else:
            self.complete_model, self.files = generated_explicit(with_monitors(scene))
        own = len(self.complete_model.outputs) - len(monitoring_outputs(scene))
        self.model = replace(self.complete_model, outputs=self.complete_model.outputs[:own])

    def trajectory(
        self,
        earlier: EarlierRun | None = None,
        progress: Progress | None = None,
        announce: Callable[[str], None] | None = None,
    ) -> Trajectory:
        """The motion; arguments as for `simulate`. Raises CompilerError, ModelError, SimulationError.

        announce: called before the integration with each note on the expected motion; the result has these notes too.
        Where constraints depend on each other, at the start or later, the run is repeated with multipliers of least
        norm, unless the scene says what to do about redundant joints.
        """

        def run(scene: AnyScene) -> Trajectory:
            if scene.redundant != self._redundancy:
                self._generate(scene)
            return self._trajectory(earlier, progress, announce)

        return with_redundant_joints(self.scene, run)

    def _trajectory(
        self, earlier: EarlierRun | None, progress: Progress | None, announce: Callable[[str], None] | None
    ) -> Trajectory:
        simulation = self.settings.simulation
        native, integrator = self._compiled(self.files)
        k = native.setup()
        initial = self._spatial or state_of(self.scene, native, k)
        q, v, times = initial.q, initial.v, output_times(simulation)
        foreseen: tuple[str, ...] = self._notes
        if earlier is not None:
            q, v, times = earlier.q, earlier.v, earlier.times(times)
        elif (obstacle := drive_obstacle(self.scene, native, k, q, self.size)) is not None:
            foreseen += (str(obstacle),)
        if announce is not None:
            for text in foreseen:
                announce(text)
        foreseen += (*self._redundant(native, k, initial),)

        def row(solution: Solution) -> Row:
            values = column_values(self.scene, native, k, solution, self.body)
            return {name: float(column[0]) for name, column in zip(self.units, values, strict=True)}

        watched = scene_watch(self.scene, native, k, float(times[0]), q, v)
        settings = Settings(
            tolerance=simulation.tolerance,
            size=self.size,
            step=self.settings.step,
            breaks=breaks(self.scene),
            until=stop_event(self._until, row, native, k, state_columns(self.scene, native, tuple(self.units))),
            progress=progress,
            watch=watched.watch if watched.beams else None,
            checked=True,
        )
        solution = integrator.integrate(k, q, v, times, settings)
        foreseen += half_turn_notes(self.scene, native, k, solution.t, solution.q, solution.v)
        foreseen += (*joint_limit_notes(self.scene, native, k, solution.t, solution.q),)
        beams = not is_monitored(self.scene)  # monitors tell of the stiffness that their axial force adds
        states = (solution.t, solution.q, solution.v)
        missing = missing_stiffness_notes(self.scene, native, k, *states, body=self.body, beams=beams)
        foreseen += (*missing.values(),)
        foreseen += (*mode_notes(self.scene, native, k, solution.t, solution.q, solution.v),)
        foreseen += (*far_deformation_notes(self.scene, native, solution.q),)
        if earlier is not None:
            solution = earlier.continued(self.model, solution)
        solution = replace(solution, notes=(*foreseen, *solution.notes))
        return self._result(native, k, initial, solution)

    def _redundant(self, native: NativeScene, k: Vector, initial: InitialState) -> Iterator[str]:
        """The note on constraints that depend on each other. Raises SimulationError if the integrator needs others."""
        integrator = self.settings.integrator
        note = dependence_note(native, k, initial.t, initial.q, initial.v, self.model.outputs)
        if note and integrator not in PASSING:
            in_all_states = isinstance(dependence(native, k, initial.t, initial.q), RedundantConstraints)
            able = RESOLVING if in_all_states else PASSING
            if integrator not in able:
                raise SimulationError(
                    f"{note}\n{integrator} solves for reactions, which have to be unique; choose one of "
                    f"{names_text(sorted(able))}"
                )
        if note:
            yield note
        elif self.model.proximal and self.scene.redundant == "auto":
            yield "the motion passes singular positions; the reactions of least norm are computed there"

    def _compiled(self, files: Sequence[File]) -> tuple[NativeScene, Integrator]:
        """The compiled model, in which inputs follow functions in Python, and the integrator."""
        name, compiled = self.settings.integrator, self._compile(files)
        with_iteration_matrix(compiled.native, self.complete_model)
        if not self.inputs:
            return compiled.native, compiled
        if compiled.through_python is None:
            raise SimulationError(
                f"{name} calls C alone, which knows no functions of Python for {', '.join(self.inputs)}; choose "
                "dop853, rk45 or ida, or write the functions in the specification"
            )
        native = DrivenScene(compiled.native, self.scene, self.inputs)
        return native, compiled.through_python(native)

    def _result(self, native: NativeScene, k: Vector, initial: InitialState, solution: Solution) -> Trajectory:
        """The motion as named columns, with the monitors of its validity."""
        motion = SceneMotion(self.scene, native, k, solution.t, solution.q, solution.v, solution.outputs)
        monitors = validity(motion, solution.watched)
        return Trajectory(self.scene, self.model, initial, motion, solution, self.settings, monitors, self.body)


def _repeated(scene: AnyScene, names: Iterable[str]) -> Iterator[Problem]:
    in_space = isinstance(scene, SpatialScene)
    paths = {name: f"outputs.{of.name}" for of in scene.outputs for name in output_columns(of, in_space)}
    seen = set[str]()
    for name in names:
        if name in seen:
            text = f"two columns are called {quoted(name)}; choose other names of outputs, inputs or drives"
            yield Problem(paths.get(name, ""), text)
        seen.add(name)


def plots_of_nothing(plots: Iterable[Plot], known: tuple[str, ...]) -> Iterator[Problem]:
    """The problems of plots of columns that a motion does not have; known: the columns that it has."""
    for path, message in missing_columns(plots, known, f"the columns are {names_text(known)}"):
        yield Problem(path_text(path), message)
