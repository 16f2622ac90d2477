"""The motion of a scene, or of a body in space alone, as named columns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from derive.display import html
from derive.ir.model import Model
from derive.notes.scene_notes import scene_notes
from derive.registry import UnknownNameError
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.short_text import counted, listed, summary
from derive.simulation.conversions import data_frame, data_set
from derive.simulation.initial.initial_state import InitialState
from derive.simulation.integration.solution import Solution
from derive.simulation.observables.csv_writer import Column
from derive.simulation.observables.motion import SceneMotion, drive_unit, simulated_drive
from derive.simulation.observables.outputs import port_values
from derive.simulation.observables.stresses import stress_columns, stress_values
from derive.simulation.validity.monitoring_outputs import monitoring_outputs
from derive.simulation.validity.monitors import Monitor, warnings
from derive.spec.model.body import NodalBody
from derive.spec.model.simulation import Simulation
from derive.spec.model.specification import AnyScene

ENERGIES = ("kinetic_energy", "strain_energy", "gravity_potential")
"""The names of the energies, in the order of the model; the last only where there is gravity."""


@dataclass(frozen=True)
class RunSettings:
    """The settings of a run: a name in `INTEGRATORS`, and the step (s) that is given to one with fixed steps."""

    simulation: Simulation
    integrator: str = "adaptive"
    step: float | None = None


def column_units(scene: AnyScene, model: Model, alone: NodalBody | None = None) -> list[tuple[str, str]]:
    """The names of the columns of a trajectory in a scene, with their units, before it is computed.

    alone: a body in space that is simulated alone, in an empty scene.
    """
    return [
        ("t", "s"),
        *((drive.name, drive_unit(scene, drive)) for drive in scene.drives),
        *(
            (name, "" if x.unit == "1" else x.unit)
            for x in (*model.coordinates, *model.velocities)
            for name in x.columns
        ),
        # a drive and its multiplier have one name
        *((f"lambda_{name}", x.unit) for x in model.multipliers for name in x.columns),
        *((f"u_{x.title}", x.unit) for x in model.inputs),
        *((name, x.unit) for x in model.outputs for name in x.columns),
        *((name, "J") for name in energy_names(scene, model)),
        *((name, "Pa") for name in stress_columns(scene, alone)),
    ]


def energy_names(scene: AnyScene, model: Model) -> tuple[str, ...]:
    """The names of the columns of the energies, which a body alone has in place of the outputs of a scene."""
    return () if scene.bodies else ENERGIES[: len(model.kernel("energy").outputs[0].elements)]


def column_values(
    scene: AnyScene, native: NativeScene, k: Vector, solution: Solution, alone: NodalBody | None = None
) -> list[Vector]:
    """The values (n,) of the columns of a trajectory in a scene, in the order of `column_units`."""
    drives = [simulated_drive(native, drive, solution.t) for drive in scene.drives]
    monitors = {output.name for output in monitoring_outputs(scene)} if native.outputs else set[str]()
    inputs, outputs = port_values(native, k, solution, monitors)
    columns = [solution.t, *drives, *solution.q.T, *solution.v.T, *solution.lam.T, *inputs.T, *outputs.T]
    if not scene.bodies:
        states = zip(solution.q, solution.v, strict=True)
        columns += [*np.array([native.energy(q, v, k) for q, v in states]).T]
    return [*columns, *stress_values(scene, native, solution.q, alone)]


def column_docs(scene: AnyScene, model: Model, alone: NodalBody | None = None) -> list[str]:
    """The description of each column of a trajectory in a scene, in the order of `column_units`."""
    return [
        "time",
        *(f"prescribed motion of {drive.joint}" for drive in scene.drives),
        *(x.doc for x in (*model.coordinates, *model.velocities) for _ in x.columns),
        *(f"multiplier: {x.doc}" for x in model.multipliers for _ in x.columns),
        *(f"input: {x.doc}" for x in model.inputs),
        *(x.doc for x in model.outputs for _ in x.columns),
        *(name.replace("_", " ") for name in energy_names(scene, model)),
        *("largest stress of von Mises" for _ in stress_columns(scene, alone)),
    ]


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory(Mapping[str, Vector]):
    """The motion of a scene, as named columns: `trajectory["rod_phi"]` is a vector (n,) in SI units.

    The columns are the time "t", the prescribed motions of drives, coordinates, their rates, multipliers, inputs that
    follow functions in Python, and outputs, by the names of `columns`; `units` has their units. q (n, nq), v (n, nv)
    and lam (n, nlambda) are the same as matrices. An unknown name raises UnknownNameError.

    Attributes:
        scene: the scene that is simulated; empty for a body in space alone, whose last columns are its energies, J.
        model: the kernels.
        initial: the consistent initial state.
        motion: the basis of observables.
        solution: the result of the integration, with its drift and cost.
        settings: those of the run.
        validity: the monitors of each beam; `warnings` has the beams that pass a limit.
        body: the body in space, if it is simulated alone.

    Examples:
        >>> import derive
        >>> ball = derive.scene(
        ...     "flight", gravity=(0, -10), bodies={"ball": {"mass": 1, "inertia": 1, "start": {"velocity": (3, 4)}}}
        ... )
        >>> trajectory = derive.simulate(ball, duration=0.8, output=0.4)
        >>> trajectory.columns
        ('t', 'ball_c1', 'ball_c2', 'ball_phi', 'ball_c1dot', 'ball_c2dot', 'ball_phidot')
        >>> trajectory["ball_c2"].round(6) + 0.0
        array([0. , 0.8, 0. ])
        >>> trajectory.units["ball_phidot"], trajectory.q.shape
        ('rad/s', (3, 3))
    """

    scene: AnyScene
    model: Model
    initial: InitialState
    motion: SceneMotion
    solution: Solution
    settings: RunSettings
    validity: tuple[Monitor, ...] = ()
    body: NodalBody | None = None

    @property
    def warnings(self) -> tuple[str, ...]:
        """The beams whose models are not valid in this motion, with the cause, the implied error and the remedy."""
        return warnings(self.validity)

    @property
    def name(self) -> str:
        """The name of the model."""
        return self.scene.name

    @property
    def spec(self) -> AnyScene | NodalBody:
        """The scene or body that is simulated."""
        return self.body or self.scene

    @property
    def notes(self) -> tuple[str, ...]:
        """The notes on bodies whose motion is prescribed, on the initial state, and on the run."""
        return *scene_notes(self.scene), *self.initial.notes, *self.solution.notes

    @cached_property
    def table(self) -> tuple[Column, ...]:
        """All columns with their names, units and values (n,); the first is the time."""
        values = column_values(self.scene, self.motion.native, self.motion.k, self.solution, self.body)
        units = column_units(self.scene, self.model, self.body)
        return tuple(Column(*named, column) for named, column in zip(units, values, strict=True))

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

    @property
    def energies(self) -> Matrix:
        """The energies (n, energies) of a body alone, J: kinetic, strain and, with gravity, potential energy."""
        names = energy_names(self.scene, self.model)
        return np.column_stack([self[name] for name in names]) if names else np.zeros((len(self.t), 0))

    def to_pandas(self) -> Any:
        """A pandas.DataFrame with the columns, indexed by time (s).

        Raises:
            PandasMissing: if pandas is not installed.

        Examples:
            >>> trajectory.to_pandas()["ball_c1"].round(3).tolist()
            [0.0, 1.2, 2.4]
        """
        return data_frame(self.table)

    def to_xarray(self) -> Any:
        """An xarray.Dataset with the columns over the dimension `time` (s), with their units and descriptions.

        The attributes of a column are `units` and `long_name`.

        Raises:
            XarrayMissing: if xarray is not installed.

        Examples:
            >>> trajectory.to_xarray()["ball_c1"].units
            'm'
        """
        return data_set(
            self.name, self.table, dict(zip(self.columns, column_docs(self.scene, self.model, self.body), strict=True))
        )

    def __getitem__(self, name: str) -> Vector:
        for column in self.table:
            if column.name == name:
                return column.values
        raise UnknownNameError(f"column of {self.name}", name, self.columns)

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.table)

    def __repr__(self) -> str:
        span = f"{len(self.t)} rows from {self.t[0]:g} to {self.t[-1]:g} s"
        warned = f"{counted(len(self.warnings), 'warning')}: {self.warnings[0]}" if self.warnings else ""
        rows = {"columns": listed(self.columns), "warnings": warned, "notes": "; ".join(self.notes)}
        return summary(f"Trajectory of {self.name}: {span}", rows)

    _repr_html_ = html
