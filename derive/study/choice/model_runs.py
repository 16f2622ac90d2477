"""The models that a search derives and runs, each of them once, whichever part of the search needs it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from derive.runtime.compiler import QUICK_FLAGS, UNOPTIMISED
from derive.simulation.validity.axial_loads import missing_stiffness_notes
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.plots import Plot
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.measurement import (
    CompiledLadderModel,
    Curves,
    ModelVariant,
    curves_of,
    motion,
    opened,
    preparation,
)
from derive.study.accuracy.modelled_bodies import flexible_members
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.accuracy.reference import bare_plots
from derive.study.choice.reference_models import FLEXIBLE, ReferenceModels

SHORT = 1e9
"""Predicted operations of a run below which the code of a model that is not timed is compiled without optimisation."""

MOST_PIECES = 3
"""The largest number of pieces of a beam whose models of a reference are often chosen."""

Progress = Callable[[str], None]


class ModelRuns:
    """The models of a scene, compiled, and the curves of its plots in their runs.

    scene: with the plots that are compared; bare: a plot for each curve of them. ready: the models with monitors.
    models: those of references. spins: the notes on finite-element bodies that spin fast, by models and by names of
    bodies. progress: takes a line on each task. workers: the number of processes that prepare
    models ahead, until `close`.
    """

    def __init__(self, scene: AnyScene, plots: Sequence[Plot], progress: Progress, workers: int = 0) -> None:
        self.bare = tuple(bare for plot in plots for bare in bare_plots(plot))
        self.scene, self.progress = replace(scene, plots=tuple(plots)), progress
        self.models = ReferenceModels(scene)
        self.lone = len(flexible_members(scene)) == 1
        self._cost = PredictedCost(scene)
        self._ahead = preparation(self.scene, workers)
        self.ready: dict[LadderModel, CompiledLadderModel] = {}
        self._unwatched: dict[LadderModel, CompiledLadderModel] = {}
        self.spins: dict[str, dict[str, str]] = {}
        self._curves: dict[tuple[LadderModel, float], Curves] = {}
        self._seconds: dict[LadderModel, float] = {}

    def compiled(self, model: LadderModel, monitored: bool = True) -> CompiledLadderModel:
        """A model that is ready to run, with monitors or, if they are not needed, perhaps without.

        Raises SpecError, SimulationError, CompilerError.
        """
        if model in self.ready:
            return self.ready[model]
        variant = self._variant(model, monitored)
        models = self.ready if variant.monitored else self._unwatched
        if model not in models:
            self.progress(f"deriving and compiling {model.label} ...")
            models[model] = opened(self._ahead.result(variant))
        return models[model]

    def expect(self, models: Iterable[LadderModel], monitored: bool = False) -> None:
        """Prepare models ahead that are likely to be needed, in this order, see `compiled`."""
        new = (model for model in models if model not in self.ready and (monitored or model not in self._unwatched))
        self._ahead.expect(self._variant(model, monitored) for model in new)

    @property
    def spare(self) -> int:
        """The number of further models to expect so that no process waits."""
        return max(0, 2 * self._ahead.workers - self._ahead.waiting)

    def wait(self) -> None:
        """Wait until no model is being prepared, and prepare no more of those expected, so that runs can be timed."""
        self._ahead.wait()

    def close(self) -> None:
        """Prepare no more models ahead."""
        self._ahead.close()

    def _variant(self, model: LadderModel, monitored: bool) -> ModelVariant:
        if monitored or self._is_candidate(model):
            return ModelVariant(model)
        flags = UNOPTIMISED if self._cost.operations(model) < SHORT else QUICK_FLAGS
        return ModelVariant(model, monitored=False, flags=flags)

    def curves(self, model: LadderModel, tolerance: float, monitored: bool = False) -> Curves:
        """The curves of a run of a model, see `compiled`; its time is kept."""
        if (model, tolerance) not in self._curves:
            of = self.compiled(model, monitored)
            self.progress(f"running {model.label} ...")
            moved = motion(of, tolerance)
            self._seconds[model] = moved.solution.cost.seconds
            t, q, v = moved.solution.t, moved.solution.q, moved.solution.v
            self.spins[model.label] = missing_stiffness_notes(of.scene, of.native, of.k, t, q, v, beams=False)
            self._curves[model, tolerance] = curves_of(self.bare, moved)
        return self._curves[model, tolerance]

    def seconds(self, model: LadderModel) -> float:
        """The time of the last run of a model that `curves` has made."""
        return self._seconds[model]

    def run_with(self, tolerance: float) -> dict[LadderModel, Curves]:
        """The curves of the models that `curves` has run with a tolerance, in the order in which they have been."""
        return {model: curves for (model, of), curves in self._curves.items() if of == tolerance}

    def _is_candidate(self, model: LadderModel) -> bool:
        """Whether a model may well be tried, so that one with monitors serves both; a rigid one has none."""
        few = model.pieces == 1 or (model.pieces <= MOST_PIECES and model.count == FLEXIBLE.count)
        return model.shapes is Shapes.RIGID or (self.lone and few and model.order is not DisplacementOrder.FULL)
