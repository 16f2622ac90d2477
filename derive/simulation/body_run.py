"""The simulation of a single body in space from its `start`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from derive.artifacts import File
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.body_trajectory import BodyTrajectory, body_column_units, body_column_values
from derive.simulation.initial.spatial_state import initial_vectors, normalised
from derive.simulation.integration.integrator import Integrator
from derive.simulation.integration.solution import Solution
from derive.simulation.observables.default_plots import body_plots
from derive.simulation.prepared_run import PreparedRun
from derive.spec.model.body import NodalBody
from derive.spec.model.plots import Plot

NO_INPUTS = "a body in space has no run-time inputs; make it part of a scene, or leave `inputs` out"
"""The message of the error for run-time inputs of a body."""


class BodyRun(PreparedRun[NativeScene, None, BodyTrajectory]):
    """The simulation of a body in space."""

    def __init__(self, body: NodalBody, integrator: str, step: float | None) -> None:
        self.body, self.size = body, float(np.linalg.norm(np.ptp(body.data.positions, axis=0))) or 1.0
        super().__init__(body, integrator, step)
        self._initial = initial_vectors(self.model, body.start)

    def _columns(self) -> Sequence[tuple[str, str]]:
        return body_column_units(self.model)

    def _default_plots(self) -> Sequence[Plot]:
        return body_plots(self.body, self.model)

    def _compiled(self, files: Sequence[File]) -> tuple[NativeScene, Integrator]:
        compiled = self._compile(files)
        return compiled.native, compiled

    def _start(self, native: NativeScene, k: Vector) -> tuple[Vector, Vector, None]:
        return *self._initial, None

    def _values(self, native: NativeScene, k: Vector, solution: Solution) -> Sequence[Vector]:
        return body_column_values(native, k, solution)

    def _result(self, native: NativeScene, k: Vector, start: None, solution: Solution) -> BodyTrajectory:
        solution = replace(solution, notes=(*normalised(self.body.start), *solution.notes))
        return BodyTrajectory(self.body, self.model, native, k, solution, self.settings)
