"""The reference of a search: a model of second order, refined until it agrees with others in each direction.

The directions are fewer beams, fewer shapes, other modes, nothing truncated, and larger steps: agreement within one
family would prove nothing. The direction of refinement depends on the differences alone, and not on the requested
error, so that a search for a larger error goes through the same models and ends with one of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from derive.durations import duration_text
from derive.errors import TisserandError, first_line
from derive.percentages import percent
from derive.study.accuracy.ladder_model import LadderModel, Shapes, mixed
from derive.study.accuracy.measurement import Curves
from derive.study.accuracy.modelled_bodies import flexible_members
from derive.study.accuracy.piece_errors import error_over_difference, error_ratio
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.accuracy.reference import reference_plots, rms_difference
from derive.study.choice.beam_shares import BeamShare
from derive.study.choice.full_scene import without_rotary_inertia
from derive.study.choice.model_runs import ModelRuns
from derive.study.choice.reference_errors import ROOM, SHARE, Agreement, TrustedReference
from derive.study.choice.reference_models import MOST_BEAMS, CoarserModels
from derive.study.choice.rigid_shares import MATTERS

FINE, COARSE = 1e-10, 1e-8
"""Tolerances of the reference, and of the run that shows the error of its steps."""
CHEAPER = 1.5
"""The difference with fewer beams over that with fewer shapes above which beams are added: shapes are cheaper."""
SETTLED = 0.25
"""The difference with fewer shapes over that with fewer beams up to which more beams have the fewer shapes, and are not
compared with even fewer: the error of these shapes is known, and is smaller in more beams."""
LONGEST = 120.0
"""The longest time (s) that may be predicted for a run of a finer reference."""

Progress = Callable[[str], None]


def expect_first(runs: ModelRuns) -> None:
    """Prepare the models ahead with which each search begins."""
    runs.expect([runs.models.flexible], monitored=True)
    if runs.lone:
        runs.expect(runs.models.needed(runs.models.first))
        runs.expect([LadderModel(Shapes.RIGID)], monitored=True)


class NotConverged(TisserandError):
    """No reference agrees with coarser models closely enough for the requested error."""


def trusted_references(
    runs: ModelRuns, error: float, report: Progress, rigid: Sequence[BeamShare] = ()
) -> Iterator[TrustedReference]:
    """Yield references that differ from coarser models by at most a third of `error`, and have two thirds of it.

    The first one is the coarsest, and those after it are finer: a search takes them where the error of the first one
    leaves open whether a model is accurate enough.

    Raises NotConverged if there is none.

    report: takes a line on each comparison. rigid: the shares of beams that hardly matter, and are rigid.
    """
    references = _References(runs, report, rigid)
    model: LadderModel | None = runs.models.first
    further, found = "", False
    while model is not None:
        if references.made and (seconds := references.predicted_seconds(model)) > LONGEST:
            further = f"; {model.label} would need {duration_text(seconds)} for a run"
            break
        try:
            known = references.add(model)
            if known.suffices(error):
                known = references.confirmed(known)
        except TisserandError as failure:
            if not found and (not references.made or isinstance(failure, NotConverged)):
                raise NotConverged(f"the reference cannot be made: {failure}") from failure
            further = f"; {model.label} cannot be run: {first_line(failure)}"
            break
        if known.suffices(error):
            found = True
            yield known
        model = references.finer(model)
    else:
        further = "; finer ones are not tried"
    if not found:
        raise NotConverged(_without_reference(references, error, further))


def _without_reference(references: _References, error: float, further: str) -> str:
    """The text on why no reference is good enough, with the least error for which one of those made is."""
    best = references.best
    worst = max(best.agreements, key=lambda a: a.difference)
    possible = rounded_up(max(best.difference / references.share, best.error / references.room))
    larger = f"an error of {percent(possible)} or more, or " if possible < 1 else ""
    return (
        f"an error of {percent(error)} needs a reference that differs by at most a third of it from coarser models. No "
        f"reference was accurate enough: {best.model.label} differs by {percent(worst.difference)} from the model with "
        f"{worst.label}{further}. Ask for {larger}a shorter time"
    )


def rounded_up(ratio: float) -> float:
    """The least ratio of two digits (in percent, without decimals from 10 % on) that is larger."""
    digit = 10.0 ** min(math.floor(math.log10(ratio)) - 1, -2)
    return math.ceil(ratio / digit * (1 + 1e-9)) * digit


class _References:
    """The references that have been made of a scene, from coarse to fine."""

    def __init__(self, runs: ModelRuns, report: Progress, rigid: Sequence[BeamShare]) -> None:
        self._runs, self._report = runs, report
        self._rigid = {of.beam: of.model for of in rigid}
        together = float(np.sqrt(sum((of.share or 0.0) ** 2 for of in rigid)))
        self._flexible = [Agreement(f"{', '.join(self._rigid)} flexible", together)] if rigid else []
        comparable = without_rotary_inertia(runs.scene)
        self._full_runs = runs if comparable == runs.scene else ModelRuns(comparable, comparable.plots, runs.progress)
        self._truncation: dict[int, Agreement] = {}
        self._cost = PredictedCost(runs.scene)
        self._complete: dict[LadderModel, TrustedReference] = {}
        self._settled, self._pieces = dict[str, Agreement](), 0
        self._lean: LadderModel | None = None
        self._unmixed: dict[LadderModel, LadderModel] = {}
        self.made: list[TrustedReference] = []

    def add(self, model: LadderModel) -> TrustedReference:
        """Add a model as the reference, without the comparisons of `confirmed`, which give no direction to refine."""
        models = self._runs.models
        fall = error_ratio(self._pieces, pieces := models.pieces(model))
        settled = {label: replace(a, factor=fall * a.factor) for label, a in self._settled.items() if fall < 1}
        self._runs.expect(map(self._mixture, models.needed(model, settled)))
        compared = [(way, other) for way in models.directions if (other := way.coarser(model)) is not None]
        agreements = [settled.get(way.label) or self._agreement(model, way, other) for way, other in compared]
        by_beams = [a.decisive for (way, _), a in zip(compared, agreements, strict=True) if way.beams]
        by_shapes = [a.decisive for (way, _), a in zip(compared, agreements, strict=True) if not way.beams]
        self._pieces, self._settled, self._lean = pieces, settled, None
        in_more = error_ratio(pieces, pieces + 1) * max(by_shapes, default=0.0)
        if (lean := models.lean(model)) and not settled and in_more <= SETTLED * max(by_beams, default=0.0):
            self._lean = lean
            for (way, other), a in zip(compared, agreements, strict=True):
                label = f"{way.label} of {model.label}: {other.label}"
                self._settled |= {} if way.beams else {way.label: replace(a, label=label)}
        if full := self._full(model, max(a.decisive for a in agreements)):
            agreements.append(full)
            by_beams.append(full.difference)
        of_beams, of_shapes = (max(of, default=0.0) for of in (by_beams, by_shapes))
        self._beams_first = of_beams > CHEAPER * of_shapes
        self._exhausted = pieces >= MOST_BEAMS and of_shapes <= SETTLED * of_beams
        curves, mixture = self._curves(self._runs, model, FINE), self._mixture(model)
        report = (lambda _: None) if self.made else self._report  # each reference leaves out the same
        plots = reference_plots(self._runs.bare, mixture.label, curves, report)
        truncation = self._truncation[1].difference if full else 0.0
        self._unmixed[mixture], errors = model, tuple(self._errors(curves))
        made = TrustedReference(plots, mixture, (*agreements, *self._flexible), errors, truncation)
        self.made.append(made)
        return made

    def confirmed(self, known: TrustedReference) -> TrustedReference:
        """A reference that is compared with other modes and with larger steps as well."""
        model = known.model
        if model not in self._complete:
            ways, unmixed = self._runs.models.confirming, self._unmixed[model]
            more = [self._agreement(unmixed, way, other) for way in ways if (other := way.coarser(unmixed)) is not None]
            curves = self._runs.curves(model, FINE), self._runs.curves(model, COARSE)
            steps = self._compared(f"larger steps: {model.label}", model, *curves)
            self._complete[model] = replace(known, agreements=(*known.agreements, *more, steps))
        return self._complete[model]

    @property
    def share(self) -> float:
        """The difference of a reference over a larger error that may be requested: more beams may be rigid then.

        Each difference of two models changes by twice their share at most.
        """
        return SHARE if self._runs.lone else SHARE - 2 / MATTERS

    @property
    def room(self) -> float:
        """The error of a reference over a larger error that may be requested, with a reserve for rigid beams."""
        return ROOM if self._runs.lone else ROOM / 2

    @property
    def best(self) -> TrustedReference:
        """The reference with the least difference, of those that can be compared with larger steps."""
        for known in self.made:
            with suppress(TisserandError):
                self.confirmed(known)
        return min(self._complete.values() or self.made, key=lambda known: known.difference)

    def finer(self, model: LadderModel) -> LadderModel | None:
        """The model after the last one, refined in the direction that differs most; None where there is none.

        Where fewer shapes have made hardly any difference, more beams have these, and no beams of the largest number
        have more.
        """
        if self._exhausted:
            return None
        return self._runs.models.finer(self._lean or model, self._beams_first)

    def predicted_seconds(self, model: LadderModel) -> float:
        """The approximate time (s) of a run of a model, from that of the finest reference so far."""
        known, cost = self.made[-1].model, self._cost
        return self._runs.seconds(known) * cost.operations(self._mixture(model)) / cost.operations(known)

    def _full(self, model: LadderModel, enough: float) -> Agreement | None:
        """The error of truncation: it is largest with few beams, which are tried first; None where none is known.

        More beams, which take long to derive, are tried where the difference is larger than in other directions.
        """
        agreement = None
        for pieces in range(1, self._runs.models.pieces(model)):
            pair = self._runs.models.truncated(model, pieces)
            if pair is None:
                break
            if pieces not in self._truncation:
                few, full = pair
                curves = (self._curves(self._full_runs, of, FINE) for of in (few, full))
                label = f"nothing truncated: {full.label}"
                if self._full_runs is not self._runs:
                    label += ", without the rotary inertia of attached masses"
                self._truncation[pieces] = self._compared(label, model, *curves)
            agreement = self._truncation[pieces]
            if agreement.difference <= enough:
                break
        return agreement

    def _mixture(self, model: LadderModel) -> LadderModel:
        """A model in which the beams that hardly matter are rigid."""
        bodies = flexible_members(self._runs.scene)
        return mixed({body.name: self._rigid.get(body.name, model.of(body.name)) for body in bodies})

    def _curves(self, runs: ModelRuns, model: LadderModel, tolerance: float) -> Curves:
        return runs.curves(self._mixture(model), tolerance)

    def _agreement(self, model: LadderModel, way: CoarserModels, other: LadderModel) -> Agreement:
        curves = (self._curves(self._runs, of, FINE) for of in (model, other))
        result = self._compared(f"{way.label}: {other.label}", model, *curves)
        of_pieces = error_over_difference(*map(self._runs.models.pieces, (model, other)))
        return replace(result, factor=of_pieces) if way.beams else result

    def _compared(self, label: str, model: LadderModel, finer: Curves, coarser: Curves) -> Agreement:
        result = Agreement(label, self._difference(finer, coarser))
        self._report(f"reference: {model.label}: {percent(result.difference)} from {label}")
        return result

    def _errors(self, finest: Curves) -> list[tuple[LadderModel, float]]:
        known = self._runs.run_with(FINE)
        return [(model, self._difference(finest, curves)) for model, curves in known.items()]

    def _difference(self, finer: Curves, coarser: Curves) -> float:
        difference = rms_difference(finer, coarser)
        if difference is None:
            names = ", ".join(dict.fromkeys(plot.name for plot in self._runs.bare))
            text = f"{names}: a curve vanishes all the time, so that no error of it is known; choose another by --plot"
            raise NotConverged(text)
        return difference
