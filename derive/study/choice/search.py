"""The search for the cheapest model of a scene that is accurate enough.

First a reference is made that can be trusted. A scene with one beam is then tried with models from few coordinates to
many. Of several beams each gets a model of its own: its share in the error is measured, see `beam_shares`, and
combinations are run from cheap to dear. Whatever is chosen has been run and compared with the reference, and none of
its monitors implies a larger error. If nothing else is accurate enough, the models that made the reference are, unless
a monitor doubts them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from derive.errors import TisserandError, first_line
from derive.simulation.observables.beams import beam_bodies
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.plots import Plot
from derive.spec.model.scene import Scene
from derive.study.accuracy.measurement import CompiledLadderModel, Line, Point, compiled, measured, retimed
from derive.study.accuracy.models import FAMILIES, LadderModel, LadderRange, Shapes, ladder
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.choice.beam_shares import BeamShare, beam_shares, combinations, replaced
from derive.study.choice.trusted_reference import SHARE, TrustedReference, trusted_reference

BEYOND = 2
"""Models that are accurate enough and tried beyond the first one: what more accuracy would cost."""
TRIED = LadderRange(("first", "truncated"), ("mean",), (1, 2, 3, 4), (2, 3), (1, 2, 3), ("clamped-free",))
"""The models of a lone beam."""
COMBINED = 8
"""Combinations of models of several beams that are run without success, at most."""
TOLERANCES = (1e-3, 1e-5, 1e-7)
RUNS = 5

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Choice:
    """The result of a search for an error: its reference, and the models in the order in which they were tried.

    shares: those of the beams in the error of a scene with several, measured against the model `base`.
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


def accurate(line: Line, point: Point, error: float, of_reference: float) -> bool:
    """Whether a run is within an error, that of the reference included, and its monitors imply no larger one."""
    return not line.failure and point.rms + of_reference <= error and implied_error(line) <= error


def implied_error(line: Line) -> float:
    """The error that the monitors of a model imply; 0 if none warns."""
    return line.warning.error if line.warning else 0.0


def quiet(_: str) -> None:
    """Report nothing."""


def choose(
    scene: Scene, plots: Sequence[Plot], error: float, progress: Progress = quiet, report: Progress = quiet
) -> Choice:
    """The cheapest model whose plots have at most an error, rms over the peak; see the text of this module.

    progress: takes what is being done; report: takes what came of it, a line for each model.

    Raises NotConverged, SpecError, SimulationError, CompilerError.
    """
    scene = replace(scene, plots=tuple(plots))
    known = trusted_reference(scene, plots, error, progress, report)
    search = _Search(scene, known, error, progress, report)
    base, shares = None, tuple[BeamShare, ...]()
    if len(beam_bodies(scene)) == 1:
        search.try_models(ladder(TRIED))
        if not search.good:
            search.try_models(_more_of_one_beam(), 1)
    else:
        base = _base(known, search.cost, error)
        search.run(LadderModel(Shapes.RIGID))  # what the slow motion costs, and the answer if it is accurate enough
        shares = beam_shares(scene, base, plots, error, progress, report)
        search.try_combinations(base, shares)
        if search.good:
            search.try_first_order()
        else:
            search.try_models([base], 1)
    if not search.good:
        search.try_models([model for model, of in known.errors if _usable(model) and of + known.error <= error], 1)
    return Choice(error, known, search.timed(), base, shares)


def _more_of_one_beam() -> tuple[LadderModel, ...]:
    """The models of a lone beam beyond those that are tried first: more shapes, of other kinds, in more pieces."""
    order = DisplacementOrder.TRUNCATED
    chord = FAMILIES[Shapes.SINES][1].kind
    models = [LadderModel(Shapes.SINES, count, order, chord) for count in (4, 5)]
    models += [LadderModel(Shapes.CLAMPED_FREE, 4, order, "tangent")]
    models += [LadderModel(Shapes.POLYNOMIALS, 3, order, "mean", 2), LadderModel(Shapes.POLYNOMIALS, 5, order)]
    return tuple(sorted(models, key=lambda m: m.size))


