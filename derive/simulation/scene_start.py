"""The initial state and the size of a scene, in the plane or in space."""

from __future__ import annotations

from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.initial.initial_state import InitialState, initial_state, scene_size
from derive.simulation.space.initial_state import spatial_scene_size, spatial_scene_state
from derive.spec.model.beam_pieces import in_pieces
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene


def state_of(scene: AnyScene, native: NativeScene, k: Vector | None = None) -> InitialState:
    """The initial state at t = 0; see `initial_state` and `spatial_scene_state`."""
    if isinstance(scene, SpatialScene):
        return spatial_scene_state(in_pieces(scene), native, k)
    return initial_state(scene, native, k)


def size_of(scene: AnyScene) -> float:
    """The diagonal (m) of the box around all markers, with bodies where they start; 1 of a point."""
    return spatial_scene_size(in_pieces(scene)) if isinstance(scene, SpatialScene) else scene_size(scene)
