"""One simulation of a scene, from the specification to its trajectory, in memory."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from derive.backends.model_files import model_files
from derive.derivation import derive, lower
from derive.ir.model import Model
from derive.runtime.native import Vector, load_scene
from derive.simulation.initial.consistent_state import Start
from derive.simulation.initial.initial_state import begin
from derive.simulation.integration.explicit import integrate
from derive.simulation.integration.trajectory import Trajectory
from derive.simulation.observables.csv_writer import Column
from derive.simulation.observables.observables import Motion, drive_unit, driven
from derive.spec.model.scene import Scene, Simulation


@dataclass(frozen=True, eq=False)
class Run:
    """A scene, the model that was made of it, where it started, and its trajectory."""

    scene: Scene
    model: Model
    start: Start
    motion: Motion
    trajectory: Trajectory


def run(scene: Scene, progress: Callable[[float], None] | None = None) -> Run:
    """Derive, compile, start and integrate a scene with a `simulation`; `progress` is told the times (s) it reaches.

    Raises SpecError, CompilerError, ModelError, SimulationError.
    """
    assert scene.simulation is not None
    model = lower(derive(scene))
    native = load_scene(model_files(model, scene))
    k = native.setup()
    start = begin(scene, native, k)
    found = integrate(
        native,
        k,
        start.q,
        start.v,
        instants(scene.simulation),
        tolerance=scene.simulation.tolerance,
        progress=progress,
    )
    return Run(scene, model, start, Motion(scene, native, k, found.t, found.q, found.v), found)


def instants(simulation: Simulation) -> Vector:
    """The times of the rows, s: every `output`, and the end."""
    count = math.floor(simulation.duration / simulation.output * (1 + 1e-12))
    times = np.minimum(np.arange(count + 1) * simulation.output, simulation.duration)
    rest = simulation.duration - times[-1]
    return np.append(times, simulation.duration) if rest > 1e-9 * simulation.output else times


def columns(done: Run) -> list[Column]:
    """What is written of a run: the time, drives, coordinates, rates, multipliers."""
    found, model = done.trajectory, done.model
    first = [Column("t", "s", found.t)]
    first += [Column(d.name, drive_unit(done.scene, d), driven(d, found.t)) for d in done.scene.drives]
    for variables, values in ((model.coordinates, found.q), (model.rates, found.v), (model.multipliers, found.lam)):
        first += [Column(x.name, x.unit, row) for x, row in zip(variables, values.T, strict=True)]
    return first
