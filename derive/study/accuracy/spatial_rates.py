"""The fastest vibrations of flexible bodies in space, free of joints, from which the cost of their models follows."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from scipy.linalg import eigh

from derive.mechanics.bodies.beam_functions import ONE, XI, BeamFunction
from derive.mechanics.bodies.section_fields import BENDING, Direction, section_shapes
from derive.mechanics.bodies.spatial_beam import CURVED
from derive.reduction.body import reduce
from derive.simulation.observables.beams import function_values
from derive.simulation.observables.motion import si_value
from derive.spec.model.spatial_beam import SpatialBeam, SpatialBody
from derive.spec.model.spatial_bodies import FlexibleBody

POINTS = 24
"""The number of points of the quadrature of products of shape functions."""


@lru_cache(64)
def spatial_rate(body: SpatialBody) -> float:
    """The fastest vibration, or decay, of a free body, or piece of a beam, rad/s; 0 of a rigid one."""
    if isinstance(body, SpatialBeam):
        damping = si_value(body.damping.stiffness) if body.damping else 0.0
        return _with_decay(_of_beam(body), damping)
    if isinstance(body, FlexibleBody):
        data = reduce(body.body)
        rate = float(np.sqrt(max(eigh(data.stiffness, data.c8, eigvals_only=True), default=0.0)))
        return _with_decay(rate, float(body.body.damping.stiffness))
    return 0.0


def _with_decay(rate: float, damping: float) -> float:
    """The rate of a vibration, rad/s, or of its decay if that is faster; damping: the factor of the stiffness, s."""
    return max(rate, rate**2 * damping)


def _of_beam(body: SpatialBeam) -> float:
    """The fastest vibration of a free piece of a beam, rad/s."""
    mass, length, inertia = (si_value(q) / body.pieces for q in (body.mass, body.length, body.rotary_inertia))
    shapes = section_shapes(body)
    units = {
        d: np.sqrt(si_value(q) / (mass * length**3)) for d, q in zip(BENDING, body.bending_stiffnesses, strict=True)
    }
    if body.torsion:
        units[Direction.TORSION] = np.sqrt(si_value(body.torsion.stiffness) / (inertia * length))
    if body.axial:
        units[Direction.AXIAL] = np.sqrt(si_value(body.axial.stiffness) / (mass * length))
    every = (
        unit * _dimensionless([shape.of for shape in shapes if shape.direction is direction], CURVED[direction])
        for direction, unit in units.items()
    )
    return float(max(every))


def _dimensionless(shapes: Sequence[BeamFunction], order: int) -> float:
    """The highest frequency of fields along a rod of unit length, mass and stiffness; order: of the strain."""
    xi, weights = np.polynomial.legendre.leggauss(POINTS)
    fields = ((ONE,) if order == 1 else (ONE, XI)) + tuple(shapes)
    v, strain = (np.array([function_values(f.derivative(n), xi) for f in fields]) for n in (0, order))
    mass, stiffness = (v * weights) @ v.T / 2, 2 ** (2 * order - 1) * (strain * weights) @ strain.T
    return float(np.sqrt(eigh(stiffness, mass, eigvals_only=True)[-1]))
