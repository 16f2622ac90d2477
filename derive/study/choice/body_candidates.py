"""The models that a flexible body is tried with, from cheap to dear, and which of them are worth a trial.

Shapes that cannot have the bending moment of a beam at its ends are wrong by a fifth or more where the beam bends: half
sine waves where joints prevent the rotation of an end, modes of a clamped beam where not just the left end is clamped,
and polynomials whose curvature is linear at most where the moment vanishes. They come last.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import permutations

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.simulation.validity.loaded_sections import held_ends
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.free_rates import body_coordinates, body_rate
from derive.study.accuracy.ladder_model import COMPONENT_MODES, FAMILIES, STATIC, LadderModel, Shapes
from derive.study.accuracy.modelled_bodies import Flexible
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.choice.modes_of_bodies import ModesOfBodies

MOST = {Shapes.SINES: 5, Shapes.CLAMPED_FREE: 4, Shapes.POLYNOMIALS: 5}
"""The largest number of shapes of a beam in one piece, by their kind."""
PIECES = ((2, 2), (2, 3), (3, 2))
"""The numbers of pieces, and of polynomials of each piece."""
LINEAR = 2
"""The number of polynomials, from the second degree on, up to which the curvature is constant or linear."""
TWISTS = (0, 1, 2)
"""The numbers of shapes of torsion of a beam that twists."""
MOST_MODES = 8
"""The largest number of modes of a finite-element body, beside static ones."""
ROTATIONS = ("rx", "ry", "rz")
"""The relative rotations that a joint in space may remove."""
FULL = 2.0
"""The approximate operations of a full model relative to those of a truncated one."""
STAGNANT = 0.7
"""More shapes of a kind are not tried if some more have not reduced the error below this part of it."""
FAR = 5.0
"""The most modes of a kind are tried next if fewer of them have more than this times the requested error."""
HOPELESS = 1.5
"""Fewer shapes of a kind are not tried if a model has more than this times the requested error."""

Errors = Mapping[LadderModel, float]


def candidates(scene: AnyScene, body: Flexible, cost: PredictedCost, modes: ModesOfBodies) -> tuple[LadderModel, ...]:
    """The models of a body from cheap to dear, of second order: first those that suit its ends, then the others.

    The rigid body is the first. The search adds models of first order where second order is good, and full models, in
    which nothing is truncated, where truncation limits the error.
    """
    of_kind = _of_modes(body, modes) if isinstance(body, FlexibleBody) else _of_beam(body)
    return tuple(sorted([LadderModel(Shapes.RIGID), *of_kind], key=candidate_order(scene, body, cost)))


def _of_beam(body: BeamBody | SpatialBeam) -> Iterator[LadderModel]:
    """The flexible models of a beam, of second order."""
    for torsion in TWISTS if can_twist(body) else (None,):
        for shapes, most in MOST.items():
            frame = FAMILIES[shapes][1].kind if shapes in FAMILIES else "mean"
            for n in range(1, most + 1):
                yield LadderModel(shapes, n, DisplacementOrder.TRUNCATED, frame, torsion=torsion)
        for pieces, n in PIECES:
            yield LadderModel(Shapes.POLYNOMIALS, n, DisplacementOrder.TRUNCATED, "mean", pieces, torsion=torsion)


def can_twist(body: Flexible) -> bool:
    """Whether a body is a beam in space that has a stiffness against torsion."""
    return isinstance(body, SpatialBeam) and body.torsion is not None


def _of_modes(body: FlexibleBody, modes: ModesOfBodies) -> Iterator[LadderModel]:
    """The flexible models of a finite-element body, of the order that its modes have."""
    for kind in modes.kinds(body):
        for n in range(0 if kind in STATIC else 1, min(MOST_MODES, modes.most(body, kind)) + 1):
            yield LadderModel(kind, n, modes.order(body))


def candidate_order(scene: AnyScene, body: Flexible, cost: PredictedCost) -> Callable[[LadderModel], tuple[float, ...]]:
    """The key that sorts the models of a body in the order of `candidates`."""
    clamped = frozenset() if isinstance(body, FlexibleBody) else clamped_ends(scene, body)

    def key(model: LadderModel) -> tuple[float, ...]:
        size = body_coordinates(scene, body, model)
        operations = cost.operations_of(body_rate(scene, body, model), size)
        terms = FULL if model.order is DisplacementOrder.FULL else 1.0
        return not suits(model, clamped), terms * operations, size

    return key


def clamped_ends(scene: AnyScene, body: BeamBody | SpatialBeam) -> frozenset[int]:
    """The ends of a beam, -1 and 1, at which a moment bends it: in space those where joints hold two rotations."""
    if isinstance(body, BeamBody):
        assert isinstance(scene, Scene)
        return frozenset(int(marker.at) for marker in held_ends(scene, body))
    assert isinstance(scene, SpatialScene)
    ends = {marker.name: int(marker.at) for marker in body.markers if abs(marker.at) == 1}
    holding = (joint for joint in scene.joints if len({*ROTATIONS} & {*SPATIAL_JOINTS[joint.kind].removed(joint)}) > 1)
    held = (end for joint in holding for end in (joint.first, joint.second) if end.body == body.name)
    return frozenset(ends[end.marker] for end in held if end.marker in ends)


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


def trials_if_all_fail(left: Sequence[LadderModel], errors: Errors, error: float) -> Iterator[LadderModel]:
    """Yield models in the order of their trials if none of them is accurate enough.

    They are tried as they are sorted, but where some modes of a kind are far from an error, the most modes of it come
    next: if these fail, fewer need no trial. Free modes of a body that joints hold are such. The richest models of
    beams take too long to derive.
    """
    failed = dict(errors)
    while left:
        model, *others = left
        of_kind = [of for known, of in failed.items() if known.kind == model.kind]
        if model.shapes in COMPONENT_MODES and min(of_kind, default=0.0) > FAR * error:
            model = max((other for other in left if other.kind == model.kind), key=lambda other: other.count)
            others = [other for other in left if other.kind != model.kind]
        yield model
        left, failed[model] = others, math.inf


def cannot_do(model: LadderModel, errors: Errors, error: float) -> bool:
    """Whether models of its kind that have run show that a model is not within an error.

    A model with more shapes, of bending or of torsion, has a far larger error, or two more shapes have not reduced it:
    a single one may be odd where an even one is missing. Modes of finite-element bodies bend them in two planes.
    """
    apart = 2 if model.shapes not in COMPONENT_MODES else 4
    kind = sorted((other.count, of) for other, of in errors.items() if other.kind == model.kind)
    more = [of for other, of in sorted(errors.items(), key=lambda of: of[0].count) if has_more(other, model)]
    fewer = [of for count, of in kind if count < model.count]
    stagnant = len(fewer) > apart and fewer[-1] > max(error, STAGNANT * fewer[-1 - apart])
    far = HOPELESS * error
    hopeless = bool(more) and more[0] > far
    return (
        stagnant
        or hopeless
        or _lacks(model, errors, far)
        or _has_too_few_pieces(model, errors, far)
        or _truncation_is_no_reason(model, errors, far)
    )


def _has_too_few_pieces(model: LadderModel, errors: Errors, error: float) -> bool:
    """Whether fewer pieces, but several, of the same shapes are so wrong that no rate of convergence helps.

    Polynomials up to the degree p give a deflection whose error falls with the power p + 1 of the number of pieces, at
    best.
    """
    return any(
        of * (other.pieces / model.pieces) ** (model.count + 2) > error
        for other, of in errors.items()
        if 1 < other.pieces < model.pieces and other == replace(model, pieces=other.pieces)
    )


def _truncation_is_no_reason(model: LadderModel, errors: Errors, error: float) -> bool:
    """Whether a full model with as many shapes, or fewer, is beyond an error and hardly better than the truncated one.

    That with one shape does not tell: it may be odd where an even one is missing.
    """
    return model.order is DisplacementOrder.FULL and any(
        of > max(error, STAGNANT * errors.get(replace(other, order=DisplacementOrder.TRUNCATED), math.inf))
        for other, of in errors.items()
        if other.kind == model.kind and 1 < other.count <= model.count
    )


def _lacks(model: LadderModel, errors: Errors, error: float) -> bool:
    """Whether a model has shapes of bending, or of torsion, from which more of these took away more than an error.

    What few shapes of bending miss is missing in models of another order, and beside other shapes of torsion, as well;
    what few shapes of torsion miss is missing beside all shapes of bending.
    """
    for of, finer in permutations(errors, 2):
        if errors[of] - errors[finer] > error and has_more(finer, of):
            bends = finer.torsion == of.torsion and model.count <= of.count
            if bends and model == replace(of, count=model.count, order=model.order, torsion=model.torsion):
                return True
            if finer.count == of.count and (model.pieces, model.torsion) == (of.pieces, of.torsion):
                return True
    return False


def has_more(other: LadderModel, model: LadderModel) -> bool:
    """Whether a model has the shapes of another one and more."""
    alike = other.kind == replace(model, torsion=other.torsion).kind
    counts = [((of.count, of.torsion or 0)) for of in (model, other)]
    return alike and counts[0] != counts[1] and all(a <= b for a, b in zip(*counts, strict=True))
