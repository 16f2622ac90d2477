"""The positions of markers of a scene in motion, and deflections from chords between them."""

from __future__ import annotations

import numpy as np

from derive.mechanics.multibody.outputs.deflection import distance_from_line
from derive.simulation.observables.beams import axis_points, piece_at, piece_names
from derive.simulation.observables.motion import Array, SceneMotion, body_coordinates, transformed
from derive.spec.model.instances import identifier
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.plots import Deflection
from derive.spec.model.scene import BeamBody, RigidBody


def marker_positions(motion: SceneMotion, marker: MarkerRef) -> Array:
    """The positions (n, 2), m, of a marker in the inertial frame."""
    native = motion.native
    if marker.body == GROUND:
        return np.tile(body_coordinates(motion.scene, marker), (len(motion.t), 1))
    body = next(b for b in motion.scene.bodies if b.name == marker.body)
    if isinstance(body, RigidBody):
        return transformed(motion.pose(body.name), body_coordinates(motion.scene, marker))
    name = identifier(marker.body, marker.marker)
    if isinstance(body, BeamBody) and name not in native.markers:  # code with loops over many bodies has none
        piece, xi = piece_at(body, next(m.at for m in body.beam.markers if m.name == marker.marker))
        return axis_points(motion, body, piece_names(body)[piece], np.array([xi]))[:, 0]
    return native.marker_positions(name, motion.q, motion.v, motion.k)


def deflection(motion: SceneMotion, quantity: Deflection) -> Array:
    """The distances (n,) of a marker from a chord (m), positive to its left, or their ratios to a length."""
    points = (marker_positions(motion, at).T for at in (quantity.marker, *quantity.chord))
    distance: Array = distance_from_line(points, np.hypot)
    return distance if quantity.divided_by is None else distance / quantity.divided_by
