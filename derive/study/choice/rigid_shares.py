"""The beams of a scene that matter: beams are made rigid in a model with few shapes, before finer models are derived.

Beams that hardly matter are rigid in references, whose error includes their shares, and in the chosen model.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from derive.errors import TisserandError, first_line
from derive.percentages import percent
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.modelled_bodies import flexible_members
from derive.study.accuracy.reference import rms_difference
from derive.study.choice.beam_shares import TOLERANCE, BeamShare, replaced
from derive.study.choice.model_runs import ModelRuns

MATTERS = 15.0
"""The least ratio of the requested error to the shares of all beams together that are rigid in references."""
GROUPED = 4
"""The number of beams from which on groups of them are made rigid at once, and divided where that matters."""
RIGID = LadderModel(Shapes.RIGID)

Progress = Callable[[str], None]


def rigid_shares(runs: ModelRuns, error: float, report: Progress) -> tuple[BeamShare, ...]:
    """The shares of the beams as rigid bodies; beams of a group that hardly matters get equal parts of its share.

    The result is empty for a lone beam, and where the model with few shapes cannot be run.
    """
    names = tuple(beam.name for beam in flexible_members(runs.scene))
    if runs.lone:
        return ()
    flexible = runs.models.flexible
    groups = [names] if len(names) >= GROUPED else [(name,) for name in names]
    runs.expect(replaced(runs.scene, flexible, dict.fromkeys(group, RIGID)) for group in groups)
    try:
        fine = runs.curves(flexible, TOLERANCE)
    except TisserandError:
        return ()

    def measured(group: Sequence[str]) -> Iterator[BeamShare]:
        text = f"share of {', '.join(group)}: rigid"
        runs.progress(f"{text} ...")
        share, failure = None, "a curve vanishes all the time"
        try:
            model = replaced(runs.scene, flexible, dict.fromkeys(group, RIGID))
            share = rms_difference(fine, runs.curves(model, TOLERANCE))
        except TisserandError as problem:
            failure = first_line(problem)
        report(f"{text}: {failure if share is None else percent(share)}")
        if len(group) == 1:
            yield BeamShare(group[0], RIGID, share, failure if share is None else "")
        elif share is not None and share <= limit * np.sqrt(len(group)):
            yield from (BeamShare(name, RIGID, float(share / np.sqrt(len(group)))) for name in group)
        else:
            yield from measured(group[: len(group) // 2])
            yield from measured(group[len(group) // 2 :])

    limit = _limit(names, error)
    return tuple(share for group in groups for share in measured(group))


def hardly_matter(rigid: Sequence[BeamShare], error: float) -> tuple[BeamShare, ...]:
    """The shares of the beams that may be rigid in references; one beam at least is left."""
    small = [of for of in rigid if of.share is not None and of.share <= _limit(rigid, error)]
    if len(small) == len(rigid):
        small.sort(key=lambda of: of.share or 0.0)
        del small[-1:]
    return tuple(small)


def _limit(beams: Sequence[object], error: float) -> float:
    return float(error / MATTERS / np.sqrt(len(beams)))
