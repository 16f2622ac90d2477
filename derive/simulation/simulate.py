"""The simulation of a scene or a body in memory: derive, compile, find a consistent state, integrate."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, overload

from derive.backends.model_files import model_files
from derive.derivation import derive, lower
from derive.errors import Problem, SpecError, quoted
from derive.simulation.body_trajectory import BodyTrajectory, simulate_body
from derive.simulation.drive_jumps import check_drives
from derive.simulation.earlier_run import EarlierRun
from derive.simulation.errors import SimulationError
from derive.simulation.free_beam import beam_scene
from derive.simulation.initial.initial_state import initial_state
from derive.simulation.inputs import DrivenScene, InputFunction, with_functions
from derive.simulation.integration.integrator import Settings, scene_of
from derive.simulation.integration.registry import INTEGRATORS
from derive.simulation.integration.solution import Progress, Solution
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.output_times import output_times
from derive.simulation.stop_condition import stop_event
from derive.simulation.trajectory import RunSettings, Trajectory, column_units, column_values
from derive.spec.construction import validated
from derive.spec.model.body import NodalBody, PlanarBeam
from derive.spec.model.scene import ColumnCurves, Scene
from derive.spec.model.scene_functions import breaks
from derive.spec.model.simulation import Simulation
from derive.spec.parsing.faults import did_you_mean


@overload
def simulate(
    spec: Scene | PlanarBeam,
    *,
    duration: float | None = None,
    output: float | None = None,
    tolerance: float | None = None,
    integrator: str = "dop853",
    step: float | None = None,
    until: str | None = None,
    earlier: EarlierRun | None = None,
    inputs: Mapping[str, InputFunction] | None = None,
    progress: Progress | None = None,
) -> Trajectory: ...


@overload
def simulate(
    spec: NodalBody,
    *,
    duration: float | None = None,
    output: float | None = None,
    tolerance: float | None = None,
    integrator: str = "dop853",
    step: float | None = None,
    until: str | None = None,
    earlier: EarlierRun | None = None,
    progress: Progress | None = None,
) -> BodyTrajectory: ...


def simulate(
    spec: Scene | PlanarBeam | NodalBody,
    *,
    duration: float | None = None,
    output: float | None = None,
    tolerance: float | None = None,
    integrator: str = "dop853",
    step: float | None = None,
    until: str | None = None,
    earlier: EarlierRun | None = None,
    inputs: Mapping[str, InputFunction] | None = None,
    progress: Progress | None = None,
) -> Trajectory | BodyTrajectory:
    """The motion of a scene from its consistent initial state, or of a single body from its `start`.

    A single beam is simulated as a scene in which it is the body "beam".

    duration, output, tolerance: the time, s, the interval between rows, s, and the error of a step, instead of those of
    the `simulation` of the specification. integrator: a name in `INTEGRATORS`; a body takes dop853, rk45 and rk4. step:
    that of integrators with fixed steps, s; the others refuse it. until: a condition on columns that ends the motion,
    such as "rod_phi > pi/2"; of dop853 and rk45. earlier: a run that is continued, see `read_run`; its rows come first.
    inputs: of a scene, functions of the time (s) in Python in place of those of the specification, by the names of the
    run-time inputs; that of a prescribed motion returns its first two time derivatives as well.
    progress: called with the time (s) that the integration has reached.

    Raises TypeError for anything else, SpecError, UnknownNameError, CompilerError, ModelError, SimulationError.
    """
    if isinstance(spec, PlanarBeam):
        spec = beam_scene(spec)
    if not isinstance(spec, (Scene, NodalBody)):
        what = f"a scene, a beam or a body given by nodes is needed, not {type(spec).__name__}"
        raise TypeError(f"{what}; read its file with derive.read(...)")
    simulation = simulation_settings(spec, duration, output, tolerance, until)
    if isinstance(spec, NodalBody):
        return simulate_body(spec, simulation, integrator, step, earlier, progress)
    return _simulate_scene(spec, simulation, integrator, step, earlier, inputs or {}, progress)


def _simulate_scene(
    scene: Scene,
    simulation: Simulation,
    integrator: str,
    step: float | None,
    earlier: EarlierRun | None,
    inputs: Mapping[str, InputFunction],
    progress: Progress | None,
) -> Trajectory:
    compile_integrator = INTEGRATORS[integrator]
    given = dict(inputs)
    scene = with_functions(scene, given)
    check_drives(scene, simulation.duration)
    model = lower(derive(scene))
    check_plots(scene, column_units(scene, model))
    compiled = compile_integrator(model_files(model, scene))
    native = scene_of(compiled.native, integrator)
    if given:
        if compiled.through_python is None:
            raise SimulationError(
                f"{integrator} calls C alone, which knows no functions of Python for {', '.join(given)}; choose "
                "dop853, rk45 or ida, or write the functions in the specification"
            )
        native = DrivenScene(native, scene, given)
        compiled = compiled.through_python(native)
    k = native.setup()
    initial = initial_state(scene, native, k)
    q, v, times = initial.q, initial.v, output_times(simulation)
    if earlier is not None:
        q, v, times = earlier.q, earlier.v, earlier.times(times)
    names = tuple(column_units(scene, model))

    def row(solution: Solution) -> dict[str, float]:
        values = column_values(scene, native, k, solution)
        return {name: float(column[0]) for name, column in zip(names, values, strict=True)}

    until = stop_event(simulation, row, native, k, q, v)
    settings = Settings(tolerance=simulation.tolerance, step=step, breaks=breaks(scene), until=until, progress=progress)
    solution = compiled.integrate(k, q, v, times, settings)
    if earlier is not None:
        solution = earlier.continued(model, solution)
    motion = SceneMotion(scene, native, k, solution.t, solution.q, solution.v)
    return Trajectory(scene, model, initial, motion, solution, RunSettings(simulation, integrator, step))


def simulation_settings(
    spec: Scene | NodalBody,
    duration: float | None = None,
    output: float | None = None,
    tolerance: float | None = None,
    until: str | None = None,
) -> Simulation:
    """The `simulation` of a scene or a body with the values that are given instead.

    Raises SpecError if it is incomplete or wrong.
    """
    given = {"duration": duration, "output": output, "tolerance": tolerance, "until": until}
    changes: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    if spec.simulation is not None and not changes:
        return spec.simulation
    if spec.simulation is None and not {"duration", "output"} <= set(changes):
        text = "this table is missing; add it, with `duration` (s) and `output`, the time between rows (s)"
        raise SpecError((Problem("simulation", text),))
    changed = replace(spec.simulation, **changes) if spec.simulation else Simulation(**changes)
    simulation = validated(replace(spec, simulation=changed)).simulation
    assert simulation is not None
    return simulation


def check_plots(scene: Scene, columns: Iterable[str]) -> None:
    """Raise SpecError if plots name columns that the motion does not have."""
    known = tuple(columns)
    problems = [
        Problem(f"plots.{plot.name}.{key}", f"there is no column {quoted(name)}{_nearest(name, known)}")
        for plot in scene.plots
        if isinstance(plot.quantity, ColumnCurves)
        for key, names in (("x", (plot.quantity.x,)), ("y", plot.quantity.y))
        for name in names
        if name not in known
    ]
    if problems:
        raise SpecError(tuple(problems))


def _nearest(name: str, known: tuple[str, ...]) -> str:
    return did_you_mean(name, known, f"the columns are {', '.join(known)}")
