"""The models of a scene with one flexible body, which are tried from cheap to dear."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import islice

from derive.errors import TisserandError
from derive.percentages import percent
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.spatial_scene import SpatialScene
from derive.study.accuracy.ladder_model import COMPONENT_MODES, LadderModel
from derive.study.accuracy.modelled_bodies import Flexible, flexible_members
from derive.study.accuracy.reference import rms_difference
from derive.study.choice.beam_shares import SMALL, TOLERANCE
from derive.study.choice.body_candidates import (
    TWISTS,
    Errors,
    can_twist,
    candidate_order,
    candidates,
    cannot_do,
    has_more,
    trials_if_all_fail,
)
from derive.study.choice.rigid_shares import RIGID
from derive.study.choice.trials import Trials, usable

NEAR = 1.5
"""A model may be cheaper than a good one if its predicted operations are below this times those of the good one."""
WORTH = 0.5
"""A beam is derived if its predicted operations are below this times those of a good model of the reference. Modes are
derived if theirs are below those: they take seconds, where beams in pieces take a minute."""
SIMPLER = 0.5
"""The least ratio of the operations of a model of first order to those of second order."""
BEYOND = 2
"""The number of accurate models that are tried beyond the first one, to show the cost of more accuracy."""


def try_one_beam(trials: Trials) -> None:
    """Run models of second order until one is accurate enough, then those of first order that may be cheaper.

    Models that the runs for the reference have shown to be too far from it are left out. If the beam is not rigid, the
    flexible model that has been derived already is run next: its monitors tell how far the beam bends in one piece.
    """
    (body,) = flexible_members(trials.runs.scene)
    errors = dict(trials.known.errors)
    order = candidate_order(trials.runs.scene, body, trials.cost)
    for model in (RIGID, trials.runs.models.flexible):
        if trials.good:
            return
        line = trials.run(model)
        errors |= {model: line.best} if line.points else {}
    every = candidates(trials.runs.scene, body, trials.cost, trials.runs.models.modes)
    models = [model for model in every if _is_worth_it(model, errors, trials)]
    if any(model.torsion is not None for model in models):
        twists = twists_that_matter(trials, body)
        models = [model for model in models if model.torsion in twists]
    while left := [m for m in (*models, *_with_all_terms(models, errors, trials)) if _is_worth_it(m, errors, trials)]:
        in_order = trials_if_all_fail(sorted(left, key=order), errors, trials.budget)
        model, *others = islice(in_order, 1 + trials.runs.spare)
        trials.runs.expect([model, *others], monitored=True)
        best = min((trials.cost.operations(line.model) for line in trials.good), default=math.inf)
        if trials.cost.operations(model) > NEAR * best:
            break
        line = trials.run(model)
        if line.points:
            errors[model] = line.best
    _try_first_order(trials, body.name)


def twists_that_matter(trials: Trials, body: Flexible) -> tuple[int, ...]:
    """The numbers of shapes of torsion that are tried: none where torsion hardly changes the plots, in one more run."""
    if not can_twist(body):
        return ()
    flexible, runs = trials.runs.models.flexible, trials.runs
    with suppress(TisserandError):
        curves = (runs.curves(model, TOLERANCE) for model in (flexible, replace(flexible, torsion=0)))
        share = rms_difference(*curves)
        if share is not None:
            trials.report(f"share of torsion in {body.name}: {percent(share)}")
            return TWISTS[:1] if share <= trials.budget / SMALL else TWISTS[1:] if share > trials.budget else TWISTS
    return TWISTS


def try_more_accurate(trials: Trials) -> None:
    """Run models of the reference that are more accurate than the good ones, to show the cost of more accuracy.

    These models are compiled already.
    """
    errors, good = dict(trials.known.errors), trials.good
    least = min((line.best for line in good), default=0.0)
    ready = [m for m in trials.runs.ready if m not in trials and usable(m) and errors.get(m, math.inf) < least]
    for model in sorted(ready, key=trials.cost.operations)[: max(0, BEYOND + 1 - len(good))]:
        trials.run(model)


def _is_worth_it(model: LadderModel, errors: Errors, trials: Trials) -> bool:
    """Whether a model is untried, no run shows that it is not accurate enough, and it costs no more than a good one."""
    too_far = model in errors and errors[model] > trials.budget
    dearer = any(has_more(model, line.model) for line in trials.good)
    doubted = trials.is_doubted(flexible_members(trials.runs.scene)[0].name, model)
    in_pieces = [of for of in _good_of_reference(trials) if of.pieces > 1]  # monitors often doubt those in one
    good = in_pieces + [of.model for of in trials.good if of.model == trials.runs.models.flexible]
    least = min(map(trials.cost.operations, good), default=math.inf)
    worth = 1.0 if model.shapes in COMPONENT_MODES else WORTH
    dearer |= model not in trials.runs.ready and trials.cost.operations(model) > worth * least
    return not (model in trials or too_far or dearer or doubted or cannot_do(model, errors, trials.budget))


def _good_of_reference(trials: Trials) -> list[LadderModel]:
    """The models of the reference that are accurate enough by what was measured; their monitors may doubt them."""
    return [model for model, of in trials.known.errors if usable(model) and of <= trials.budget]


def _with_all_terms(models: Sequence[LadderModel], errors: Errors, trials: Trials) -> list[LadderModel]:
    """The full variants of those of the models in one piece whose error may come from truncation.

    Finer models of the reference are no candidates: their full variants take a minute to derive. In space all take so
    long, and there are none where pieces, which truncation changes less, are accurate enough.
    """
    if isinstance(trials.runs.scene, SpatialScene) and _good_of_reference(trials):
        return []
    limited = [m for m in models if m.pieces == 1 and m.size and m in errors and trials.is_limited(errors[m])]
    return [replace(m, order=DisplacementOrder.FULL) for m in limited if m.order is DisplacementOrder.TRUNCATED]


def _try_first_order(trials: Trials, body: str) -> None:
    for line in trials.good:
        if trials.operations(line) * SIMPLER > trials.operations(trials.good[0]):
            return
        if line.model.order is DisplacementOrder.TRUNCATED:
            trials.run(trials.with_order(line.model, DisplacementOrder.FIRST_ORDER, [body]))
