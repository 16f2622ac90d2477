"""The share of each beam in the error of a scene: one beam at a time is coarsened, and all others stay fine.

Rigid beams come first, see `rigid_shares`: their shares show which beams matter, and how much of the error is left for
those. Shares of independent errors add up as squares; the errors of combinations are measured, see `combinations`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from derive.errors import TisserandError, first_line
from derive.percentages import percent
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import LadderModel, Shapes, mixed
from derive.study.accuracy.modelled_bodies import flexible_members
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.accuracy.reference import rms_difference
from derive.study.choice.body_candidates import candidates, cannot_do, trials_if_all_fail
from derive.study.choice.model_runs import ModelRuns

TOLERANCE = 1e-6
"""The tolerance of the runs that are compared."""
SMALL = 3.0
"""A beam stays rigid if its share is below the requested error over this and over the root of the number of beams."""

Progress = Callable[[str], None]


@dataclass(frozen=True)
class BeamShare:
    """The change of the plots, rms over the peak, if one beam has this model; None where it cannot run, see failure."""

    beam: str
    model: LadderModel
    share: float | None
    failure: str = ""


class BeamShares:
    """The shares of the beams in the error, as they are measured; the others are those of the model `base`.

    rigid: the shares that are known already. report: takes a line on each measurement. Raises TisserandError where the
    base cannot be run.
    """

    def __init__(
        self,
        runs: ModelRuns,
        base: LadderModel,
        cost: PredictedCost,
        rigid: Sequence[BeamShare] = (),
        report: Progress = lambda _: None,
    ) -> None:
        self.base, self.known = base, list(rigid)
        self._runs, self._report = runs, report
        self._fine = runs.curves(base, TOLERANCE)
        beams = flexible_members(runs.scene)
        flexible = [beam for beam in beams if base.of(beam.name).shapes is not Shapes.RIGID]
        self._alone = len(flexible) == 1  # a model whose share is measured is a candidate as it is
        known = {of.beam for of in rigid}
        self._left = {
            beam.name: list(candidates(runs.scene, beam, cost, runs.models.modes))[beam.name in known :]
            for beam in beams
        }

    @property
    def beams(self) -> tuple[str, ...]:
        """The names of the beams."""
        return tuple(self._left)

    def of(self, beam: str) -> list[BeamShare]:
        """The shares of a beam that have been measured successfully."""
        return [share for share in self.known if share.beam == beam and share.share is not None]

    def targets(self, error: float) -> dict[str, float]:
        """The share in an error that each beam may have, from its share as a rigid body, measured if not known."""
        for beam in set(self.beams) - {of.beam for of in self.known}:
            self._try_next(beam)
        rigid = {share.beam: share.share for share in self.known if share.model.shapes is Shapes.RIGID}
        small = error / SMALL / np.sqrt(len(rigid))
        settled = [share for share in rigid.values() if share is not None and share <= small]
        left = np.sqrt(error**2 - np.square(settled).sum())
        each = float(left / np.sqrt(max(1, len(rigid) - len(settled))))
        return {beam: small if share in settled else each for beam, share in rigid.items()}

    def refine(
        self, beam: str, target: float, is_doubted: Callable[[str, LadderModel], bool] = lambda beam, model: False
    ) -> None:
        """Try models of a beam, but none that is doubted, until the share of one is within a target."""
        while not any(
            of.share is not None and of.share <= target and not is_doubted(beam, of.model) for of in self.of(beam)
        ):
            errors = {of.model: of.share for of in self.of(beam) if of.share is not None}
            left = (m for m in self._left[beam] if not is_doubted(beam, m))
            self._left[beam] = [m for m in left if not cannot_do(m, errors, target)]
            if not self._left[beam]:
                return
            first = next(trials_if_all_fail(self._left[beam], errors, target))
            self._left[beam] = [first, *(m for m in self._left[beam] if m != first)]
            self._try_next(beam)

    def _try_next(self, beam: str) -> None:
        """Measure the share of the next model of a beam."""
        option = self._left[beam].pop(0)
        if option.size >= self.base.of(beam).size:
            return
        self._runs.progress(f"share of {beam}: {option.label} ...")
        try:
            changed = self._changed(beam, option)
            self._runs.expect([changed, *self._next(beam)], self._alone)
            share = rms_difference(self._fine, self._runs.curves(changed, TOLERANCE, self._alone))
        except TisserandError as failure:
            self.known.append(BeamShare(beam, option, None, first_line(failure)))
            self._report(f"share of {beam}: {option.label}: {first_line(failure)}")
            return
        assert share is not None, "the reference does not vanish"
        self._report(f"share of {beam}: {option.label}: {percent(share)}")
        self.known.append(BeamShare(beam, option, share))

    def _changed(self, beam: str, option: LadderModel) -> LadderModel:
        return replaced(self._runs.scene, self.base, {beam: option})

    def _next(self, beam: str) -> list[LadderModel]:
        """Models that may follow in the measurements of a beam, as many as keep the processes at work."""
        smaller = [option for option in self._left[beam] if option.size < self.base.of(beam).size]
        return [self._changed(beam, option) for option in smaller[: self._runs.spare]]


def replaced(scene: AnyScene, base: LadderModel, models: dict[str, LadderModel]) -> LadderModel:
    """The model `base` of a scene with other models of some beams."""
    return mixed({beam.name: models.get(beam.name) or base.of(beam.name) for beam in flexible_members(scene)})
