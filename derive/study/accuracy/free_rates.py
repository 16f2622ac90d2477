"""The fastest vibrations of flexible bodies that are free, and their coordinates: predictions of what a run costs.

The joints of a mechanism add constraints, which lower the frequencies of its bodies.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.linalg import eigh

from derive.mechanics.bodies.beam_functions import ONE, XI, BeamFunction, polynomial
from derive.mechanics.bodies.modal_body import ModalBody
from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.reduction.body import reduce
from derive.simulation.observables.beams import function_values
from derive.simulation.observables.motion import si_value
from derive.spec.model.beam_parts import AssumedDeflection, BeamDamping
from derive.spec.model.body import NodalBody
from derive.spec.model.scene import BeamBody, RigidBody
from derive.spec.model.spatial_beam import SpatialBeam, SpatialBody
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.modelled_bodies import Flexible, flexible_members, modelled_member

RIGID, RIGID_IN_SPACE = 3, 6
"""The numbers of coordinates of a rigid body in the plane and in space."""
POINTS = 24
"""The number of points of the quadrature of products of shape functions."""


def fastest_rate(scene: AnyScene, model: LadderModel) -> float:
    """The fastest vibration, or decay, of the flexible bodies of a scene with a model, rad/s; 0 if all are rigid."""
    return max((body_rate(scene, body, model.of(body.name)) for body in flexible_members(scene)), default=0.0)


def body_rate(scene: AnyScene, body: Flexible, model: LadderModel) -> float:
    """The fastest vibration of a free body, or piece of a beam, rad/s, or its decay by damping if that is faster."""
    return 0.0 if model.shapes is Shapes.RIGID else _rate(modelled_member(scene, body, model))


def rigid_coordinates(scene: AnyScene) -> int:
    """The number of coordinates of a rigid body of a scene, without joints."""
    return RIGID_IN_SPACE if isinstance(scene, SpatialScene) else RIGID


def body_coordinates(scene: AnyScene, body: Flexible, model: LadderModel) -> int:
    """The number of coordinates of a flexible body with a model, without joints."""
    if isinstance(body, BeamBody):
        return max(RIGID, model.size)
    return RIGID_IN_SPACE if model.shapes is Shapes.RIGID else _coordinates(modelled_member(scene, body, model))


@cache
def _rate(body: BeamBody | RigidBody | SpatialBody) -> float:
    match body:
        case BeamBody(beam=beam, pieces=pieces):
            mass, length = (si_value(q) / pieces for q in (beam.mass, beam.length))
            return _damped(_bending(beam.deflection, si_value(beam.bending_stiffness), mass, length), beam.damping)
        case SpatialBeam():
            return _damped(max(_rates_in_space(body)), body.damping)
        case FlexibleBody():
            return _modal_rate(body)
        case _:
            return 0.0


def _damped(rate: float, damping: BeamDamping | None) -> float:
    return max(rate, rate**2 * (si_value(damping.stiffness) if damping else 0.0))


def _rates_in_space(beam: SpatialBeam) -> list[float]:
    """The fastest vibrations of a piece of a beam in bending, torsion and stretching, rad/s."""
    mass, length, inertia = (si_value(of) / beam.pieces for of in (beam.mass, beam.length, beam.rotary_inertia))
    both = zip(beam.deflections, beam.bending_stiffnesses, strict=True)
    rates = [_bending(of, si_value(stiffness), mass, length) for of, stiffness in both]
    for part, moved in ((beam.torsion, inertia), (beam.axial, mass)):
        if part is not None:
            shapes = (ONE, *(p for p in map(polynomial, part.ansatz) if not p.derivative().is_zero))
            rates.append(_highest(shapes, 1) * float(np.sqrt(si_value(part.stiffness) / (moved * length))))
    return rates


def _bending(deflection: AssumedDeflection, stiffness: float, mass: float, length: float) -> float:
    shapes = (ONE, XI, *assumed_shapes(deflection))
    return _highest(shapes, 2) * float(np.sqrt(stiffness / (mass * length**3)))


@cache
def _highest(fields: tuple[BeamFunction, ...], derivative: int) -> float:
    """The highest frequency of a free rod with m = l = 1 and the stiffness 1 against a derivative of its fields."""
    xi, weights = np.polynomial.legendre.leggauss(POINTS)
    v, strain = (np.array([function_values(f.derivative(n), xi) for f in fields]) for n in (0, derivative))
    mass, stiffness = (v * weights) @ v.T / 2, 2 ** (2 * derivative - 1) * (strain * weights) @ strain.T
    return float(np.sqrt(eigh(stiffness, mass, eigvals_only=True)[-1]))


@cache
def _reduced(body: NodalBody) -> ModalBody:
    return reduce(body)


def _modal_rate(body: FlexibleBody) -> float:
    """The fastest vibration or decay of the modes of a finite-element body, rad/s."""
    modes = _reduced(body.body)
    if not len(modes.c8):
        return 0.0
    squared, decay = (eigh(of, modes.c8, eigvals_only=True)[-1] for of in (modes.stiffness, modes.damping))
    return float(max(np.sqrt(max(squared, 0.0)), decay / 2))


def _coordinates(body: BeamBody | RigidBody | SpatialBody) -> int:
    match body:
        case SpatialBeam():
            fields = sum(len(assumed_shapes(of)) for of in body.deflections)
            fields += sum(len(part.ansatz) for part in (body.torsion, body.axial) if part is not None)
            return body.pieces * (RIGID_IN_SPACE + fields)
        case FlexibleBody():
            return RIGID_IN_SPACE + len(_reduced(body.body).c8)
        case _:
            return RIGID_IN_SPACE