def _usable(model: LadderModel) -> bool:
    """Whether a model of the reference is one to work with: a model in which nothing is truncated costs far more."""
    return model.order is not DisplacementOrder.FULL


def _base(known: TrustedReference, cost: PredictedCost, error: float) -> LadderModel:
    """The cheapest model of the reference whose own error is small against the one that is asked for."""
    usable = [(model, of) for model, of in known.errors if _usable(model)]
    good = [model for model, of in usable if of <= SHARE * error]
    return min(good, key=cost.operations, default=known.model)


class _Search:
    """The models of a scene that have been tried, and whether they are accurate enough."""

    def __init__(
        self, scene: Scene, known: TrustedReference, error: float, progress: Progress, report: Progress
    ) -> None:
        self._scene, self._known, self._error = scene, known, error
        self._progress, self._report = progress, report
        self._lines: dict[LadderModel, Line] = {}
        self._compiled: dict[LadderModel, CompiledLadderModel] = {}
        self.cost = PredictedCost(scene)

    @property
    def good(self) -> list[Line]:
        """The models that are accurate enough."""
        return [line for line in self._lines.values() if self._point(line) is not None]

    def run(self, model: LadderModel) -> Line:
        """The line of a model, which is derived and run unless it has been."""
        if model not in self._lines:
            self._lines[model] = line = self._line(model)
            self.cost.add(line)
            self._report(f"model {len(self._lines)}: {model.label}: {line.outcome}")
        return self._lines[model]

    def try_models(self, models: Iterable[LadderModel], most: int = BEYOND + 1) -> None:
        """Run models until so many are accurate enough."""
        for model in models:
            if len(self.good) >= most:
                return
            self.run(model)

    def try_combinations(self, base: LadderModel, shares: Sequence[BeamShare]) -> None:
        """Run combinations of models of beams from cheap to dear, without those of which a monitor warned."""
        budget = self._error - self._known.error
        doubtful: set[tuple[str, LadderModel]] = set()
        failures = 0
        for combination in combinations(self._scene, base, shares, budget, self.cost):
            model = combination.model
            if any(model.of(name) == option for name, option in doubtful):
                continue
            line = self.run(model)
            if self._point(line) is None:
                failures += 1
            if line.warning is not None and implied_error(line) > self._error:
                doubtful.add((line.warning.beam, model.of(line.warning.beam)))
            if len(self.good) > BEYOND or failures >= COMBINED:
                return

    def try_first_order(self) -> None:
        """Make the beams of the cheapest good model first-order ones: all of them, and else one after the other."""
        best = min(self.good, key=self._operations).model
        second = [beam.name for beam in beam_bodies(self._scene) if best.of(beam.name).shapes is not Shapes.RIGID]
        if self._point(self.run(self._first_order(best, second))) is not None or len(second) == 1:
            return
        for name in second:
            simpler = self._first_order(best, [name])
            if self._point(self.run(simpler)) is not None:
                best = simpler

    def timed(self) -> tuple[Line, ...]:
        """The lines with the times of repeated runs."""
        return tuple(retimed(tuple(self._lines.values()), self._compiled, RUNS, lambda _: None))

    def _first_order(self, model: LadderModel, names: Sequence[str]) -> LadderModel:
        first = {name: replace(model.of(name), order=DisplacementOrder.FIRST_ORDER) for name in names}
        return replaced(self._scene, model, first)

    def _line(self, model: LadderModel) -> Line:
        self._progress(f"model {len(self._lines) + 1}: {model.label} ...")
        try:
            self._compiled[model] = of = compiled(self._scene, model)
        except TisserandError as error:
            return Line(model, 0, (), failure=first_line(error))
        return measured(of, self._known.plots, TOLERANCES)

    def _point(self, line: Line) -> Point | None:
        """The cheapest run of a model that is accurate enough."""
        good = (p for p in line.points if accurate(line, p, self._error, self._known.error))
        return min(good, key=lambda p: p.operations, default=None)

    def _operations(self, line: Line) -> int:
        point = self._point(line)
        assert point is not None
        return point.operations
