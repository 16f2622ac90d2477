"""The positions of markers of a scene in motion, and deflections from chords between them."""

from __future__ import annotations

import numpy as np

from derive.mechanics.multibody.outputs.deflection import distance_from_line
from derive.simulation.observables.motion import Array, SceneMotion, body_coordinates, planar, transformed
from derive.spec.model.instances import joined
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.plots import Deflection
from derive.spec.model.scene import RigidBody


def marker_positions(motion: SceneMotion, marker: MarkerRef) -> Array:
    """The positions (n, 2), m, of a marker in the inertial frame."""
    native = motion.native
    if marker.body == GROUND:
        return np.tile(body_coordinates(planar(motion.scene), marker), (len(motion.t), 1))
    body = next(b for b in motion.scene.bodies if b.name == marker.body)
    if isinstance(body, RigidBody):
        return transformed(motion.pose(body.name), body_coordinates(planar(motion.scene), marker))
    return native.marker_positions(joined(marker.body, marker.marker), motion.q, motion.v, motion.k)


def deflection(motion: SceneMotion, quantity: Deflection) -> Array:
    """The distances (n,) of a marker from a chord (m), positive to its left, or their ratios to a length."""
    points = (marker_positions(motion, at).T for at in (quantity.marker, *quantity.chord))
    distance: Array = distance_from_line(points, np.hypot)
    return distance if quantity.divided_by is None else distance / quantity.divided_by
