"""The models that a beam is tried with, from cheap to dear, and which of them are worth a trial.

Shapes that cannot have the bending moment of a beam at its ends are wrong by a fifth or more where the beam bends: half
sine waves where joints prevent the rotation of an end, modes of a clamped beam where not just the left end is clamped,
and polynomials whose curvature is linear at most where the moment vanishes. They come last.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from derive.simulation.validity.loaded_sections import held_ends
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.scene import BeamBody, Scene
from derive.study.accuracy.ladder_model import FAMILIES, LadderModel, Shapes
from derive.study.accuracy.predicted_cost import PredictedCost, beam_coordinates, beam_rate

MOST = {Shapes.SINES: 5, Shapes.CLAMPED_FREE: 4, Shapes.POLYNOMIALS: 5}
"""The largest number of shapes of a beam in one piece, by their kind."""
PIECES = ((2, 2), (2, 3), (3, 2))
"""The numbers of pieces, and of polynomials of each piece."""
LINEAR = 2
"""The number of polynomials, from the second degree on, up to which the curvature is constant or linear."""
FULL = 2.0
"""The approximate operations of a full model relative to those of a truncated one."""
STAGNANT = 0.7
"""More shapes of a kind are not tried if two more have not reduced the error below this part of it."""
HOPELESS = 1.5
"""Fewer shapes of a kind are not tried if a model has more than this times the requested error."""

Errors = Mapping[LadderModel, float]


def beam_candidates(scene: Scene, beam: BeamBody, cost: PredictedCost) -> tuple[LadderModel, ...]:
    """The models of second order of a beam from cheap to dear: first those that suit its ends, then the others.

    The rigid beam is the first. The search adds models of first order where second order is good, and full models,
    in which nothing is truncated, where truncation limits the error.
    """
    models = [LadderModel(Shapes.RIGID)]
    for shapes, most in MOST.items():
        frame = FAMILIES[shapes][1].kind if shapes in FAMILIES else "mean"
        models += [LadderModel(shapes, n, DisplacementOrder.TRUNCATED, frame) for n in range(1, most + 1)]
    models += [LadderModel(Shapes.POLYNOMIALS, n, DisplacementOrder.TRUNCATED, "mean", p) for p, n in PIECES]
    return tuple(sorted(models, key=candidate_order(scene, beam, cost)))


def candidate_order(scene: Scene, beam: BeamBody, cost: PredictedCost) -> Callable[[LadderModel], tuple[float, ...]]:
    """The key that sorts the models of a beam in the order of `beam_candidates`."""
    clamped = frozenset(int(marker.at) for marker in held_ends(scene, beam))

    def key(model: LadderModel) -> tuple[float, ...]:
        operations = cost.operations_of(beam_rate(beam, model), beam_coordinates(model))
        terms = FULL if model.order is DisplacementOrder.FULL else 1.0
        return not suits(model, clamped), terms * operations, model.size

    return key


def suits(model: LadderModel, clamped: frozenset[int]) -> bool:
    """Whether the shapes of a model can have the bending moments of a beam at its ends `clamped`, of -1 and 1."""
    match model.shapes:
        case Shapes.SINES:
            return not clamped
        case Shapes.CLAMPED_FREE:
            return clamped == {-1}
        case Shapes.POLYNOMIALS:
            return model.pieces > 1 or model.count > LINEAR or len(clamped) == 2
        case _:
            return True


def cannot_do(model: LadderModel, errors: Errors, error: float) -> bool:
    """Whether models of its kind that have run show that a model is not within an error.

    A model with more shapes has a far larger error, or two more shapes have not reduced it: a single one may be odd
    where an even one is missing.
    """
    kind = sorted((other.count, of) for other, of in errors.items() if other.kind == model.kind)
    more = [of for count, of in kind if count > model.count]
    fewer = [of for count, of in kind if count < model.count]
    stagnant = len(fewer) > 2 and fewer[-1] > max(error, STAGNANT * fewer[-3])
    return stagnant or bool(more) and more[0] > HOPELESS * error
