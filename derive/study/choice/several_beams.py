"""The models of a scene with several beams: each gets one of its own, and combinations are run from cheap to dear."""

from __future__ import annotations

from collections.abc import Sequence

from derive.spec.model.body import DisplacementOrder
from derive.study.accuracy.ladder_model import LadderModel
from derive.study.choice.beam_shares import BeamShare, BeamShares
from derive.study.choice.combinations import combinations
from derive.study.choice.trials import Trials

COMBINED = 8
"""The largest number of combinations that are run without success."""
ROUNDS = (1.0, 1 / 3, 1 / 10)
"""The share that a beam may have, relative to its part of the error, in successive rounds of measurements of shares."""
BEYOND = 1
"""The number of combinations that are run beyond the first good one, to show the cost of more accuracy."""


def try_several_beams(trials: Trials, base: LadderModel, rigid: Sequence[BeamShare] = ()) -> tuple[BeamShare, ...]:
    """Run combinations until some are good, then with first order; returns the shares of the beams in the error.

    base: the model of the beams whose shares are not measured, and of a beam for which no other model is good.
    rigid: the shares of rigid beams.
    """
    shares = BeamShares(trials.runs, base, trials.cost, rigid, trials.report)
    combined = _Combined(trials, shares)
    targets = shares.targets(trials.budget)
    for part in ROUNDS:
        combined.refine({beam: part * target for beam, target in targets.items()})
        if combined.enough:
            break
    if not trials.good:
        combined.allow_base()
    if trials.good:
        _try_first_order(trials)
    return tuple(shares.known)


class _Combined:
    """The combinations that have been run."""

    def __init__(self, trials: Trials, shares: BeamShares) -> None:
        self._trials, self._shares = trials, shares
        self._failures = 0

    @property
    def enough(self) -> bool:
        """Whether a combination is good, or too many combinations have failed."""
        return bool(self._trials.good) or self._failures >= COMBINED

    def refine(self, targets: dict[str, float]) -> None:
        """Measure shares until each beam has a model within its target, and run the combinations of these models."""
        while not self.enough:
            for beam, target in targets.items():
                self._shares.refine(beam, target, self._trials.is_doubted)
            if not self._run_next({beam: self._sure(beam) for beam in self._shares.beams}):
                return
        for _ in range(BEYOND):
            self._run_next({beam: self._sure(beam) for beam in self._shares.beams})

    def allow_base(self) -> None:
        """Run combinations with the model of the base for some beams, or for all."""
        base = self._shares.base
        options = {beam: [*self._sure(beam), BeamShare(beam, base.of(beam), 0.0)] for beam in self._shares.beams}
        while not self.enough and self._run_next(options):
            options = {beam: [of for of in known if self._is_sure(of)] for beam, known in options.items()}
        if not self._trials.good:
            self._trials.run(base)

    def _run_next(self, options: dict[str, list[BeamShare]]) -> bool:
        """Run the cheapest combination that has not been run; False if there is none."""
        trials = self._trials
        for combination in combinations(trials.runs.scene, options, trials.budget, trials.cost):
            model = combination.model
            if model in trials:
                continue
            line = trials.run(model)
            self._failures += not trials.is_good(line)
            return True
        return False

    def _sure(self, beam: str) -> list[BeamShare]:
        return [share for share in self._shares.of(beam) if self._is_sure(share)]

    def _is_sure(self, share: BeamShare) -> bool:
        return not self._trials.is_doubted(share.beam, share.model)


def _try_first_order(trials: Trials) -> None:
    """Try the cheapest good model with beams of first order: all of them, or else one after the other."""
    best = trials.good[0].model
    second = trials.flexible(best)
    if not second:
        return
    if trials.is_good(trials.run(_first_order(trials, best, *second))) or len(second) == 1:
        return
    for name in second:
        simpler = _first_order(trials, best, name)
        if trials.is_good(trials.run(simpler)):
            best = simpler


def _first_order(trials: Trials, model: LadderModel, *names: str) -> LadderModel:
    return trials.with_order(model, DisplacementOrder.FIRST_ORDER, names)
