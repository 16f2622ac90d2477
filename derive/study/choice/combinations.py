"""Combinations of models of the beams of a scene, of which the shares in the error are known.

Shares of independent errors add up as squares. A run costs as many operations as follow from the fastest vibration of
any beam and from the sum of all coordinates, so that, below each limit of the vibrations, the combinations with the
least error for their coordinates follow from one beam after the other. The work is proportional to the number of beams,
whereas that of trying all combinations is exponential in it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from derive.spec.model.specification import AnyScene
from derive.study.accuracy.free_rates import body_coordinates, body_rate, rigid_coordinates
from derive.study.accuracy.ladder_model import LadderModel, Shapes, mixed
from derive.study.accuracy.modelled_bodies import flexible_members
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.choice.beam_shares import BeamShare


@dataclass(frozen=True)
class BeamCombination:
    """A model whose beams have models of their own, and the error and the operations that are predicted for it."""

    model: LadderModel
    error: float
    operations: float


class _Option(NamedTuple):
    """A model of a beam: its fastest vibration, rad/s, its coordinates, and the square of its share."""

    model: LadderModel
    rate: float
    coordinates: int
    square: float


def combinations(
    scene: AnyScene, shares: Mapping[str, Sequence[BeamShare]], budget: float, cost: PredictedCost
) -> tuple[BeamCombination, ...]:
    """The combinations whose error should be within a budget, from cheap to dear, each with less error than all before.

    shares: those of the models that each beam may have, by the name of the beam.
    """
    beams = {beam.name: beam for beam in flexible_members(scene)}
    options = {
        name: [
            _Option(
                of.model,
                body_rate(scene, beams[name], of.model),
                body_coordinates(scene, beams[name], of.model),
                of.share**2,
            )
            for of in known
            if of.share is not None and of.share <= budget
        ]
        for name, known in shares.items()
    }
    rigid = mixed({name: LadderModel(Shapes.RIGID) for name in beams})
    others = cost.coordinates(rigid) - rigid_coordinates(scene) * len(beams)
    candidates: list[tuple[float, float, _Table, int]] = []
    for limit in sorted({option.rate for known in options.values() for option in known}):
        table = _table([[option for option in known if option.rate <= limit] for known in options.values()])
        for coordinates in np.flatnonzero(table.least <= budget**2).tolist():
            operations = cost.operations_of(limit, others + coordinates)
            candidates.append((operations, float(np.sqrt(table.least[coordinates])), table, coordinates))
    result: list[BeamCombination] = []
    for operations, error, table, coordinates in sorted(candidates, key=lambda of: of[:2]):
        if not result or error < result[-1].error:
            models = dict(zip(options, table.models(coordinates), strict=True))
            result.append(BeamCombination(mixed(models), error, operations))
    return tuple(result)


@dataclass(frozen=True)
class _Table:
    """The least sum of the squares of shares (inf where there is none) by the sum of the coordinates of the beams.

    options: those of each beam; picks: for each beam, the option of the least sum, by the coordinates so far.
    """

    least: NDArray[np.float64]
    options: Sequence[Sequence[_Option]]
    picks: Sequence[NDArray[np.intp]]

    def models(self, coordinates: int) -> list[LadderModel]:
        """The models of the beams with the least sum."""
        result: list[LadderModel] = []
        for options, picks in zip(reversed(self.options), reversed(self.picks), strict=True):
            option = options[picks[coordinates]]
            coordinates -= option.coordinates
            result.insert(0, option.model)
        return result


def _table(options: Sequence[Sequence[_Option]]) -> _Table:
    """The table of the least sums, computed one beam after the other."""
    if not all(options):
        return _Table(np.zeros(0), options, ())
    least, picks = np.zeros(1), list[NDArray[np.intp]]()
    for known in options:
        sums = np.full((len(known), len(least) + max(option.coordinates for option in known)), np.inf)
        for row, option in zip(sums, known, strict=True):
            row[option.coordinates : option.coordinates + len(least)] = least + option.square
        picks.append(sums.argmin(axis=0))
        least = sums.min(axis=0)
    return _Table(least, options, picks)
