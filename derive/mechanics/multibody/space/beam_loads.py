"""Distributed loads on a beam in space: forces at points that move as means over the load, and torques on sections.

Forces per length act as their resultants at points with the mean displacements, as in the plane, see `beam_loads` of
planar beams. The virtual rotation of a section, for which a torque does work, contains products of the amplitudes: a
torque per length acts as torques on the sections at the points of Gauss, which integrate these products exactly where
the shapes are polynomials, but for the normalised quaternion of each section.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from derive.mechanics.bodies.reference_conditions import on_piece
from derive.mechanics.bodies.section_fields import section_shapes
from derive.mechanics.multibody.bodies.beam_loads import number_function, per_length, resultants, torque_name
from derive.mechanics.multibody.bodies.body_type import CrossSection
from derive.mechanics.multibody.space.beam_sections import mean_section, section_at
from derive.spec.model.markers import MarkerRef
from derive.spec.model.spatial_beam import SpatialBeam, cut_into
from derive.spec.model.spatial_beam_parts import SectionFrame
from derive.spec.model.spatial_forces import SpatialForce, SpatialTorque

if TYPE_CHECKING:
    from derive.mechanics.bodies.beam_functions import BeamFunction
    from derive.spec.model.spatial_beam_parts import SpatialDistributedLoad
    from derive.spec.model.time_function import TimeFunction

POINTS_OF_FAMILIES = 6
"""The number of sections on which a torque per length acts if shapes are no polynomials."""


def load_sections(beam: SpatialBeam) -> dict[str, CrossSection]:
    """The sections of a beam, or of a piece of one, on which its loads act."""
    result = {}
    for r in resultants(beam.loads, cut_into(beam), _number(beam)):
        docs = (f"point of load {r.load.name}", f"mean position of load {r.load.name}")
        result[r.point] = mean_section(r.point, docs, beam, r.mean)
    for load in beam.loads:
        for name, at, _ in _torques(beam, load):
            result[name] = section_at(SectionFrame(name, at), beam)
    return result


def load_actions(beam: SpatialBeam) -> Iterator[SpatialForce | SpatialTorque]:
    """The forces and torques by which the loads act on a beam, or on a piece of one."""
    zero, n = number_function(Fraction(0)), cut_into(beam)
    for r in resultants(beam.loads, n, _number(beam)):
        force = per_length(r.total / n, beam.length, r.load.time)
        x, y, z = (force if k == r.component else zero for k in range(3))
        yield SpatialForce(f"{beam.name}_{r.point}", MarkerRef(beam.name, r.point), (x, y, z), r.load.frame)
    for load in beam.loads:
        for name, _, (x, y, z) in _torques(beam, load):
            yield SpatialTorque(f"{beam.name}_{name}", MarkerRef(beam.name, name), (x, y, z), frame=load.frame)


def _torques(
    beam: SpatialBeam, load: SpatialDistributedLoad
) -> Iterator[tuple[str, Fraction, tuple[TimeFunction, ...]]]:
    """The torques of a load: the name of the section, its position xi, and the components."""
    n, number = cut_into(beam), _number(beam)
    densities = [on_piece(of, n, number) for of in load.torque]
    if all(density.is_zero for density in densities):
        return
    places, weights = np.polynomial.legendre.leggauss(_points(beam, densities))
    for k, (xi, weight) in enumerate(zip(places, weights, strict=True), 1):
        at = Fraction(float(xi))
        parts = (Fraction(density.at(at)) * Fraction(float(weight)) / (2 * n) for density in densities)
        yield torque_name(load.name, number, k), at, tuple(per_length(part, beam.length, load.time) for part in parts)


def _points(beam: SpatialBeam, densities: list[BeamFunction]) -> int:
    """The number of sections that integrate a torque per length times the product of two rotations."""
    rotations = [of for shape in section_shapes(beam) for of in shape.rotation.values()]
    if not all(of.is_exact for of in rotations):
        return POINTS_OF_FAMILIES
    degree = max(len(of.coefficients) for of in densities) - 1
    degree += 2 * (max((len(of.coefficients) for of in rotations), default=1) - 1)
    return degree // 2 + 1


def _number(beam: SpatialBeam) -> int:
    return beam.piece_of.number if beam.piece_of else 0
