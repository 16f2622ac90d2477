"""Marker frames of bodies in space as numbers: those of a specification in a frame of a body, and where they are."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from derive.runtime.native_call import Matrix, Vector
from derive.simulation.configurations import rotation_matrix
from derive.simulation.observables.motion import si_value
from derive.simulation.space.poses import SpatialPoses
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.spatial_scene import FlexibleBody, FrameMarker, NodeFrame, SpatialBody, SpatialScene


@dataclass(frozen=True, eq=False)
class MarkerFrame:
    """A marker frame: its position (3,), m, and its axes (3, 3) as columns."""

    position: Vector
    axes: Matrix


def own_frame(marker: FrameMarker | NodeFrame, body: SpatialBody | None = None) -> MarkerFrame:
    """A marker in the frame of its undeformed body, or of the ground."""
    quaternion = np.array(marker.rotation)
    axes = rotation_matrix(quaternion / np.linalg.norm(quaternion))
    if isinstance(marker, NodeFrame):
        assert isinstance(body, FlexibleBody)
        return MarkerFrame(_positions(body)[marker.name], axes)
    return MarkerFrame(np.array([si_value(x) for x in marker.position]), axes)


@lru_cache(8)
def _positions(body: FlexibleBody) -> dict[str, Vector]:
    """The positions (3,), m, of the markers of an undeformed finite-element body in its floating frame."""
    from derive.reduction.frame_points import modal_frames  # only for finite-element bodies

    return {frame.point.name: frame.point.position for frame in modal_frames(body)}


def frame_in_body(scene: SpatialScene, marker: MarkerRef) -> MarkerFrame:
    """A marker in the undeformed frame of its body, or in the inertial frame."""
    if marker.body == GROUND:
        return own_frame(next(m for m in scene.ground if m.name == marker.marker))
    body = next(b for b in scene.bodies if b.name == marker.body)
    return own_frame(next(m for m in body.markers if m.name == marker.marker), body)


def frame_of(scene: SpatialScene, poses: SpatialPoses, marker: MarkerRef) -> MarkerFrame:
    """A marker in the inertial frame, of a body that is not deformed."""
    own = frame_in_body(scene, marker)
    if marker.body == GROUND:
        return own
    Q = poses.rotation(marker.body)
    return MarkerFrame(poses.position(marker.body) + Q @ own.position, Q @ own.axes)
