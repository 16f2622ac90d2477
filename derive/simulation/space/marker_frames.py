"""Marker frames of bodies in space as numbers: those of a specification in a frame of a body, and where they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from derive.runtime.native_call import Matrix, Vector
from derive.simulation.configurations import rotation_matrix
from derive.simulation.observables.motion import si_value
from derive.simulation.space.poses import SpatialPoses
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.spatial_scene import FrameMarker, SpatialScene


@dataclass(frozen=True, eq=False)
class MarkerFrame:
    """A marker frame: its position (3,), m, and its axes (3, 3) as columns."""

    position: Vector
    axes: Matrix


def own_frame(marker: FrameMarker) -> MarkerFrame:
    """A marker in the frame of its body."""
    quaternion = np.array(marker.rotation)
    return MarkerFrame(
        np.array([si_value(x) for x in marker.position]), rotation_matrix(quaternion / np.linalg.norm(quaternion))
    )


def frame_in_body(scene: SpatialScene, marker: MarkerRef) -> MarkerFrame:
    """A marker in the undeformed frame of its body, or in the inertial frame."""
    of = scene.ground if marker.body == GROUND else next(b for b in scene.bodies if b.name == marker.body).markers
    return own_frame(next(m for m in of if m.name == marker.marker))


def frame_of(scene: SpatialScene, poses: SpatialPoses, marker: MarkerRef) -> MarkerFrame:
    """A marker in the inertial frame, of a body that is not deformed."""
    own = frame_in_body(scene, marker)
    if marker.body == GROUND:
        return own
    Q = poses.rotation(marker.body)
    return MarkerFrame(poses.position(marker.body) + Q @ own.position, Q @ own.axes)
