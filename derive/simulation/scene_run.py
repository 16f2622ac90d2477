"""The simulation of a scene: functions in place of its run-time inputs, its consistent initial state, its columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from derive.artifacts import File
from derive.ir.model import Model
from derive.runtime.integrators.watch import Watch
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.drive_jumps import check_drives
from derive.simulation.drive_obstacle import drive_obstacle
from derive.simulation.errors import SimulationError
from derive.simulation.initial.initial_state import InitialState, initial_state, scene_size
from derive.simulation.inputs import DrivenScene, InputFunction, with_functions
from derive.simulation.integration.integrator import Integrator, scene_of
from derive.simulation.integration.solution import Solution
from derive.simulation.observables.default_plots import default_plots
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.prepared_run import PreparedRun
from derive.simulation.stop_condition import StateColumn, state_columns
from derive.simulation.trajectory import Trajectory, column_units, column_values
from derive.simulation.validity.measure import validity
from derive.simulation.validity.monitoring_outputs import monitoring_outputs, with_monitors
from derive.simulation.validity.watched_beam import scene_watch
from derive.spec.model.body import NodalBody
from derive.spec.model.plots import Plot
from derive.spec.model.scene import Scene
from derive.spec.model.scene_functions import breaks


class SceneRun(PreparedRun[NativeScene, InitialState, Trajectory]):
    """The simulation of a scene. inputs: functions in Python by the names of the run-time inputs, see `simulate`."""

    def __init__(
        self,
        scene: Scene,
        integrator: str,
        step: float | None,
        inputs: Mapping[str, InputFunction],
        complete: bool = True,
    ) -> None:
        self.inputs = dict(inputs)
        self.scene = with_functions(scene, self.inputs)
        self.breaks, self.size = breaks(self.scene), scene_size(self.scene)
        check_drives(self.scene)
        super().__init__(self.scene, integrator, step, complete)

    def _with_monitors(self, spec: Scene | NodalBody) -> Scene:
        return with_monitors(self.scene)

    def _without_monitors(self, model: Model) -> Model:
        return replace(model, outputs=model.outputs[: len(model.outputs) - len(monitoring_outputs(self.scene))])

    def _columns(self) -> Sequence[tuple[str, str]]:
        return column_units(self.scene, self.model)

    def _default_plots(self) -> Sequence[Plot]:
        return default_plots(self.scene, self.model)

    def _compiled(self, files: Sequence[File]) -> tuple[NativeScene, Integrator]:
        name, compiled = self.settings.integrator, self._compile(files)
        native = scene_of(compiled.native, name)
        if self.inputs:
            if compiled.through_python is None:
                raise SimulationError(
                    f"{name} calls C alone, which knows no functions of Python for {', '.join(self.inputs)}; choose "
                    "dop853, rk45 or ida, or write the functions in the specification"
                )
            native = DrivenScene(native, self.scene, self.inputs)
            compiled = compiled.through_python(native)
        return native, compiled

    def _foreseen(self, native: NativeScene, k: Vector, q: Vector) -> Sequence[str]:
        obstacle = drive_obstacle(self.scene, native, k, q, self.size)
        return () if obstacle is None else (str(obstacle),)

    def _watch(self, native: NativeScene, k: Vector, t: float, q: Vector) -> Watch | None:
        watched = scene_watch(self.scene, native, k, t, q)
        return watched.watch if watched.beams else None

    def _state_columns(self, native: NativeScene) -> Mapping[str, StateColumn]:
        return state_columns(self.scene, native)

    def _start(self, native: NativeScene, k: Vector) -> tuple[Vector, Vector, InitialState]:
        initial = initial_state(self.scene, native, k)
        return initial.q, initial.v, initial

    def _values(self, native: NativeScene, k: Vector, solution: Solution) -> Sequence[Vector]:
        return column_values(self.scene, native, k, solution)

    def _result(self, native: NativeScene, k: Vector, start: InitialState, solution: Solution) -> Trajectory:
        motion = SceneMotion(self.scene, native, k, solution.t, solution.q, solution.v, solution.outputs)
        monitors = validity(motion, solution.watched)
        return Trajectory(self.scene, self.model, start, motion, solution, self.settings, monitors)
