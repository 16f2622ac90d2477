"""The simulation of a scene in memory: derive, compile, find a consistent state, integrate."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from typing import Any

import numpy as np

from derive.backends.model_files import model_files
from derive.derivation import derive, lower
from derive.errors import Problem, SpecError, TisserandError
from derive.ir.model import Model
from derive.registry import UnknownNameError
from derive.runtime.native_call import Vector
from derive.simulation.initial.consistent_state import InitialState
from derive.simulation.initial.initial_state import initial_state
from derive.simulation.integration.integrator import Settings
from derive.simulation.integration.registry import INTEGRATORS
from derive.simulation.integration.solution import Progress, Solution
from derive.simulation.observables.csv_writer import Column
from derive.simulation.observables.motion import SceneMotion, drive_unit, drive_values
from derive.spec.construction import validated
from derive.spec.model.scene import Scene, Simulation


class PandasMissing(TisserandError):
    """The package pandas is not installed."""


@dataclass(frozen=True, eq=False)
class Trajectory(Mapping[str, Vector]):
    """The motion of a scene, as named columns: `trajectory["rod_phi"]` is a vector (n,) in SI units.

    The columns are the time "t", what drives prescribe, coordinates, their rates, and multipliers, by the names of
    `columns`; `units` has their units. q (n, nq), v (n, nv) and lam (n, nlambda) are the same as matrices. `solution`
    adds drift and cost, `initial` is the consistent initial state, `motion` what observables are computed from, `model`
    the kernels. An unknown name raises UnknownNameError.
    """

    scene: Scene
    model: Model
    initial: InitialState
    motion: SceneMotion
    solution: Solution

    @cached_property
    def table(self) -> tuple[Column, ...]:
        """All columns with their names, units and values (n,)."""
        solution, model = self.solution, self.model
        columns = [Column("t", "s", solution.t)]
        columns += [Column(d.name, drive_unit(self.scene, d), drive_values(d, solution.t)) for d in self.scene.drives]
        for prefix, variables, values in (
            ("", model.coordinates, solution.q),
            ("", model.velocities, solution.v),
            ("lambda_", model.multipliers, solution.lam),  # a drive and its multiplier have one name otherwise
        ):
            columns += [Column(f"{prefix}{x.name}", x.unit, y) for x, y in zip(variables, values.T, strict=True)]
        return tuple(columns)

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the columns."""
        return tuple(column.name for column in self.table)

    @property
    def units(self) -> dict[str, str]:
        """The unit of each column, "" of a number without unit."""
        return {column.name: column.unit for column in self.table}

    @property
    def t(self) -> Vector:
        """The times (n,), s."""
        return self.solution.t

    @property
    def q(self) -> Vector:
        """The coordinates (n, nq)."""
        return self.solution.q

    @property
    def v(self) -> Vector:
        """The generalised velocities (n, nv)."""
        return self.solution.v

    @property
    def lam(self) -> Vector:
        """The Lagrange multipliers (n, nlambda)."""
        return self.solution.lam

    def to_pandas(self) -> Any:
        """A pandas.DataFrame with the columns, indexed by time (s). Raises PandasMissing."""
        try:
            pandas = import_module("pandas")
        except ImportError as error:
            raise PandasMissing("to_pandas needs the package pandas: pip install pandas") from error
        index = pandas.Index(self.t, name="t")
        return pandas.DataFrame({column.name: column.values for column in self.table[1:]}, index=index)

    def __getitem__(self, name: str) -> Vector:
        for column in self.table:
            if column.name == name:
                return column.values
        raise UnknownNameError(f"column of {self.scene.name}", name, self.columns)

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.table)

    def __repr__(self) -> str:
        span = f"{len(self.t)} rows from {self.t[0]:g} to {self.t[-1]:g} s"
        return f"Trajectory of {self.scene.name}: {span}, columns {', '.join(self.columns)}"


def simulate(
    scene: Scene,
    *,
    duration: float | None = None,
    output: float | None = None,
    tolerance: float | None = None,
    integrator: str = "dop853",
    step: float | None = None,
    progress: Progress | None = None,
) -> Trajectory:
    """The motion of a scene from its consistent initial state.

    duration, output, tolerance: the time, s, the interval between rows, s, and the error of a step, instead of those of
    the `simulation` of the scene. integrator: a name in `INTEGRATORS`. step: that of integrators with fixed steps, s;
    the others refuse it.
    progress: called with the time (s) that the integration has reached.

    Raises TypeError for anything but a scene, SpecError, UnknownNameError, CompilerError, ModelError, SimulationError.
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"a scene is needed, not {type(scene).__name__}; read its file with derive.read(...)")
    settings = simulation_settings(scene, duration, output, tolerance)
    compile_integrator = INTEGRATORS[integrator]
    model = lower(derive(scene))
    compiled = compile_integrator(model_files(model, scene))
    native = compiled.native
    k = native.setup()
    initial = initial_state(scene, native, k)
    solution = compiled.integrate(
        k,
        initial.q,
        initial.v,
        output_times(settings),
        Settings(tolerance=settings.tolerance, step=step, progress=progress),
    )
    motion = SceneMotion(scene, native, k, solution.t, solution.q, solution.v)
    return Trajectory(scene, model, initial, motion, solution)


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


def output_times(simulation: Simulation) -> Vector:
    """The times (n,) of the rows, s: multiples of `output`, and the end."""
    count = math.floor(simulation.duration / simulation.output * (1 + 1e-12))
    times = np.minimum(np.arange(count + 1) * simulation.output, simulation.duration)
    rest = simulation.duration - times[-1]
    return np.append(times, simulation.duration) if rest > 1e-9 * simulation.output else times
