"""The initial state, the steady motion next to it, and the size of a scene, in the plane or in space."""

from __future__ import annotations

from dataclasses import replace

from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.initial.initial_state import InitialState, initial_state, scene_size
from derive.simulation.initial.targets import targets
from derive.simulation.linear.steady_motion import SteadyMotion, steady_motion
from derive.simulation.space.initial_state import spatial_scene_size, spatial_scene_state
from derive.simulation.space.targets import spatial_targets
from derive.spec.model.beam_pieces import in_pieces
from derive.spec.model.scene import EQUILIBRIUM, STEADY
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene


def state_of(scene: AnyScene, native: NativeScene, k: Vector | None = None) -> InitialState:
    """The initial state at t = 0; see `initial_state` and `spatial_scene_state`."""
    if isinstance(scene, SpatialScene):
        return spatial_scene_state(in_pieces(scene), native, k)
    return initial_state(scene, native, k)


def steady_motion_of(scene: AnyScene, native: NativeScene, k: Vector, near: Vector | None = None) -> SteadyMotion:
    """The steady motion with the rigid velocities of the initial state, next to it or to a configuration near (nq,).

    Raises SimulationError where there is none.
    """
    if not isinstance(scene, SpatialScene):
        start = initial_state(scene, native, k)
        return steady_motion(native, k, start.q, start.v, near)
    if near is None and scene.start == EQUILIBRIUM:
        near = spatial_scene_state(scene, native, k).q
    steady = spatial_scene_state(replace(scene, start=STEADY), native, k, near).steady
    assert steady is not None
    return steady


def units_of_initial_values(scene: AnyScene, native: NativeScene) -> dict[str, str]:
    """The units of initial values by their keys, also of the elements of vectors."""
    if not isinstance(scene, SpatialScene):
        return {target.name: target.unit for target in targets(scene, native)}
    every = spatial_targets(scene, native)
    elements = {f"{target.path}[{i}]": target.unit for target in every for i in range(len(target.values))}
    return elements | {target.path: target.unit for target in every}


def size_of(scene: AnyScene) -> float:
    """The diagonal (m) of the box around all markers, with bodies where they start; 1 of a point."""
    return spatial_scene_size(in_pieces(scene)) if isinstance(scene, SpatialScene) else scene_size(scene)
