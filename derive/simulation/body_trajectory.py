"""The motion of a single body in space as named columns, and the simulation that computes it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from derive.backends.model_files import model_files
from derive.derivation import derive, lower
from derive.errors import Problem, SpecError
from derive.ir.model import Model
from derive.runtime.native_body import NativeBody
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.earlier_run import EarlierRun
from derive.simulation.integration.integrator import Settings
from derive.simulation.integration.registry import INTEGRATORS
from derive.simulation.integration.solution import Progress, Solution
from derive.simulation.observables.csv_writer import Column
from derive.simulation.output_times import output_times
from derive.simulation.stop_condition import stop_event
from derive.simulation.trajectory import ColumnTable, RunSettings
from derive.spec.model.body import NodalBody
from derive.spec.model.simulation import Simulation, SpatialStart

ENERGIES = ("kinetic_energy", "strain_energy", "gravity_potential")
"""The names of the energies, in the order of the model; the last only where there is gravity."""


@dataclass(frozen=True, eq=False, repr=False)
class BodyTrajectory(ColumnTable):
    """The motion of a single body in space, as named columns: `trajectory["omega1"]` is a vector (n,) in SI units.

    The columns are the time "t", coordinates, generalised velocities, and energies. `model` and `native` are the
    kernels and their compiled functions, k (nk,) the constants of `setup`, `settings` how it was computed. An unknown
    name raises UnknownNameError.
    """

    body: NodalBody
    model: Model
    native: NativeBody
    k: Vector
    solution: Solution
    settings: RunSettings

    @property
    def name(self) -> str:
        """The name of the body."""
        return self.body.name

    @cached_property
    def energies(self) -> Matrix:
        """(n, energies): kinetic energy, strain energy and, with gravity, its potential, J."""
        states = zip(self.q, self.v, strict=True)
        return np.array([self.native.energy(q, v, self.k) for q, v in states])

    @cached_property
    def table(self) -> tuple[Column, ...]:
        """All columns with their names, units and values (n,)."""
        variables = [(x.name, x.unit) for x in (*self.model.coordinates, *self.model.velocities)]
        columns = [Column("t", "s", self.t)]
        for (name, unit), values in zip(variables, (*self.q.T, *self.v.T), strict=True):
            columns.append(Column(name, "" if unit == "1" else unit, values))
        columns += [Column(name, "J", values) for name, values in zip(ENERGIES, self.energies.T, strict=False)]
        return tuple(columns)


def simulate_body(
    body: NodalBody,
    simulation: Simulation,
    integrator: str,
    step: float | None,
    earlier: EarlierRun | None,
    progress: Progress | None,
) -> BodyTrajectory:
    """The motion of a body from its `start`; arguments as for `simulate`."""
    compile_integrator = INTEGRATORS[integrator]
    model = lower(derive(body))
    q, v = initial_vectors(model, body.start)
    times = output_times(simulation)
    if earlier is not None:
        q, v, times = earlier.q, earlier.v, earlier.times(times)
    compiled = compile_integrator(model_files(model, body))
    native = compiled.native
    assert isinstance(native, NativeBody)
    k = native.setup()
    run = RunSettings(simulation, integrator, step)

    def row(solution: Solution) -> dict[str, float]:
        table = BodyTrajectory(body, model, native, k, solution, run).table
        return {column.name: float(column.values[0]) for column in table}

    until = stop_event(simulation, row, native, k, q, v)
    settings = Settings(tolerance=simulation.tolerance, step=step, until=until, progress=progress)
    solution = compiled.integrate(k, q, v, times, settings)
    if earlier is not None:
        solution = earlier.continued(model, solution)
    solution = replace(solution, notes=(*_normalised(body.start), *solution.notes))
    return BodyTrajectory(body, model, native, k, solution, run)


def _normalised(start: SpatialStart) -> tuple[str, ...]:
    """A note if the quaternion of an initial state has another length than 1, apart from rounding errors."""
    length = float(np.linalg.norm(start.quaternion))
    return () if abs(length - 1.0) < 1e-12 else (f"body.start.rotation: length of the quaternion {length:.9g} -> 1",)


def initial_vectors(model: Model, start: SpatialStart) -> tuple[Vector, Vector]:
    """q (nq,) and v (nv,) of an initial state; the quaternion is made to have length 1.

    Raises SpecError if there are more amplitudes than modes.
    """
    modes = len(model.velocities) - 6
    problems = [
        Problem(f"body.start.{key}", f"there are {len(values)} numbers, and the body has {modes} modes")
        for key, values in (("amplitudes", start.amplitudes), ("amplitude_rates", start.amplitude_rates))
        if len(values) > modes
    ]
    if problems:
        raise SpecError(tuple(problems))
    quaternion = np.array(start.quaternion) / np.linalg.norm(start.quaternion)
    q = np.concatenate([start.position, quaternion, _padded(start.amplitudes, modes)])
    v = np.concatenate([start.velocity, start.angular_velocity, _padded(start.amplitude_rates, modes)])
    return q, v


def _padded(values: tuple[float, ...], size: int) -> Vector:
    return np.array([*values, *(0.0 for _ in range(size - len(values)))])
