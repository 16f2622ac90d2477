"""The models that a beam is tried with, from cheap to dear, and which of them are worth a trial.

Shapes that cannot have the bending moment of a beam at its ends are wrong by a fifth or more where the beam bends: half
sine waves where an end is held against rotation, modes of a clamped beam where the left end is not clamped alone, and
polynomials whose curvature is linear at most where the moment vanishes. They come last.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from derive.simulation.validity.loaded_sections import held_ends
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.scene import BeamBody, Scene
from derive.study.accuracy.models import FAMILIES, LadderModel, Shapes
from derive.study.accuracy.predicted_cost import PredictedCost, beam_coordinates, beam_rate

MOST = {Shapes.SINES: 5, Shapes.CLAMPED_FREE: 4, Shapes.POLYNOMIALS: 5}
"""Shapes of a beam in one piece, at most, by their kind."""
PIECES = ((2, 2), (2, 3), (3, 2))
"""Pieces, and polynomials of each of them."""
LINEAR = 2
"""Polynomials, from the second degree on, up to which the curvature is constant or linear."""
FULL = 2.0
"""Operations of a model in which nothing is truncated over those of a truncated one, about."""
STAGNANT = 0.7
"""The error over that with two shapes less of the same kind, from which on more of them are not tried."""
HOPELESS = 1.5
"""The error of a model over the one that is asked for, from which on the same with fewer shapes is not tried."""

Errors = Mapping[LadderModel, float]


def beam_candidates(scene: Scene, beam: BeamBody, cost: PredictedCost) -> tuple[LadderModel, ...]:
    """The models of second order of a beam: those that suit its ends from cheap to dear, then the others, likewise.

    The rigid beam is the first. First order comes later, where second order is good, and models in which nothing is
    truncated where truncation is what limits the error, see the search.
    """
    models = [LadderModel(Shapes.RIGID)]
    for shapes, most in MOST.items():
        frame = FAMILIES[shapes][1].kind if shapes in FAMILIES else "mean"
        models += [LadderModel(shapes, n, DisplacementOrder.TRUNCATED, frame) for n in range(1, most + 1)]
    models += [LadderModel(Shapes.POLYNOMIALS, n, DisplacementOrder.TRUNCATED, "mean", p) for p, n in PIECES]
    return tuple(sorted(models, key=candidate_order(scene, beam, cost)))


def candidate_order(scene: Scene, beam: BeamBody, cost: PredictedCost) -> Callable[[LadderModel], tuple[float, ...]]:
    """The key of models in that order."""
    held = frozenset(int(marker.at) for marker in held_ends(scene, beam))

    def key(model: LadderModel) -> tuple[float, ...]:
        operations = cost.operations_of(beam_rate(beam, model), beam_coordinates(model))
        terms = FULL if model.order is DisplacementOrder.FULL else 1.0
        return not suits(model, held), terms * operations, model.size

    return key


def suits(model: LadderModel, held: frozenset[int]) -> bool:
    """Whether the shapes of a model can have the moments at the ends of a beam, of which these are held, -1 and 1."""
    match model.shapes:
        case Shapes.SINES:
            return not held
        case Shapes.CLAMPED_FREE:
            return held == {-1}
        case Shapes.POLYNOMIALS:
            return model.pieces > 1 or model.count > LINEAR or len(held) == 2
        case _:
            return True


def cannot_do(model: LadderModel, errors: Errors, error: float) -> bool:
    """Whether models of its kind that have run show that a model is not within an error.

    One with more shapes is far from it, or two shapes more have not helped: one alone may be odd where an even one is
    missing.
    """
    kind = sorted((other.count, of) for other, of in errors.items() if other.kind == model.kind)
    more = [of for count, of in kind if count > model.count]
    fewer = [of for count, of in kind if count < model.count]
    stagnant = len(fewer) > 2 and fewer[-1] > max(error, STAGNANT * fewer[-3])
    return stagnant or bool(more) and more[0] > HOPELESS * error
