"""The positions of markers of a scene in motion, and deflections from chords between them."""

from __future__ import annotations

import numpy as np

from derive.mechanics.multibody.outputs.deflection import distance_from_line
from derive.simulation.observables.motion import Array, SceneMotion, body_coordinates, planar, transformed
from derive.simulation.space.marker_frames import frames_of
from derive.simulation.space.poses import SpatialPoses
from derive.spec.model.beam_pieces import located
from derive.spec.model.instances import joined
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.planar_bodies import RigidBody
from derive.spec.model.plots import Deflection
from derive.spec.model.spatial_scene import SpatialScene


def marker_positions(motion: SceneMotion, marker: MarkerRef) -> Array:
    """The positions (n, 2) or in space (n, 3), m, of a marker in the inertial frame."""
    native = motion.native
    if isinstance(motion.scene, SpatialScene):
        states = zip(motion.t, motion.q, strict=True)
        poses = (SpatialPoses(native, motion.k, float(t), q, 1.0) for t, q in states)
        frame_at = frames_of(motion.scene, native, located(motion.scene, marker))
        return np.array([frame_at(pose).position for pose in poses])
    if marker.body == GROUND:
        return np.tile(body_coordinates(planar(motion.scene), marker), (len(motion.t), 1))
    body = next(b for b in motion.scene.bodies if b.name == marker.body)
    if isinstance(body, RigidBody):
        return transformed(motion.pose(body.name), body_coordinates(planar(motion.scene), marker))
    return native.marker_positions(joined(marker.body, marker.marker), motion.q, motion.v, motion.k)


def deflection(motion: SceneMotion, quantity: Deflection) -> Array:
    """The distances (n,) of a marker from a chord (m), or their ratios to a length.

    In the plane they are positive to the left of the chord, in space they have no sign.
    """
    point, start, end = (marker_positions(motion, at) for at in (quantity.marker, *quantity.chord))
    distance: Array
    if isinstance(motion.scene, SpatialScene):
        distance = np.linalg.norm(np.cross(end - start, point - start), axis=1) / np.linalg.norm(end - start, axis=1)
    else:
        distance = distance_from_line((point.T, start.T, end.T), np.hypot)
    return distance if quantity.divided_by is None else distance / quantity.divided_by
