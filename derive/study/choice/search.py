"""The search for the cheapest model of a scene that is accurate enough.

First a reference is made that can be trusted. A scene with one beam is then tried with models from cheap to dear. In
a scene with several beams each gets a model of its own: its share in the error is measured, see `beam_shares`, and
combinations are run from cheap to dear. The chosen model has been run and compared with the reference, and none of its
monitors implies a larger error. If no model is accurate enough, full models follow, where truncation may be the
reason, and those that made the reference.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from derive.spec.model.body import DisplacementOrder
from derive.study.accuracy.measurement import Line, Point
from derive.study.accuracy.models import LadderModel, Shapes
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.choice.beam_shares import BeamShare
from derive.study.choice.model_runs import ModelRuns
from derive.study.choice.one_beam import try_more_accurate, try_one_beam
from derive.study.choice.rigid_shares import hardly_matter, rigid_shares
from derive.study.choice.several_beams import try_several_beams
from derive.study.choice.trials import Trials, accurate, usable
from derive.study.choice.trusted_reference import SHARE, TrustedReference, trusted_reference

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Choice:
    """The result of a search for an error: its reference, and the models in the order in which they were tried.

    shares: those of the beams in the error of a scene with several beams, measured against the model `base`.
    """

    error: float
    reference: TrustedReference
    tried: tuple[Line, ...]
    base: LadderModel | None = None
    shares: tuple[BeamShare, ...] = ()

    @property
    def chosen(self) -> tuple[Line, Point] | None:
        """The run with the fewest operations that is accurate enough, of models whose monitors imply no larger error.

        Operations, unlike times, are the same on any machine.
        """
        good = [
            (line, point)
            for line in self.tried
            for point in line.points
            if accurate(line, point, self.error, self.reference.error)
        ]
        return min(good, key=lambda pair: pair[1].operations, default=None)

    @property
    def best(self) -> tuple[Line, Point] | None:
        """The most accurate run."""
        runs = [(line, point) for line in self.tried for point in line.points]
        return min(runs, key=lambda pair: pair[1].rms, default=None)


def quiet(_: str) -> None:
    """Report nothing."""


def choose(runs: ModelRuns, error: float, report: Progress = quiet) -> Choice:
    """The cheapest model of a scene whose plots have at most an error, rms over the peak; see the text of this module.

    report: takes a line on each model.

    Raises NotConverged, SpecError, SimulationError, CompilerError.
    """
    rigid = rigid_shares(runs, error, report)
    known = trusted_reference(runs, error, report, hardly_matter(rigid, error))
    trials = Trials(runs, known, error, report)
    base, shares = None, tuple[BeamShare, ...]()
    if runs.lone:
        try_one_beam(trials)
    elif not trials.is_good(trials.run(LadderModel(Shapes.RIGID))):  # the answer for a slow motion
        base = _base(known, trials.cost, error)
        shares = try_several_beams(trials, base, rigid)
    if not trials.good:
        trials.run_until_good(_with_all_terms(trials))
    if not trials.good:
        trials.run_until_good(model for model, of in known.errors if usable(model) and of <= trials.budget)
    try_more_accurate(trials)
    return Choice(error, known, trials.timed(), base, shares)


def _base(known: TrustedReference, cost: PredictedCost, error: float) -> LadderModel:
    """The cheapest model of the reference whose own error is small against the requested one."""
    good = [model for model, of in known.errors if usable(model) and of <= SHARE * error]
    return min(good, key=cost.operations, default=known.model)


def _with_all_terms(trials: Trials) -> list[LadderModel]:
    """The full variants of the models whose error may come from truncation."""
    models = [line.model for line in trials.lines if line.points and trials.is_limited(line.best)]
    return [trials.with_order(m, DisplacementOrder.FULL, names) for m in models if (names := trials.flexible(m))]
