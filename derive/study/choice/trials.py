"""The models that a search has tried: their errors against the reference, and whether these are small enough."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from derive.errors import TisserandError, first_line
from derive.simulation.validity.monitors import Cause, Monitor
from derive.spec.model.body import DisplacementOrder
from derive.study.accuracy.ladder_model import COMPONENT_MODES, LadderModel, Shapes
from derive.study.accuracy.measurement import Line, Point, measured, retimed
from derive.study.accuracy.modelled_bodies import flexible_members
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.choice.beam_shares import replaced
from derive.study.choice.body_candidates import HOPELESS
from derive.study.choice.model_runs import ModelRuns
from derive.study.choice.reference_errors import TrustedReference

TOLERANCES = (1e-3, 1e-5, 1e-7)
LIMITED = 2.0
"""Truncation may be the reason of an error of up to this times the change that truncation makes."""
HALF = 0.5
"""A finer reference is worth its models if this part of the error of the one before would make a cheaper model good."""
CLEARLY = 0.9
"""The most operations of such a model relative to those of the good one that is known."""
RUNS = 3
"""The number of measurements of the time of each run: the choice is by operations."""
OF_MOTION = (Cause.DEFLECTION, Cause.MASS_MATRIX)
"""Monitors of how far a piece of a beam bends, whatever its shapes are."""

Progress = Callable[[str], None]


def accurate(line: Line, point: Point, error: float, of_reference: float) -> bool:
    """Whether the error of a run with that of the reference is within `error`, and its monitors imply no larger one."""
    return not line.failure and point.rms + of_reference <= error and implied_error(line) <= error


def implied_error(line: Line) -> float:
    """The error that the monitors of a model imply; 0 if none warns."""
    return line.warning.error if line.warning else 0.0


def usable(model: LadderModel) -> bool:
    """Whether a model of the reference is usable otherwise: a full model, in which nothing is truncated, costs more."""
    return all(of.order is not DisplacementOrder.FULL for of in (model, *dict(model.beams).values()))


class Trials:
    """The models that have been tried for a requested error.

    budget: the error that a model may have beside that of the reference. report: takes a line on each model.
    """

    def __init__(
        self, runs: ModelRuns, known: TrustedReference, error: float, report: Progress = lambda _: None
    ) -> None:
        self.runs, self.known, self.error, self.report = runs, known, error, report
        self.budget = error - known.error
        self.cost = PredictedCost(runs.scene)
        self._lines: dict[LadderModel, Line] = {}

    @property
    def lines(self) -> tuple[Line, ...]:
        """The models in the order in which they were tried."""
        return tuple(self._lines.values())

    def __contains__(self, model: LadderModel) -> bool:
        return model in self._lines

    @property
    def good(self) -> list[Line]:
        """The models that are accurate enough, from cheap to dear."""
        return sorted(filter(self.is_good, self._lines.values()), key=self.operations)

    def is_good(self, line: Line) -> bool:
        """Whether a model is accurate enough."""
        return self._point(line) is not None

    @property
    def undecided(self) -> Line | None:
        """The cheapest model that would be good with half the error of the reference; None if there is none.

        It is clearly cheaper than those that are good.
        """
        most = CLEARLY * min(map(self.operations, self.good), default=math.inf)
        near = [
            (point.operations, n)
            for n, line in enumerate(self.lines)
            for point in line.points
            if point.operations < most and accurate(line, point, self.error, HALF * self.known.error)
        ]
        return self.lines[min(near)[1]] if near else None

    def run(self, model: LadderModel) -> Line:
        """The line of a model, which is derived and run if it has not been before."""
        if model not in self._lines:
            self._lines[model] = line = self._line(model)
            self.cost.add(line)
            self.report(f"model {len(self._lines)}: {model.label}: {line.outcome}")
        return self._lines[model]

    def run_until_good(self, models: Iterable[LadderModel]) -> None:
        """Run models from cheap to dear until one is good."""
        for model in sorted(models, key=self.cost.operations):
            if self.is_good(self.run(model)):
                return

    def is_limited(self, error: float) -> bool:
        """Whether truncation may be the reason why a model with this error is not accurate enough."""
        return self.budget < error <= LIMITED * self.known.truncation

    def timed(self) -> tuple[Line, ...]:
        """The lines with the times of repeated runs."""
        self.runs.wait()
        return tuple(retimed(self.lines, self.runs.ready, RUNS, lambda _: None))

    def operations(self, line: Line) -> int:
        """The operations of the cheapest run of a good model."""
        point = self._point(line)
        assert point is not None
        return point.operations

    def flexible(self, model: LadderModel) -> list[str]:
        """The names of the beams that a model does not take as rigid."""
        beams = flexible_members(self.runs.scene)
        return [beam.name for beam in beams if model.of(beam.name).shapes is not Shapes.RIGID]

    def with_order(self, model: LadderModel, order: DisplacementOrder, names: Sequence[str]) -> LadderModel:
        """The model with another order of displacements of some bodies; finite-element bodies have no full one."""
        changed = {name: model.of(name) for name in names}
        if order is DisplacementOrder.FULL:
            changed = {name: of for name, of in changed.items() if of.shapes not in COMPONENT_MODES}
        return replaced(self.runs.scene, model, {name: replace(of, order=order) for name, of in changed.items()})

    def is_doubted(self, beam: str, model: LadderModel) -> bool:
        """Whether a monitor of a run implies too large an error of a beam that has this model there, or misses alike.

        Shapes of torsion do not change what those of bending miss, and those of bending hardly what torsion misses. No
        shapes change how far a piece bends.
        """
        doubts = ((line.model.of(beam), line.warning) for line in self.lines if implied_error(line) > self.error)
        return any(
            model == of or self._misses_alike(model, of, warning)
            for of, warning in doubts
            if warning is not None and warning.beam == beam
        )

    def _misses_alike(self, model: LadderModel, of: LadderModel, warning: Monitor) -> bool:
        """Whether a model of a beam has the shapes that make a monitor warn of another one."""
        far = warning.error > HOPELESS * self.error
        if warning.cause is Cause.TWISTING_MOMENT:
            return far and (model.pieces, model.torsion) == (of.pieces, of.torsion)
        if warning.cause in OF_MOTION and far and model.size:
            return (model.pieces, model.order) == (of.pieces, of.order)
        return model == replace(of, torsion=model.torsion)

    def _line(self, model: LadderModel) -> Line:
        self.runs.progress(f"model {len(self._lines) + 1}: {model.label} ...")
        try:
            of = self.runs.compiled(model)
        except TisserandError as error:
            return Line(model, 0, (), failure=first_line(error))
        return measured(of, self.known.plots, TOLERANCES, self.runs.wait)

    def _point(self, line: Line) -> Point | None:
        """The cheapest run of a model that is accurate enough."""
        good = (p for p in line.points if accurate(line, p, self.error, self.known.error))
        return min(good, key=lambda p: p.operations, default=None)
