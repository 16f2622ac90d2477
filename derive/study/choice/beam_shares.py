"""What each beam adds to the error of a scene: one beam at a time is coarsened, and all others stay fine.

From these shares follow combinations that should be accurate enough, which the search then runs: shares of independent
errors add up as squares, and what they do in truth is measured.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from derive.errors import TisserandError, first_line
from derive.percentages import percent
from derive.simulation.observables.beams import beam_bodies
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.plots import Plot
from derive.spec.model.scene import Scene
from derive.study.accuracy.measurement import compiled, motion
from derive.study.accuracy.models import FAMILIES, LadderModel, Shapes, mixed
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.accuracy.reference import Curves, bare_plots, curves_of, rms_difference

TOLERANCE = 1e-6
"""That of the runs that are compared."""
SMALL = 3.0
"""The error that is asked for over the number of beams, over a share that is small."""
ENOUGH = 2
"""Models with small shares that are tried for each beam."""
STAGNANT = 0.7
"""The share over that with two shapes less of the same kind, from which on more of them are not tried."""
COMBINATIONS = 10_000
"""Combinations that are looked at, at most."""

Progress = Callable[[str], None]


@dataclass(frozen=True)
class BeamShare:
    """How far the plots change, rms over the peak, if one beam is modelled so; None where it cannot be, see failure."""

    beam: str
    model: LadderModel
    share: float | None
    failure: str = ""


def beam_options() -> tuple[LadderModel, ...]:
    """The models that are tried for a beam, from few coordinates to many; first order comes later, see the search."""
    order = DisplacementOrder.TRUNCATED
    models = [LadderModel(Shapes.RIGID)]
    for shapes, most in ((Shapes.SINES, 3), (Shapes.CLAMPED_FREE, 2)):
        models += [LadderModel(shapes, n, order, FAMILIES[shapes][1].kind) for n in range(1, most + 1)]
    models += [LadderModel(Shapes.POLYNOMIALS, n, order) for n in range(1, 5)]
    models += [LadderModel(Shapes.POLYNOMIALS, n, order, "mean", 2) for n in (2, 3)]
    return tuple(sorted(models, key=lambda m: m.size))


def beam_shares(
    scene: Scene, base: LadderModel, plots: Sequence[Plot], error: float, progress: Progress, report: Progress
) -> tuple[BeamShare, ...]:
    """The shares of the beams in the error; the others are those of the model `base`. Raises TisserandError.

    The models of a beam are tried from few coordinates to many, until some have small shares. progress: takes what is
    being done; report: takes what came of it.
    """
    bare = tuple(one for plot in plots for one in bare_plots(plot))
    scene = replace(scene, plots=tuple(plots))
    beams = beam_bodies(scene)

    def curves(model: LadderModel) -> Curves:
        return curves_of(bare, motion(compiled(scene, model, monitored=False), TOLERANCE))

    fine = curves(base)
    result: list[BeamShare] = []
    for beam in beams:
        small, families = 0, dict[tuple[Shapes, int], list[float]]()
        for option in beam_options():
            if small >= ENOUGH:
                break
            family = families.setdefault((option.shapes, option.pieces), [])
            if option.size >= base.of(beam.name).size or _stagnant(family):
                continue
            progress(f"share of {beam.name}: {option.label} ...")
            try:
                share = rms_difference(fine, curves(replaced(scene, base, {beam.name: option})))
            except TisserandError as failure:
                result.append(BeamShare(beam.name, option, None, first_line(failure)))
                report(f"share of {beam.name}: {option.label}: {first_line(failure)}")
                continue
            assert share is not None, "the reference does not vanish"
            report(f"share of {beam.name}: {option.label}: {percent(share)}")
            family.append(share)
            small += share <= error / SMALL / len(beams)
            result.append(BeamShare(beam.name, option, share))
    return tuple(result)


def _stagnant(shares: Sequence[float]) -> bool:
    """Whether the last two shapes have not helped: one of them may be odd where an even one is missing."""
    return len(shares) > 2 and shares[-1] > STAGNANT * shares[-3]


def replaced(scene: Scene, base: LadderModel, models: dict[str, LadderModel]) -> LadderModel:
    """The model in which some beams are modelled otherwise."""
    return mixed({beam.name: models.get(beam.name) or base.of(beam.name) for beam in beam_bodies(scene)})


@dataclass(frozen=True)
class BeamCombination:
    """A model whose beams are modelled each on its own, and the error and the operations that it should have."""

    model: LadderModel
    error: float
    operations: float


def combinations(
    scene: Scene, base: LadderModel, shares: Sequence[BeamShare], budget: float, cost: PredictedCost
) -> tuple[BeamCombination, ...]:
    """The combinations whose error should be within a budget, from cheap to dear."""
    names = [beam.name for beam in beam_bodies(scene)]
    most = max(2, int(COMBINATIONS ** (1 / len(names))))
    options = [tuple(_worthwhile(scene, name, base, shares, budget, cost))[:most] for name in names]
    result = []
    for chosen in product(*options):
        error = float(np.sqrt(sum((of.share or 0.0) ** 2 for of in chosen)))
        if error <= budget:
            model = mixed({of.beam: of.model for of in chosen})
            result.append(BeamCombination(model, error, cost.operations(model)))
    return tuple(sorted(result, key=lambda of: (of.operations, of.error)))


def _worthwhile(
    scene: Scene, name: str, base: LadderModel, shares: Sequence[BeamShare], budget: float, cost: PredictedCost
) -> Iterator[BeamShare]:
    """The models of a beam within the budget, from cheap to dear, each with a smaller share than all cheaper ones."""
    rigid = LadderModel(Shapes.RIGID)
    known = [BeamShare(name, base.of(name), 0.0)]
    known += [of for of in shares if of.beam == name and of.share is not None and of.share <= budget]

    def price(of: BeamShare) -> float:
        others = {beam.name: rigid for beam in beam_bodies(scene)}
        return cost.operations(mixed({**others, name: of.model}))

    best = np.inf
    for of in sorted(known, key=lambda of: (price(of), of.share)):
        if of.share is not None and of.share < best:
            best = of.share
            yield of
