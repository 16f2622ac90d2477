"""The simulation of a scene in memory: derive, compile, find a consistent state, integrate."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from derive.backends.model_files import model_files
from derive.derivation import derive, lower
from derive.errors import Problem, SpecError, quoted
from derive.runtime.native_call import Vector
from derive.simulation.initial.initial_state import initial_state
from derive.simulation.inputs import DrivenScene, InputFunction, driven_integration, with_functions
from derive.simulation.integration.integrator import Settings
from derive.simulation.integration.registry import INTEGRATORS
from derive.simulation.integration.solution import Progress
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.trajectory import RunSettings, Trajectory, column_units
from derive.spec.construction import validated
from derive.spec.model.scene import ColumnCurves, Scene, Simulation
from derive.spec.parsing.faults import did_you_mean


def simulate(
    scene: Scene,
    *,
    duration: float | None = None,
    output: float | None = None,
    tolerance: float | None = None,
    integrator: str = "dop853",
    step: float | None = None,
    inputs: Mapping[str, InputFunction] | None = None,
    progress: Progress | None = None,
) -> Trajectory:
    """The motion of a scene from its consistent initial state.

    duration, output, tolerance: the time, s, the interval between rows, s, and the error of a step, instead of those of
    the `simulation` of the scene. integrator: a name in `INTEGRATORS`. step: that of integrators with fixed steps, s;
    the others refuse it.
    inputs: functions of the time (s) in Python in place of those of the specification, by the names of the run-time
    inputs; that of a prescribed motion returns its first two time derivatives as well.
    progress: called with the time (s) that the integration has reached.

    Raises TypeError for anything but a scene, SpecError, UnknownNameError, CompilerError, ModelError, SimulationError.
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"a scene is needed, not {type(scene).__name__}; read its file with derive.read(...)")
    simulation = simulation_settings(scene, duration, output, tolerance)
    compile_integrator = INTEGRATORS[integrator]
    given = dict(inputs or {})
    scene = with_functions(scene, given)
    model = lower(derive(scene))
    check_plots(scene, column_units(scene, model))
    compiled = compile_integrator(model_files(model, scene))
    native, integrate = compiled.native, compiled.integrate
    if given:
        native = DrivenScene(native, scene, given)
        integrate = driven_integration(native, integrator)
    k = native.setup()
    initial = initial_state(scene, native, k)
    solution = integrate(
        k,
        initial.q,
        initial.v,
        output_times(simulation),
        Settings(tolerance=simulation.tolerance, step=step, progress=progress),
    )
    motion = SceneMotion(scene, native, k, solution.t, solution.q, solution.v)
    return Trajectory(scene, model, initial, motion, solution, RunSettings(simulation, integrator, step))


def simulation_settings(
    scene: Scene, duration: float | None = None, output: float | None = None, tolerance: float | None = None
) -> Simulation:
    """The `simulation` of a scene with the values that are given instead. Raises SpecError if incomplete or wrong."""
    given = {"duration": duration, "output": output, "tolerance": tolerance}
    changes = {name: value for name, value in given.items() if value is not None}
    if scene.simulation is not None and not changes:
        return scene.simulation
    if scene.simulation is None and not {"duration", "output"} <= set(changes):
        text = "this table is missing; add it, with `duration` (s) and `output`, the time between rows (s)"
        raise SpecError((Problem("simulation", text),))
    changed = replace(scene.simulation, **changes) if scene.simulation else Simulation(**changes)
    simulation = validated(replace(scene, simulation=changed)).simulation
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


def output_times(simulation: Simulation) -> Vector:
    """The times (n,) of the rows, s: multiples of `output`, and the end."""
    count = math.floor(simulation.duration / simulation.output * (1 + 1e-12))
    times = np.minimum(np.arange(count + 1) * simulation.output, simulation.duration)
    rest = simulation.duration - times[-1]
    return np.append(times, simulation.duration) if rest > 1e-9 * simulation.output else times
