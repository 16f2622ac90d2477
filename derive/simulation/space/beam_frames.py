"""The sections of a beam in space as numbers: where they are, and how they move and turn with the amplitudes."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from itertools import product

import numpy as np

from derive.mechanics.bodies.beam_functions import BeamFunction
from derive.mechanics.bodies.modal_body import ModalFrame, ModalPoint
from derive.mechanics.bodies.section_fields import second_rotation, section_shapes, shortening_of
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.observables.motion import si_value
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.spatial_beam import SpatialBeam, cut_into

STATIONS = 13
"""The number of sections of a beam that are drawn."""
SLENDER = 60
"""A drawn beam is at least this part of its length thick."""


def section_frame(beam: SpatialBeam, name: str, at: Fraction) -> ModalFrame:
    """The section at xi = at in the floating frame of a beam."""
    shapes, length = section_shapes(beam), si_value(beam.length) / cut_into(beam)
    displacements = np.array([_at(shape.displacement, at) for shape in shapes])
    twists = np.array([_at(shape.rotation, at) for shape in shapes]) * 2 / length
    position = np.array([float(at) * length / 2, 0.0, 0.0])
    if beam.order is DisplacementOrder.FIRST_ORDER:
        return ModalFrame(ModalPoint(name, f"section at xi = {at}", position, displacements), twists)
    second = np.zeros((2, len(shapes), len(shapes), 3))
    for (i, first), (j, other) in product(enumerate(shapes), repeat=2):
        second[0, i, j] = _at({1: shortening_of(first, other, beam.frame)}, at)
        second[1, i, j] = _at(second_rotation(first, other, beam.frame), at)
    point = ModalPoint(name, f"section at xi = {at}", position, displacements, second[0] * 2 / length)
    return ModalFrame(point, twists, second[1] * (2 / length) ** 2)


def beam_frames(beam: SpatialBeam) -> dict[str, ModalFrame]:
    """The markers of a beam in its floating frame by their names."""
    return {marker.name: section_frame(beam, marker.name, marker.at) for marker in beam.markers}


def drawn_points(beam: SpatialBeam) -> tuple[Matrix, Matrix]:
    """The corners (4 STATIONS, 3), m, of square sections along the undeformed beam, and the modes there, (N, .., 3)."""
    length = si_value(beam.length) / cut_into(beam)
    radius = (2 * si_value(beam.rotary_inertia) / si_value(beam.mass)) ** 0.5
    half = max(radius / 2**0.5, length / SLENDER / 2)
    corners = np.array([[0.0, y * half, z * half] for y, z in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    positions, modes = [], []
    for k in range(STATIONS):
        frame = section_frame(beam, "", Fraction(2 * k, STATIONS - 1) - 1)
        positions.append(frame.point.position + corners)
        modes.append(frame.point.shapes[:, None] + np.cross(frame.twists[:, None], corners))
    return np.concatenate(positions), np.concatenate(modes, axis=1)


def _at(functions: Mapping[int, BeamFunction], at: Fraction) -> Vector:
    """The values of functions of xi by axes at a position."""
    return np.array([float(functions[k].at(at)) if k in functions else 0.0 for k in (1, 2, 3)])
