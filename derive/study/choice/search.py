"""The search for the cheapest model of a scene that is accurate enough.

First a reference is made that can be trusted, and a finer one where its error leaves open whether a cheaper model is
accurate enough. A scene with one beam is then tried with models from cheap to dear. In a scene with several beams each
gets a model of its own: its share in the error is measured, see `beam_shares`, and combinations are run from cheap to
dear, and if none is accurate enough, full models, where truncation may be the reason. Those that made the reference
come last. The chosen model has been run and compared with the reference, and none of its monitors implies a larger
error.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from derive.display import Tabulated
from derive.percentages import percent
from derive.short_text import counted, listed, summary
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.measurement import Line, Point
from derive.study.accuracy.models import model_scene
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.accuracy.reference import undeformed_note
from derive.study.choice.beam_shares import BeamShare
from derive.study.choice.model_runs import ModelRuns
from derive.study.choice.one_beam import try_more_accurate, try_one_beam
from derive.study.choice.reference_errors import SHARE, TrustedReference
from derive.study.choice.rigid_shares import hardly_matter, rigid_shares
from derive.study.choice.screening import Screening
from derive.study.choice.several_beams import try_several_beams
from derive.study.choice.trials import Trials, accurate, usable
from derive.study.choice.trusted_reference import trusted_references
from derive.study.choice.untried import untried
from derive.study.spin_notes import spin_notes

Progress = Callable[[str], None]


@dataclass(frozen=True, repr=False)
class Choice(Tabulated):
    """The result of a search for an error: its reference, and the models in the order in which they were tried.

    `to_pandas` returns a pandas.DataFrame with a row for each model that was tried, of the run that speaks for it.

    Attributes:
        scene: the scene whose models were tried, with the plots whose curves have to be accurate.
        error: the largest error (rms) that is allowed, relative to the peak of a curve.
        reference: the curves that can be trusted, the model that has them, and its own error.
        tried: the models with their runs.
        base: the model of the other bodies while the share of one is measured; None in a scene with one flexible body.
        shares: those of the flexible bodies in the error of a scene with several of them.
        screening: the loads on the flexible bodies relative to their resistance.
        untried: a line on plots that show no deformation, on each kind of models that is left out, and on
            finite-element bodies of references whose fast spin they know no stiffening of.

    Examples:
        >>> import derive
        >>> arm = derive.scene(
        ...     "arm",
        ...     gravity=(0, -9.81),
        ...     ground={"hub": [0, 0]},
        ...     bodies={"arm": {"mass": 1, "length": 1, "bending_stiffness": 20, "markers": {"root": -1, "tip": 1}}},
        ...     joints={"hub": {"kind": "revolute", "between": ["ground.hub", "arm.root"]}},
        ...     outputs={"tip": {"kind": "position", "marker": "arm.tip"}},
        ...     plots={"height": {"y": "tip_2"}},
        ...     simulation={"duration": 0.3, "output": 0.01},
        ... )
        >>> choice = derive.choose(arm, error=0.05)
        >>> choice.chosen[0].model.label  # the beam hardly bends
        'rigid'
        >>> bool(choice.to_pandas()["measured"].min() < 0.05)
        True
    """

    scene: AnyScene
    error: float
    reference: TrustedReference
    tried: tuple[Line, ...]
    base: LadderModel | None = None
    shares: tuple[BeamShare, ...] = ()
    screening: tuple[Screening, ...] = ()
    untried: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """The name of the scene."""
        return self.scene.name

    @property
    def plots(self) -> tuple[str, ...]:
        """The names of the plots whose curves have to be accurate."""
        return tuple(plot.name for plot in self.scene.plots)

    @property
    def chosen_scene(self) -> AnyScene | None:
        """The scene with the chosen model and its tolerance, and of the outputs those that its plots show."""
        if self.chosen is None or self.scene.simulation is None:
            return None
        line, point = self.chosen
        changed = replace(self.scene, simulation=replace(self.scene.simulation, tolerance=point.tolerance))
        return model_scene(changed, line.model)

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

    def __repr__(self) -> str:
        asked = f"an error of {percent(self.error)} in {listed(self.plots)}"
        result = "none is accurate enough"
        if self.chosen is not None:
            line, point = self.chosen
            result = f"{line.label}, {point.setting}, with {percent(point.rms)}"
        tried = counted(len(self.tried), "model")
        return summary(f"Choice for {self.name}: {asked}", {"chosen": result, "tried": tried})


def quiet(_: str) -> None:
    """Report nothing."""


def cheapest_model(
    runs: ModelRuns, error: float, report: Progress = quiet, screened: tuple[Screening, ...] = ()
) -> Choice:
    """The cheapest model of a scene whose plots have at most an error, rms over the peak; see the text of this module.

    report: takes a line on each model. screened: the loads on the beams, which the result shows.

    Raises NotConverged, SpecError, SimulationError, CompilerError.
    """
    rigid = rigid_shares(runs, error, report)
    for known in trusted_references(runs, error, report, hardly_matter(rigid, error)):
        trials = Trials(runs, known, error, report)
        base, shares = _try_models(trials, rigid)
        if (near := trials.undecided) is None:
            break
        reason = f"with an error of {percent(known.error)} it leaves open whether {near.label} is good"
        report(f"reference: {known.model.label}: {reason}, and is refined")
    if not trials.good and not runs.lone:
        trials.run_until_good(_with_all_terms(trials))
    if not trials.good:
        trials.run_until_good(model for model, of in known.errors if usable(model) and of <= trials.budget)
    try_more_accurate(trials)
    shown = undeformed_note([plot.name for plot in runs.scene.plots], known.error)
    left_out = (*shown, *untried(runs.scene, runs.models.modes), *spin_notes(runs.spins.items()))
    return Choice(runs.scene, error, known, trials.timed(), base, shares, screened, left_out)


def _try_models(trials: Trials, rigid: Sequence[BeamShare]) -> tuple[LadderModel | None, tuple[BeamShare, ...]]:
    """Run models of second order from cheap to dear; the base and the shares of a scene with several bodies."""
    if trials.runs.lone:
        try_one_beam(trials)
    elif not trials.is_good(trials.run(LadderModel(Shapes.RIGID))):  # the answer for a slow motion
        base = _base(trials.known, trials.cost, trials.error)
        return base, try_several_beams(trials, base, rigid)
    return None, ()


def _base(known: TrustedReference, cost: PredictedCost, error: float) -> LadderModel:
    """The cheapest model of the reference whose own error is small against the requested one."""
    good = [model for model, of in known.errors if usable(model) and of <= SHARE * error]
    return min(good, key=cost.operations, default=known.model)


def _with_all_terms(trials: Trials) -> list[LadderModel]:
    """The full variants of the models whose error may come from truncation."""
    models = [line.model for line in trials.lines if line.points and trials.is_limited(line.best)]
    return [trials.with_order(m, DisplacementOrder.FULL, names) for m in models if (names := trials.flexible(m))]
