"""The reference of a search: a model of second order, refined until it agrees with others in each direction.

The directions are fewer beams, fewer shapes, nothing truncated, and larger steps: agreement within one family would
prove nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from derive.errors import TisserandError, first_line
from derive.percentages import percent
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.plots import Plot
from derive.spec.model.scene import Scene
from derive.study.accuracy.measurement import CompiledLadderModel, compiled, motion
from derive.study.accuracy.models import LadderModel, Shapes
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.accuracy.reference import Curves, bare_plots, curves_of, rms_difference, with_curve
from derive.terminal import duration_text

FINE, COARSE = 1e-10, 1e-8
"""Tolerances of the reference, and of the run that shows the error of its steps."""
SHARE = 1 / 3
"""The error of a reference over the error that is asked for, at most."""
SIZES = ((2, 3), (2, 4), (3, 4), (4, 4), (5, 5))
"""Beams of each rod, and shapes of each beam, of ever finer references."""
FULL_SHAPES = 2
"""Shapes of the models in which nothing is truncated: what truncation leaves out is in the lowest shapes."""
LONGEST = 120.0
"""Seconds of a run of a finer reference, about, at most."""

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Agreement:
    """How far the reference differs from a coarser model, rms over the peak: in the direction that `label` names."""

    label: str
    difference: float


@dataclass(frozen=True)
class TrustedReference:
    """Plots with the curves of the finest model, and how far coarser models differ from it; `model` is that model.

    errors: those of the models that have run, rms over the peak, in the order in which they did.
    """

    plots: tuple[Plot, ...]
    model: LadderModel
    agreements: tuple[Agreement, ...]
    errors: tuple[tuple[LadderModel, float], ...] = ()

    @property
    def error(self) -> float:
        """The largest of the differences."""
        return max(a.difference for a in self.agreements)


class NotConverged(TisserandError):
    """No reference agrees with coarser models closely enough for the error that is asked for."""


def trusted_reference(
    scene: Scene, plots: Sequence[Plot], error: float, progress: Progress, report: Progress
) -> TrustedReference:
    """A reference whose own error is at most a third of `error`. Raises NotConverged.

    progress: takes what is being done; report: takes a line on each comparison.
    """
    runs = _Runs(scene, plots, progress, report)
    models = _refinements()
    known: TrustedReference | None = None
    further = ""
    for model in models:
        if known is not None and (seconds := runs.predicted_seconds(model, known.model)) > LONGEST:
            further = f"; {model.label} would need {duration_text(seconds)} for a run"
            break
        try:
            known = runs.reference(model, math.inf if model == models[-1] else SHARE * error)
        except TisserandError as failure:
            if known is None or isinstance(failure, NotConverged):
                raise NotConverged(f"the reference cannot be made: {first_line(failure)}") from failure
            further = f"; {model.label} cannot be run: {first_line(failure)}"
            break
        if known.error <= SHARE * error:
            return known
    assert known is not None
    larger = f"an error of more than {percent(known.error / SHARE)}, or " if known.error < SHARE else ""
    worst = max(known.agreements, key=lambda a: a.difference)
    raise NotConverged(
        f"an error of {percent(error)} needs a reference whose own error is a third of it at most, and none that was "
        f"run is so accurate: {known.model.label} differs by {percent(worst.difference)} from that with {worst.label}"
        f"{further}. "
        f"Ask for {larger}a shorter time"
    )


def _refinements() -> tuple[LadderModel, ...]:
    order = DisplacementOrder.TRUNCATED
    return tuple(LadderModel(Shapes.POLYNOMIALS, count, order, "mean", pieces) for pieces, count in SIZES)


@dataclass(frozen=True)
class _Check:
    """What a reference has to agree with in one direction: two models, of which the coarser has a tolerance."""

    label: str
    finer: LadderModel
    coarser: LadderModel
    tolerance: float = FINE


def _checks(model: LadderModel) -> tuple[_Check, ...]:
    """Fewer beams, fewer shapes, larger steps; what truncation leaves out is largest where there are fewer beams.

    The dearest comes last: a model in which nothing is truncated takes a minute to derive.
    """
    fewer = replace(model, pieces=model.pieces - 1)
    few = replace(fewer, count=min(fewer.count, FULL_SHAPES))
    return (
        _Check("fewer beams", model, fewer),
        _Check("fewer shapes", model, replace(model, count=model.count - 1)),
        _Check("larger steps", model, model, COARSE),
        _Check("nothing truncated", few, replace(few, order=DisplacementOrder.FULL)),
    )


class _Runs:
    """The runs of the models of a scene that references need, each of which is made once."""

    def __init__(self, scene: Scene, plots: Sequence[Plot], progress: Progress, report: Progress) -> None:
        self._names = ", ".join(plot.name for plot in plots)
        self._bare = tuple(one for plot in plots for one in bare_plots(plot))
        self._scene, self._progress, self._report = replace(scene, plots=tuple(plots)), progress, report
        self._compiled: dict[LadderModel, CompiledLadderModel] = {}
        self._curves: dict[tuple[LadderModel, float], Curves] = {}
        self._seconds: dict[LadderModel, float] = {}

    def reference(self, model: LadderModel, enough: float) -> TrustedReference:
        """A model as the reference; checks are left out beyond the first that is not met, since `enough` is not."""
        finest = self._curve(model)
        agreements: list[Agreement] = []
        for check in _checks(model):
            difference = self._difference(self._curve(check.finer), self._curve(check.coarser, check.tolerance))
            agreements.append(Agreement(f"{check.label}: {check.coarser.label}", difference))
            self._report(f"reference: {model.label}: {percent(difference)} from {agreements[-1].label}")
            if difference > enough:
                break
        made = tuple(with_curve(plot, model.label, of) for plot, of in zip(self._bare, finest, strict=True))
        errors = [
            (other, self._difference(finest, curves))
            for (other, tolerance), curves in self._curves.items()
            if tolerance == FINE
        ]
        return TrustedReference(made, model, tuple(agreements), tuple(errors))

    def predicted_seconds(self, model: LadderModel, known: LadderModel) -> float:
        """How long a run of a model takes, about, from that of one that is known."""
        cost = PredictedCost(self._scene)
        return self._seconds[known] * cost.operations(model) / cost.operations(known)

    def _difference(self, finer: Curves, coarser: Curves) -> float:
        difference = rms_difference(finer, coarser)
        if difference is None:
            text = f"{self._names}: a curve vanishes all the time, so that there is no error of it to be small"
            raise NotConverged(text)
        return difference

    def _curve(self, model: LadderModel, tolerance: float = FINE) -> Curves:
        if model not in self._compiled:
            self._progress(f"reference: {model.label} ...")
            self._compiled[model] = compiled(self._scene, model, monitored=False)
        if (model, tolerance) not in self._curves:
            moved = motion(self._compiled[model], tolerance)
            self._seconds[model] = moved.solution.cost.seconds
            self._curves[model, tolerance] = curves_of(self._bare, moved)
        return self._curves[model, tolerance]
