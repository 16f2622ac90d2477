"""Marker frames of bodies in space as numbers: those of a specification in a frame of a body, and where they are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from derive.mechanics.bodies.modal_body import ModalFrame
from derive.mechanics.symbols import amplitude_of
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.configurations import rotation_matrix
from derive.simulation.observables.motion import si_value
from derive.simulation.space.beam_frames import beam_frames
from derive.simulation.space.poses import SpatialPoses
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.spatial_beam import SpatialBeam, SpatialBody
from derive.spec.model.spatial_beam_parts import SectionFrame
from derive.spec.model.spatial_bodies import FlexibleBody, FrameMarker, NodeFrame
from derive.spec.model.spatial_scene import SpatialScene


@dataclass(frozen=True, eq=False)
class MarkerFrame:
    """A marker frame: its position (3,), m, and its axes (3, 3) as columns."""

    position: Vector
    axes: Matrix


def own_frame(marker: FrameMarker | NodeFrame | SectionFrame, body: SpatialBody | None = None) -> MarkerFrame:
    """A marker in the frame of its undeformed body, or of the ground."""
    quaternion = np.array(marker.rotation)
    axes = rotation_matrix(quaternion / np.linalg.norm(quaternion))
    if not isinstance(marker, FrameMarker):
        assert isinstance(body, (FlexibleBody, SpatialBeam))
        return MarkerFrame(modal_frames_of(body)[marker.name].point.position, axes)
    return MarkerFrame(np.array([si_value(x) for x in marker.position]), axes)


@lru_cache(8)
def modal_frames_of(body: FlexibleBody | SpatialBeam) -> dict[str, ModalFrame]:
    """The markers of a flexible body in its floating frame by their names."""
    if isinstance(body, SpatialBeam):
        return beam_frames(body)
    from derive.reduction.frame_points import modal_frames  # only for finite-element bodies

    return {frame.point.name: frame for frame in modal_frames(body)}


def frame_in_body(scene: SpatialScene, marker: MarkerRef) -> MarkerFrame:
    """A marker in the undeformed frame of its body, or in the inertial frame."""
    if marker.body == GROUND:
        return own_frame(next(m for m in scene.ground if m.name == marker.marker))
    body = next(b for b in scene.bodies if b.name == marker.body)
    return own_frame(next(m for m in body.markers if m.name == marker.marker), body)


def frame_of(scene: SpatialScene, poses: SpatialPoses, marker: MarkerRef) -> MarkerFrame:
    """A marker in the inertial frame, on a body that is deformed by its amplitudes."""
    return frames_of(scene, poses.native, marker)(poses)


def frames_of(scene: SpatialScene, native: NativeScene, marker: MarkerRef) -> Callable[[SpatialPoses], MarkerFrame]:
    """The function of poses that gives a marker in the inertial frame, for many of them: see `frame_of`."""
    own = frame_in_body(scene, marker)
    if marker.body == GROUND:
        return lambda _: own
    deforming = _deforming_marker(scene, native, marker)

    def at(poses: SpatialPoses) -> MarkerFrame:
        frame = own if deforming is None else deforming.at(poses.q).frame
        Q = poses.rotation(marker.body)
        return MarkerFrame(poses.position(marker.body) + Q @ frame.position, Q @ frame.axes)

    return at


@dataclass(frozen=True, eq=False)
class DeformedFrame:
    """A marker in the frame of its deformed body, and how it moves there with the amplitudes.

    columns (N,): the velocities of the amplitudes among those of the scene. moves (3, N): the velocity of the marker,
    and turns (3, N), rad/m: its angular velocity, both for a unit rate of each amplitude.
    """

    frame: MarkerFrame
    columns: tuple[int, ...]
    moves: Matrix
    turns: Matrix


def deformed_frame(scene: SpatialScene, poses: SpatialPoses, marker: MarkerRef) -> DeformedFrame | None:
    """A marker of a flexible body in its floating frame; None for a marker of another body."""
    deforming = _deforming_marker(scene, poses.native, marker)
    return None if deforming is None else deforming.at(poses.q)


@dataclass(frozen=True, eq=False)
class _DeformingMarker:
    """A marker of a flexible body: how it moves with the amplitudes, and its axes without them.

    places: the amplitudes among the coordinates. columns: their velocities among those of the scene.
    """

    of: ModalFrame
    axes: Matrix
    places: Sequence[int]
    columns: tuple[int, ...]

    def at(self, q: Vector) -> DeformedFrame:
        """The marker at these coordinates (nq,) of the scene."""
        of, point, alpha = self.of, self.of.point, q[self.places]
        bent = np.zeros_like(point.shapes) if point.second is None else np.einsum("j,ijk->ik", alpha, point.second)
        position = point.position + alpha @ (point.shapes + bent / 2)
        bent_twists = 0 * of.twists if of.second_twists is None else np.einsum("j,ijk->ik", alpha, of.second_twists)
        theta = alpha @ (of.twists + bent_twists / 2)
        tangents = of.twists + bent_twists
        p = np.array([1.0, *(theta / 2)])
        turns = (tangents + np.cross(theta, tangents) / 2) / (p @ p)
        frame = MarkerFrame(position, rotation_matrix(p / np.linalg.norm(p)) @ self.axes)
        return DeformedFrame(frame, self.columns, (point.shapes + bent).T, turns.T)


def _deforming_marker(scene: SpatialScene, native: NativeScene, marker: MarkerRef) -> _DeformingMarker | None:
    """A marker of a flexible body; None for a marker of another body."""
    body = next((b for b in scene.bodies if b.name == marker.body), None)
    if not isinstance(body, (FlexibleBody, SpatialBeam)):
        return None
    of = modal_frames_of(body)[marker.marker]
    modes = range(1, len(of.point.shapes) + 1)
    places = [native.coordinates.index(amplitude_of(body.name, i).shown) for i in modes]
    columns = tuple(native.velocities.index(amplitude_of(body.name, i, 1).shown) for i in modes)
    return _DeformingMarker(of, frame_in_body(scene, marker).axes, places, columns)
