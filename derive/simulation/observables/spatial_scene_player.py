"""The data of the player of a scene in space: rigid and finite-element bodies with their markers and their motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from derive.mechanics.bodies.modal_body import ModalFrame
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.mechanics.multibody.space.springs import spring_type
from derive.reduction.frame_points import modal_frames
from derive.simulation.configurations import quaternion_of
from derive.simulation.observables.csv_writer import Column
from derive.simulation.observables.motion import Array, SceneMotion, si_value
from derive.simulation.observables.player_data import Plain, curves_data
from derive.simulation.observables.spatial_player_data import (
    BodyPath,
    DrawnBody,
    Tie,
    beam_drawing,
    bodies_data,
    bodies_motion_data,
    drawn_body,
    rigid_drawing,
    shown_frames,
    visual_drawing,
    with_stresses,
)
from derive.simulation.observables.stresses import amplitude_places
from derive.simulation.observables.visual_surfaces import VisualSurface, visual_surfaces
from derive.simulation.space.beam_frames import beam_frames, drawn_points
from derive.spec.model.beam_pieces import CUT
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.quantity import Quantity
from derive.spec.model.spatial_beam import SpatialBeam, SpatialBody
from derive.spec.model.spatial_bodies import FlexibleBody, SpatialRigidBody
from derive.spec.model.spatial_scene import SpatialScene


def spatial_scene_player_data(scene: SpatialScene, motion: SceneMotion, curves: Sequence[Column] = ()) -> Plain:
    """The content of the page of a motion: lengths in m, times in s.

    curves: columns with a value for each instant, which the page draws over time below the scene.
    """
    flexible = {body.name: body.body for body in scene.bodies if isinstance(body, FlexibleBody)}
    every, ground = drawn_bodies(scene), ground_points(scene)
    drawn = [with_stresses(body, flexible[body.name]) if body.name in flexible else body for body in every]
    paths = body_paths(drawn, motion)
    content = bodies_motion_data(drawn, motion.t, paths)
    shown = curves_data(curves, shown_frames(motion.t, paths))
    return {"name": scene.name, **bodies_data(drawn, ground, ties(scene)), **content, "curves": shown}


PLAYER_TRIANGLES, PICTURE_TRIANGLES = 8000, 2000
"""The largest numbers of triangles of meshes in a page that plays a motion, and in a picture."""


def drawn_bodies(scene: SpatialScene, triangles: int = PLAYER_TRIANGLES) -> list[DrawnBody]:
    """The drawings of all bodies of a scene, and behind them of the ground if it has visuals.

    All meshes have at most so many triangles together. With 0 triangles there are no visuals: rigid bodies are the
    boxes of their inertia, which have edges.
    """
    shown = {body.name: body.visuals for body in scene.bodies if triangles and isinstance(body, SpatialRigidBody)}
    of_bodies = [shown.get(body.name, ()) for body in scene.bodies]
    *surfaces, fixed = visual_surfaces([*of_bodies, scene.ground_visuals if triangles else ()], triangles)
    drawn = [_drawn(body, visuals) for body, visuals in zip(scene.bodies, surfaces, strict=True)]
    return [*drawn, visual_drawing(GROUND, fixed, ())] if fixed.faces else drawn


def ground_points(scene: SpatialScene) -> list[tuple[str, Array]]:
    """The names and places (3,), m, of the markers of the ground."""
    return [(marker.name, _vector(marker.position)) for marker in scene.ground]


def ties(scene: SpatialScene) -> list[Tie]:
    """The lines between markers: springs that act along them, and distances that joints keep."""
    numbers = {MarkerRef(GROUND, marker.name): (-1, i) for i, marker in enumerate(scene.ground)}
    for k, body in enumerate(scene.bodies):
        names = [marker.name for marker in body.markers]
        numbers |= {MarkerRef(body.name, name): (k, i) for i, name in enumerate(names)}
    springs = [spring for spring in scene.springs if spring_type(spring.kind).along_line]
    joints = [joint for joint in scene.joints if SPATIAL_JOINTS[joint.kind].keeps_distance]
    return [
        Tie(spring, (numbers[tied.first], numbers[tied.second]))
        for spring, every in ((True, springs), (False, joints))
        for tied in every
    ]


def body_paths(drawn: Sequence[DrawnBody], motion: SceneMotion) -> list[BodyPath]:
    """The motions of the frames of bodies, with their amplitudes."""
    paths = []
    for body in drawn:
        if body.name == GROUND:
            paths.append(fixed_path(len(motion.t)))
            continue
        paths.append(body_path(body.name, len(body.phi), motion))
    return paths


def body_path(name: str, modes: int, motion: SceneMotion) -> BodyPath:
    """The motion of the frame of a body with so many modes."""
    pose = motion.pose(name)
    amplitudes = motion.q[:, amplitude_places(motion.native, name, modes)]
    return BodyPath(pose[:, :3], _quaternions(pose[:, 3:]), amplitudes)


def fixed_path(instants: int) -> BodyPath:
    """The path of the ground, which does not move."""
    return BodyPath(np.zeros((instants, 3)), np.tile([1.0, 0, 0, 0], (instants, 1)), np.zeros((instants, 0)))


def _drawn(body: SpatialBody, visuals: VisualSurface) -> DrawnBody:
    if isinstance(body, FlexibleBody):
        return _with_markers(drawn_body(replace(body.body, name=body.name, markers=())), modal_frames(body))
    if isinstance(body, SpatialBeam):
        frames = [frame for frame in beam_frames(body).values() if frame.point.name not in CUT]
        return _with_markers(beam_drawing(body.name, *drawn_points(body)), frames)
    named = [(m.name, _vector(m.position)) for m in body.markers]
    if visuals.faces:
        return visual_drawing(body.name, visuals, named)
    mass = 0.0 if body.mass is None or body.inertia is None else si_value(body.mass)
    return rigid_drawing(body.name, mass, _vector(body.centre), _inertia(body), named)


def _with_markers(drawn: DrawnBody, frames: Sequence[ModalFrame]) -> DrawnBody:
    """The drawing of a body with its markers, which move with its modes."""
    points = [frame.point for frame in frames]
    if not points:
        return drawn
    x = np.concatenate([drawn.x, [point.position for point in points]])
    phi = np.concatenate([drawn.phi, *(point.shapes[:, None] for point in points)], axis=1)
    markers = tuple((point.name, len(drawn.x) + i) for i, point in enumerate(points))
    return replace(drawn, x=x, phi=phi, markers=markers)


def _inertia(body: SpatialRigidBody) -> Array:
    """The tensor of inertia (3, 3); zero where none is given."""
    xx, yy, zz, xy, xz, yz = (si_value(x) for x in body.inertia) if body.inertia else (0.0,) * 6
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _vector(position: Sequence[Quantity]) -> Array:
    return np.array([si_value(x) for x in position])


def _quaternions(rotations: Array) -> Array:
    """The quaternions (n, 4) of rotation tensors by rows (n, 9), next to each other without jumps of the sign."""
    result = np.array([quaternion_of(Q.reshape(3, 3)) for Q in rotations])
    signs = np.cumprod([1.0, *(-1.0 if a @ b < 0 else 1.0 for a, b in pairwise(result))])
    return np.asarray(result * signs[:, None])
