"""A simulation that is ready to run: its specification has been checked completely."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Generic, TypeVar

from derive.artifacts import File
from derive.errors import Problem, SpecError, quoted
from derive.generated_models import generated, generated_explicit
from derive.ir.model import Model
from derive.runtime.integrators.watch import Watch
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.earlier_run import EarlierRun
from derive.simulation.integration.integrator import Integrator, Settings
from derive.simulation.integration.registry import EXPLICIT, INTEGRATORS
from derive.simulation.integration.solution import Progress, Solution
from derive.simulation.output_times import output_times
from derive.simulation.stop_condition import StateColumn, stop_condition, stop_event
from derive.simulation.trajectory import ColumnTable, RunSettings
from derive.spec.checks.plotted_columns import missing_columns
from derive.spec.model.body import NodalBody
from derive.spec.model.plots import Plot
from derive.spec.model.scene import Scene
from derive.spec.parsing.condition import Row
from derive.spec.parsing.faults import path_text

Native = TypeVar("Native", bound=NativeScene)
Start = TypeVar("Start")
Result = TypeVar("Result", bound=ColumnTable)


class PreparedRun(ABC, Generic[Native, Start, Result]):
    """The simulation of `spec`, with its `model`, its columns and its plots; `trajectory` runs it.

    units: those of the columns by their names. complete_model: the model with the outputs that monitor its validity.
    files: the generated files that are compiled. Subclasses implement the differences of a scene and a body in space.
    """

    breaks: tuple[float, ...] = ()
    """The times (s) at which functions of time jump."""

    size: float
    """The size of the scene or body that is simulated, m."""

    def __init__(self, spec: Scene | NodalBody, integrator: str, step: float | None, complete: bool = True) -> None:
        """Arguments as for `simulate`; the specification has a `simulation`. Raises SpecError, UnknownNameError.

        complete: whether the model has all functions; otherwise a scene for an explicit integrator has those it calls.
        """
        assert spec.simulation is not None, "simulation_settings makes it"
        self.spec, self.settings = spec, RunSettings(spec.simulation, integrator, step)
        self._compile = INTEGRATORS[integrator]
        self._monitored = self._with_monitors(spec)
        if isinstance(self._monitored, Scene) and integrator in EXPLICIT and not complete:
            self.complete_model, self.files = generated_explicit(self._monitored)
        else:
            self.complete_model, self.files = generated(self._monitored)
        self.model = self._without_monitors(self.complete_model)
        columns = self._columns()
        self.units = dict(columns)
        problems = [*_repeated(name for name, _ in columns), *plots_of_nothing(spec.plots, tuple(self.units))]
        self._until, wrong = stop_condition(spec.simulation, tuple(self.units))
        if problems or wrong:
            raise SpecError((*problems, *wrong))
        self.plots = (*spec.plots, *self._default_plots())

    def trajectory(
        self,
        earlier: EarlierRun | None = None,
        progress: Progress | None = None,
        announce: Callable[[str], None] | None = None,
    ) -> Result:
        """The motion; arguments as for `simulate`. Raises CompilerError, ModelError, SimulationError.

        announce: called before the integration with each note on the expected motion; the result has these notes too.
        """
        simulation = self.settings.simulation
        native, integrator = self._compiled(self.files)
        k = native.setup()
        q, v, start = self._start(native, k)
        times = output_times(simulation)
        foreseen = tuple(self._foreseen(native, k, q)) if earlier is None else ()
        if announce is not None:
            for text in foreseen:
                announce(text)
        if earlier is not None:
            q, v, times = earlier.q, earlier.v, earlier.times(times)

        def row(solution: Solution) -> Row:
            values = self._values(native, k, solution)
            return {name: float(column[0]) for name, column in zip(self.units, values, strict=True)}

        settings = Settings(
            tolerance=simulation.tolerance,
            size=self.size,
            step=self.settings.step,
            breaks=self.breaks,
            until=stop_event(self._until, row, native, k, self._state_columns(native)),
            progress=progress,
            watch=self._watch(native, k, float(times[0]), q),
        )
        solution = integrator.integrate(k, q, v, times, settings)
        if earlier is not None:
            solution = earlier.continued(self.model, solution)
        return self._result(native, k, start, replace(solution, notes=(*foreseen, *solution.notes)))

    def _with_monitors(self, spec: Scene | NodalBody) -> Scene | NodalBody:
        """The specification that is compiled: with outputs that monitor the validity of its model."""
        return spec

    def _without_monitors(self, model: Model) -> Model:
        """The model without the outputs that monitor its validity."""
        return model

    def _foreseen(self, native: Native, k: Vector, q: Vector) -> Iterable[str]:
        """Notes on expected events of a motion from the initial configuration q (nq,)."""
        return ()

    def _watch(self, native: Native, k: Vector, t: float, q: Vector) -> Watch | None:
        """The quantities that are watched after each step of a motion from q (nq,) at t, s; None if there are none."""
        return None

    def _state_columns(self, native: Native) -> Mapping[str, StateColumn]:
        """The columns that need no more than the time and the state, see `stop_event`."""
        return {}

    @abstractmethod
    def _columns(self) -> Sequence[tuple[str, str]]:
        """The names of the columns with their units."""

    @abstractmethod
    def _default_plots(self) -> Iterable[Plot]:
        """The plots beside those of the specification."""

    @abstractmethod
    def _compiled(self, files: Sequence[File]) -> tuple[Native, Integrator]:
        """The compiled model and the integrator."""

    @abstractmethod
    def _start(self, native: Native, k: Vector) -> tuple[Vector, Vector, Start]:
        """The initial q (nq,) and v (nv,), and the record of the initial state for the result."""

    @abstractmethod
    def _values(self, native: Native, k: Vector, solution: Solution) -> Sequence[Vector]:
        """The values (n,) of the columns."""

    @abstractmethod
    def _result(self, native: Native, k: Vector, start: Start, solution: Solution) -> Result:
        """The motion as named columns."""


def _repeated(names: Iterable[str]) -> Iterator[Problem]:
    seen = set[str]()
    for name in names:
        if name in seen:
            yield Problem("", f"two columns are called {quoted(name)}; choose other names of outputs, inputs or drives")
        seen.add(name)


def plots_of_nothing(plots: Iterable[Plot], known: tuple[str, ...]) -> Iterator[Problem]:
    """The problems of plots of columns that a motion does not have; known: the columns that it has."""
    for path, message in missing_columns(plots, known, f"the columns are {', '.join(known)}"):
        yield Problem(path_text(path), message)
