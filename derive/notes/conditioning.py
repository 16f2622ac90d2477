"""The condition of the mass matrix of a beam, which bounds the digits that its factorisation loses."""

from __future__ import annotations

import numpy as np

from derive.mechanics.bodies.beam_functions import ONE, XI
from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene
from derive.spec.model.specification import Specification

ILL_CONDITIONED = 1e8
"""Half of the digits of a double may be lost above this condition number."""


def shape_condition(beam: PlanarBeam) -> float:
    """The condition number of the mass matrix of translation, rotation and shapes, scaled to a diagonal of ones.

    It does not depend on mass, length and amplitudes. Above 1e16 it is a lower bound.
    """
    fields = (ONE, XI, *assumed_shapes(beam.deflection))  # the first two: translation and rotation
    gram = np.array([[float((a * b).integral()) for a in fields] for b in fields])
    size = np.sqrt(np.diag(gram))
    return float(np.linalg.cond(gram / np.outer(size, size)))


def beams(spec: Specification) -> tuple[tuple[PlanarBeam, int], ...]:
    """The beams of a specification, each with the number of pieces into which it is divided."""
    match spec:
        case Scene():
            return tuple((body.beam, body.pieces) for body in spec.bodies if isinstance(body, BeamBody))
        case PlanarBeam():
            return ((spec, 1),)
    return ()


def condition_warnings(spec: Specification) -> tuple[str, ...]:
    """A warning on each beam whose shapes are so nearly dependent that accelerations lose digits."""
    return tuple(
        f"the mass matrix of {beam.name} has a condition number of {condition:.0e}: accelerations may lose "
        f"{min(16, round(np.log10(condition)))} of 16 digits; {_advice(beam)}"
        for beam, _ in beams(spec)
        if (condition := shape_condition(beam)) > ILL_CONDITIONED
    )


def _advice(beam: PlanarBeam) -> str:
    return (
        'take fewer shapes, or frame = "mean"' if beam.orthogonal else "write orthogonal = true, or take fewer shapes"
    )
