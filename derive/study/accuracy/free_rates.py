"""The fastest vibrations of flexible bodies that are free, and their coordinates: predictions of what a run costs.

The joints of a mechanism add constraints, which lower the frequencies of its bodies.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.linalg import eigh

from derive.mechanics.bodies.beam_functions import ONE, XI, BeamFunction
from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.simulation.observables.beams import function_values
from derive.simulation.observables.motion import si_value
from derive.spec.model.beam_parts import AssumedDeflection
from derive.spec.model.planar_bodies import BeamBody, RigidBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.modelled_bodies import Flexible, flexible_members, modelled_member
from derive.study.accuracy.spatial_models import coordinates
from derive.study.accuracy.spatial_rates import spatial_rate

RIGID, RIGID_IN_SPACE = 3, 6
"""The numbers of coordinates of a rigid body in the plane and in space."""
POINTS = 24
"""The number of points of the quadrature of products of shape functions."""


def fastest_rate(scene: AnyScene, model: LadderModel) -> float:
    """The fastest vibration, or decay, of the flexible bodies of a scene with a model, rad/s; 0 if all are rigid."""
    return max((body_rate(scene, body, model.of(body.name)) for body in flexible_members(scene)), default=0.0)


def body_rate(scene: AnyScene, body: Flexible, model: LadderModel) -> float:
    """The fastest vibration of a free body, or piece of a beam, rad/s, or its decay by damping if that is faster."""
    if model.shapes is Shapes.RIGID:
        return 0.0
    beam = modelled_member(scene, body, model)
    if not isinstance(beam, BeamBody):
        return 0.0 if isinstance(beam, RigidBody) else spatial_rate(beam)
    mass, length = (si_value(q) / model.pieces for q in (beam.beam.mass, beam.beam.length))
    stiffness, damping = si_value(beam.beam.bending_stiffness), beam.beam.damping
    frequency = _highest(beam.beam.deflection) * float(np.sqrt(stiffness / (mass * length**3)))
    return max(frequency, frequency**2 * (si_value(damping.stiffness) if damping else 0.0))


def rigid_coordinates(scene: AnyScene) -> int:
    """The number of coordinates of a rigid body of a scene, without joints."""
    return RIGID_IN_SPACE if isinstance(scene, SpatialScene) else RIGID


def body_coordinates(scene: AnyScene, body: Flexible, model: LadderModel) -> int:
    """The number of coordinates of a flexible body with a model, without joints."""
    if isinstance(body, BeamBody):
        return max(RIGID, model.size)
    own = modelled_member(scene, body, model)
    assert not isinstance(own, (BeamBody, RigidBody))
    return coordinates(own)


@cache
def _highest(deflection: AssumedDeflection) -> float:
    """The highest frequency of a free beam with m = l = EI = 1: its velocities are 1, xi and the shapes."""
    xi, weights = np.polynomial.legendre.leggauss(POINTS)
    fields: tuple[BeamFunction, ...] = (ONE, XI, *assumed_shapes(deflection))
    v, curvature = (np.array([function_values(f.derivative(n), xi) for f in fields]) for n in (0, 2))
    mass, stiffness = (v * weights) @ v.T / 2, 8 * (curvature * weights) @ curvature.T
    return float(np.sqrt(eigh(stiffness, mass, eigvals_only=True)[-1]))
