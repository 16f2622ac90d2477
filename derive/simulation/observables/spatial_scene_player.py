"""The data of the player of a scene in space, as plain data: its bodies with their markers, and their motion."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from derive.simulation.configurations import quaternion_of
from derive.simulation.observables.csv_writer import Column
from derive.simulation.observables.motion import Array, SceneMotion, si_value
from derive.simulation.observables.player_data import Plain, curves_data
from derive.simulation.observables.spatial_player_data import (
    BodyPath,
    DrawnBody,
    bodies_data,
    bodies_motion_data,
    rigid_drawing,
    shown_frames,
)
from derive.spec.model.spatial_scene import FrameMarker, SpatialRigidBody, SpatialScene


def spatial_scene_player_data(scene: SpatialScene, motion: SceneMotion, curves: Sequence[Column] = ()) -> Plain:
    """The content of the page of a motion: lengths in m, times in s.

    curves: columns with a value for each instant, which the page draws over time below the scene.
    """
    drawn = [drawn_rigid_body(body) for body in scene.bodies]
    paths = [_path(motion.pose(body.name)) for body in scene.bodies]
    return {
        "name": scene.name,
        **bodies_data(drawn, _placed(scene.ground)),
        **bodies_motion_data(drawn, motion.t, paths),
        "curves": curves_data(curves, shown_frames(motion.t, paths)),
    }


def drawn_rigid_body(body: SpatialRigidBody) -> DrawnBody:
    """The drawing of a rigid body: the box of its inertia, and lines to its markers."""
    centre = np.array([si_value(x) for x in body.centre])
    mass = 0.0 if body.mass is None or body.inertia is None else si_value(body.mass)
    inertia = np.zeros((3, 3))
    if mass and body.inertia is not None:
        xx, yy, zz, xy, xz, yz = map(si_value, body.inertia)
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return rigid_drawing(body.name, mass, centre, inertia, _placed(body.markers))


def _placed(markers: Sequence[FrameMarker]) -> list[tuple[str, Array]]:
    return [(marker.name, np.array([si_value(x) for x in marker.position])) for marker in markers]


def _path(poses: Array) -> BodyPath:
    """The path of a body without amplitudes from its poses (n, 12)."""
    return BodyPath(poses[:, :3], quaternions(poses[:, 3:]), np.zeros((len(poses), 0)))


def quaternions(rotations: Array) -> Array:
    """The quaternions (n, 4) of rotation tensors by rows (n, 9), next to each other without jumps of the sign."""
    result = np.array([quaternion_of(Q.reshape(3, 3)) for Q in rotations])
    signs = np.cumprod([1.0, *(-1.0 if a @ b < 0 else 1.0 for a, b in pairwise(result))])
    return np.asarray(result * signs[:, None])
