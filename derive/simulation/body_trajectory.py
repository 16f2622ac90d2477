"""The motion of a single body in space as named columns."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from derive.ir.model import Model
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.integration.solution import Solution
from derive.simulation.observables.csv_writer import Column
from derive.simulation.trajectory import ColumnTable, RunSettings
from derive.spec.model.body import NodalBody

ENERGIES = ("kinetic_energy", "strain_energy", "gravity_potential")
"""The names of the energies, in the order of the model; the last only where there is gravity."""


def energy_names(model: Model) -> tuple[str, ...]:
    """The names of the columns of the energies of a body."""
    return ENERGIES[: len(model.kernel("energy").outputs[0].elements)]


def body_column_units(model: Model) -> list[tuple[str, str]]:
    """The names of the columns of a trajectory of a body, with their units, before it is computed."""
    variables = [
        (name, "" if x.unit == "1" else x.unit) for x in (*model.coordinates, *model.velocities) for name in x.elements
    ]
    return [("t", "s"), *variables, *((name, "J") for name in energy_names(model))]


def body_column_values(native: NativeScene, k: Vector, solution: Solution) -> list[Vector]:
    """The values (n,) of the columns of a trajectory of a body, in the order of `body_column_units`."""
    states = zip(solution.q, solution.v, strict=True)
    energies = np.array([native.energy(q, v, k) for q, v in states])
    return [solution.t, *solution.q.T, *solution.v.T, *energies.T]


@dataclass(frozen=True, eq=False, repr=False)
class BodyTrajectory(ColumnTable):
    """The motion of a single body in space, as named columns: `trajectory["omega1"]` is a vector (n,) in SI units.

    The columns are the time "t", coordinates, generalised velocities, and energies. `model` and `native` are the
    kernels and their compiled functions, k (nk,) the constants of `setup`, `settings` how it was computed. An unknown
    name raises UnknownNameError.
    """

    body: NodalBody
    model: Model
    native: NativeScene
    k: Vector
    solution: Solution
    settings: RunSettings

    @property
    def name(self) -> str:
        """The name of the body."""
        return self.body.name

    @property
    def spec(self) -> NodalBody:
        """The body."""
        return self.body

    @property
    def energies(self) -> Matrix:
        """The energies (n, energies), J: kinetic energy, strain energy and, with gravity, its potential."""
        return np.column_stack([self[name] for name in energy_names(self.model)])

    @cached_property
    def table(self) -> tuple[Column, ...]:
        """All columns with their names, units and values (n,)."""
        values = body_column_values(self.native, self.k, self.solution)
        return tuple(Column(*named, each) for named, each in zip(body_column_units(self.model), values, strict=True))
