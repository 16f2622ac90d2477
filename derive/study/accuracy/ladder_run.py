"""The runs of a ladder, from few coordinates to many; models that cannot matter any more are left out with a reason."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import islice

from derive.durations import duration_text
from derive.errors import TisserandError, first_line
from derive.percentages import percent
from derive.remaining_time import remaining_seconds
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import LadderModel
from derive.study.accuracy.measurement import (
    CompiledLadderModel,
    Line,
    ModelVariant,
    Preparation,
    Progress,
    measured,
    opened,
    preparation,
)
from derive.study.accuracy.models import start_remainders
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.accuracy.reference import Reference, rms_difference
from derive.study.spin_notes import spin_notes

DEARER = 2.0
"""A model is left out if its predicted operations exceed those of an equally accurate model by this factor."""
STAGNANT = 0.05
"""Errors of models of a kind, of which the finer is two sizes larger, that differ by less, relatively, stagnate."""
BETTER = 0.5
"""Stagnant models are left out if a cheaper model has an error below this part of theirs."""
PAIRS = 2
"""The number of models of both orders whose plots have to agree before second order is left out."""
PER_COORDINATE, PER_OPERATION = 0.2, 3e-10
"""First estimates: seconds to derive and compile a model, per coordinate of its bodies, and seconds of an operation."""

PRIOR = 0.3
"""The part of the predicted time of a ladder that counts as if it had been measured: the first models are small, and
wait until the processes have begun."""


class LadderRun:
    """The lines of a ladder, added one by one, so that an interruption leaves the lines of the models so far.

    explicit: whether models are run by the adaptive method alone. ahead: prepares the models of the scene.
    lines: of the models that have run, or have failed. notes: a line on each model that was left out, and on starts
    that a model has only approximately. ready: the models that are compiled.
    """

    def __init__(
        self,
        scene: AnyScene,
        known: Reference,
        tolerances: Sequence[float],
        explicit: bool = True,
        ahead: Preparation | None = None,
    ) -> None:
        self._scene, self._known, self._tolerances, self._explicit = scene, known, tolerances, explicit
        self._ahead = preparation(scene) if ahead is None else ahead
        self.cost = PredictedCost(scene)
        self.lines: list[Line] = []
        self._left_out: dict[str, list[LadderModel]] = {}
        self._starts: list[str] = []
        self.ready: dict[LadderModel, CompiledLadderModel] = {}

    @property
    def notes(self) -> list[str]:
        """Lines on models that were left out, on starts that they have only approximately, and on fast spin."""
        left_out = (
            f"left out: {'; '.join(model.label for model in models)}: {reason}"
            for reason, models in self._left_out.items()
        )
        return [*left_out, *self._starts, *spin_notes((line.label, line.spins) for line in self.lines)]

    @property
    def count(self) -> int:
        """The number of models that have been run or left out."""
        return len(self.lines) + sum(map(len, self._left_out.values()))

    def run(
        self, models: Sequence[LadderModel], progress: Progress, report: Progress, record: Callable[[], None]
    ) -> None:
        """Run models. progress: takes a line on each task; report: a line on each result, with the remaining time;
        record: is called after each model."""
        began, done, left = time.monotonic(), 0.0, ""
        total = sum(map(self.seconds, models))
        report(f"{len(models)} models, about {duration_text(total)}")
        for n, model in enumerate(models, 1):
            name = f"model {n} of {len(models)}: {model.label}"
            if reason := self.dispensable(model):
                self._left_out.setdefault(reason, []).append(model)
                report(f"{name}: left out: {reason}")
                continue
            progress(f"{name}{left} ...")
            self._expect(models[n - 1 :])
            predicted = self.seconds(model)
            line = self._line(model)
            self.lines.append(line)
            self.cost.add(line)
            done += predicted
            rest = [other for other in models[n:] if not self.dispensable(other)]
            passed = time.monotonic() - began
            remaining = remaining_seconds(sum(map(self.seconds, rest)), done, passed, PRIOR * total)
            left = f"; about {duration_text(remaining)} left" if rest else ""
            report(f"{name}: {line.outcome}{left}")
            record()

    def seconds(self, model: LadderModel) -> float:
        """The approximate time (s) to derive and compile a model, and to run it twice with each tolerance."""
        operations = 2 * len(self._tolerances) * self.cost.operations(model)
        preparation = PER_COORDINATE * self.cost.coordinates(model) / max(1, self._ahead.workers)
        return preparation + PER_OPERATION * operations

    def dispensable(self, model: LadderModel) -> str:
        """The reason why a model cannot matter, as a cheaper one is as good; empty if it may matter."""
        return self._beyond_reference(model) or self._stagnant(model) or self._idle_order(model)

    def _beyond_reference(self, model: LadderModel) -> str:
        """The reason why a model cannot matter, as a cheaper one has a smaller error than the reference."""
        predicted = self.cost.operations(model)
        for line in self.lines:
            if not line.valid or self._known.error is None or line.best > self._known.error:
                continue
            if predicted > DEARER * min(p.operations for p in line.points if p.rms <= self._known.error):
                return f"dearer than {line.label}, whose error of {percent(line.best)} is within that of the reference"
        return ""

    def _stagnant(self, model: LadderModel) -> str:
        """The reason why a model cannot matter, as more shapes of its kind do not help, and a cheaper one is better."""
        fewer = [line for line in self.lines if line.points and line.model.kind == model.kind]
        fewer = sorted((line for line in fewer if line.model.count < model.count), key=lambda line: line.model.count)
        if len(fewer) < 3 or abs(fewer[-1].best - fewer[-3].best) > STAGNANT * fewer[-1].best:
            return ""  # one shape more may be odd where an even one is missing: two have to change nothing
        cheapest = min(p.operations for p in fewer[-1].points)
        for line in self.lines:
            if line.valid and line.best < BETTER * fewer[-1].best and line.points[-1].operations < cheapest:
                return (
                    f"dearer than {line.label} with {percent(line.best)}, and more shapes of its kind stay at "
                    f"{percent(fewer[-1].best)}"
                )
        return ""

    def _idle_order(self, model: LadderModel) -> str:
        """The reason why a model of second order cannot matter: with few shapes it changes less than is known.

        The changes of the plot are compared with the error of the reference, below which nothing is claimed.
        """
        ran = {line.model: line for line in self.lines if line.curves}
        if self._known.error is None or _of_first_order(model) == model or _of_first_order(model) not in ran:
            return ""
        pairs = ((line, ran.get(_of_first_order(of))) for of, line in ran.items() if _of_first_order(of) != of)
        changes = {line.label: rms_difference(line.curves, first.curves) or 0.0 for line, first in pairs if first}
        if len(changes) < PAIRS or max(changes.values()) > self._known.error:
            return ""
        alike = f"second order changed the plot by at most {percent(max(changes.values()))} in {'; '.join(changes)}"
        return f"{alike}: by less than the error of the reference"

    def _line(self, model: LadderModel) -> Line:
        try:
            of = opened(self._ahead.result(self._variant(model)))
            self._starts += (f"{model.label}: {text}" for text in start_remainders(self._scene, model))
        except TisserandError as error:
            return Line(model, 0, (), failure=first_line(error))
        self.ready[model] = of
        return measured(of, self._known.plots, self._tolerances, self._ahead.wait)

    def _variant(self, model: LadderModel) -> ModelVariant:
        return ModelVariant(model, explicit=self._explicit)

    def _expect(self, models: Sequence[LadderModel]) -> None:
        """Prepare the first of these models ahead: as many as keep the processes at work, as others may be left out."""
        likely = (model for model in models if not self.dispensable(model))
        self._ahead.expect(map(self._variant, islice(likely, 1 + 2 * self._ahead.workers)))


def _of_first_order(model: LadderModel) -> LadderModel:
    """A model with displacements of first order."""
    return replace(model, order=DisplacementOrder.FIRST_ORDER)
