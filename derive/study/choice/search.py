"""The search for the cheapest model of a scene that is accurate enough.

First a reference is made that can be trusted: a model of second order is refined until it agrees with others in each
direction, with fewer beams, with fewer shapes, with nothing truncated, and with larger steps, to a third of the error
that is asked for. Agreement within one family would prove nothing. Then models
are tried from few coordinates to many, until three are accurate and none of their monitors implies a larger error; the
cheapest is chosen.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from derive.errors import TisserandError, first_line
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.plots import Plot
from derive.spec.model.scene import Scene
from derive.study.accuracy.measurement import (
    CompiledLadderModel,
    Line,
    Point,
    compiled,
    measure,
    motion,
)
from derive.study.accuracy.models import LadderModel, LadderRange, Shapes, ladder
from derive.study.accuracy.reference import Curves, bare_plots, curves_of, rms_difference, with_curve

FINE, COARSE = 1e-10, 1e-8
"""Tolerances of the reference, and of the run that shows the error of its steps."""
SHARE = 1 / 3
"""The error of a reference over the error that is asked for, at most."""
BEYOND = 2
"""Models that are accurate enough and tried beyond the first one: what more accuracy would cost."""
TRIED = LadderRange(("first", "truncated"), ("mean",), (1, 2, 3, 4), (2, 3), (1, 2))
TOLERANCES = (1e-3, 1e-5, 1e-7)
RUNS = 5

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Agreement:
    """How far the reference differs from a coarser model, rms over the peak: in the direction that `label` names."""

    label: str
    difference: float


@dataclass(frozen=True)
class TrustedReference:
    """Plots with the curves of the finest model, and how far coarser models differ from it; `model` is that model."""

    plots: tuple[Plot, ...]
    model: LadderModel
    agreements: tuple[Agreement, ...]

    @property
    def error(self) -> float:
        """The largest of the differences."""
        return max(a.difference for a in self.agreements)


@dataclass(frozen=True)
class Choice:
    """The result of a search for an error: its reference, and the models in the order in which they were tried."""

    error: float
    reference: TrustedReference
    tried: tuple[Line, ...]

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
    implied = line.warning.error if line.warning else 0.0
    return not line.failure and point.rms + of_reference <= error and implied <= error


def choose(scene: Scene, plots: Sequence[Plot], error: float, progress: Progress) -> Choice:
    """The cheapest model whose plots have at most an error, rms over the peak; see the text of this module.

    Raises NotConverged, SpecError, SimulationError, CompilerError.
    """
    scene = replace(scene, plots=tuple(plots))
    known = trusted_reference(scene, plots, error, progress)
    tried: list[Line] = []
    left = BEYOND
    for n, model in enumerate(models := ladder(TRIED), 1):
        progress(f"model {n} of at most {len(models)}: {model.label}")
        tried.append(_line(scene, model, known.plots))
        left -= any(accurate(tried[-1], p, error, known.error) for p in tried[-1].points)
        if left < 0:
            break
    return Choice(error, known, tuple(tried))


def _line(scene: Scene, model: LadderModel, plots: Sequence[Plot]) -> Line:
    try:
        of = compiled(scene, model)
    except TisserandError as error:
        return Line(model, 0, (), failure=first_line(error))
    return measure([of], plots, TOLERANCES, RUNS, lambda _: None)[0]


class NotConverged(TisserandError):
    """No reference agrees with coarser models closely enough for the error that is asked for."""


def trusted_reference(scene: Scene, plots: Sequence[Plot], error: float, progress: Progress) -> TrustedReference:
    """A reference whose own error is at most a third of `error`. Raises NotConverged."""
    bare = tuple(one for plot in plots for one in bare_plots(plot))
    curves: dict[tuple[LadderModel, float], Curves] = {}
    runnable: dict[LadderModel, CompiledLadderModel] = {}

    def curve(model: LadderModel, tolerance: float = FINE) -> Curves:
        if model not in runnable:
            progress(f"reference: {model.label}")
            runnable[model] = compiled(replace(scene, plots=bare), model, monitored=False)
        if (model, tolerance) not in curves:
            curves[model, tolerance] = curves_of(bare, motion(runnable[model], tolerance))
        return curves[model, tolerance]

    best: TrustedReference | None = None
    for model in _refinements():
        finest = curve(model)
        agreements = []
        for check in _checks(model):
            try:
                difference = rms_difference(curve(check.finer), curve(check.coarser, check.tolerance))
            except TisserandError as failure:
                raise NotConverged(f"the reference cannot be made: {first_line(failure)}") from failure
            if difference is None:
                raise NotConverged(
                    f"{_names(plots)}: a curve vanishes all the time, so that there is no error of it to be small"
                )
            agreements.append(Agreement(f"{check.label}: {check.coarser.label}", difference))
        made = tuple(with_curve(plot, model.label, of) for plot, of in zip(bare, finest, strict=True))
        finer = TrustedReference(made, model, tuple(agreements))
        best = finer if best is None or finer.error < best.error else best
        if best.error <= SHARE * error:
            return best
    assert best is not None
    worst = max(best.agreements, key=lambda a: a.difference)
    what = f"the finest, {best.model.label}, differs by {100 * best.error:.2g} % from that with {worst.label}"
    raise NotConverged(
        f"no reference has converged: {what}, and an error of {100 * error:.2g} % needs a third of it; ask for a "
        "larger error, or a shorter time"
    )


def _names(plots: Sequence[Plot]) -> str:
    return ", ".join(plot.name for plot in plots)


def _refinements() -> tuple[LadderModel, ...]:
    order = DisplacementOrder.TRUNCATED
    sizes = ((2, 3), (2, 4), (3, 4), (4, 4))  # beams and shapes
    return tuple(LadderModel(Shapes.POLYNOMIALS, count, order, "mean", pieces) for pieces, count in sizes)


@dataclass(frozen=True)
class _Check:
    """What a reference has to agree with in one direction: two models, of which the coarser has a tolerance."""

    label: str
    finer: LadderModel
    coarser: LadderModel
    tolerance: float = FINE


def _checks(model: LadderModel) -> tuple[_Check, ...]:
    """Fewer beams, fewer shapes, larger steps; what truncation leaves out is largest where there are fewer beams."""
    fewer = replace(model, pieces=model.pieces - 1)
    return (
        _Check("fewer beams", model, fewer),
        _Check("fewer shapes", model, replace(model, count=model.count - 1)),
        _Check("nothing truncated", fewer, replace(fewer, order=DisplacementOrder.FULL)),
        _Check("larger steps", model, model, COARSE),
    )
