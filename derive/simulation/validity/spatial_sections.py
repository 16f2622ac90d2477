"""The sections of beams in space that something acts on, and the planes in which joints hold their ends.

A beam in pieces has the markers of its pieces; places are those of the whole beam.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

import numpy as np

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.mechanics.multibody.space.springs import spring_type
from derive.simulation.configurations import rotation_matrix
from derive.spec.model.beam_pieces import whole_beam
from derive.spec.model.markers import MarkerRef
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_beam_parts import SectionFrame
from derive.spec.model.spatial_scene import SpatialJoint, SpatialScene

ROTATIONS = ("rx", "ry", "rz")
ALONG = 0.9
"""The cosine from which on a free axis of a joint is that about which a beam bends."""
NORMALS = {1: 1, 2: 3, 3: 2}
"""The axes about which beams bend that deflect along an axis; about the first one they twist."""


def beam_markers(scene: SpatialScene, beam: str) -> dict[MarkerRef, tuple[Fraction, SectionFrame]]:
    """The markers of a beam, also of its pieces, with their places on the whole beam."""
    result = {}
    for body in scene.bodies:
        if isinstance(body, SpatialBeam) and whole_beam(body).name == beam:
            n, number = (body.pieces, body.piece_of.number) if body.piece_of else (1, 0)
            for m in body.markers:
                result[MarkerRef(body.name, m.name)] = ((m.at + 2 * number + 1) / n - 1, m)
    return result


def loaded_places(scene: SpatialScene, beam: str) -> Mapping[Fraction, MarkerRef]:
    """The places of a beam at which a joint, a force, a torque or a spring acts, each with a marker there."""
    markers, acting = beam_markers(scene, beam), {*_loaded(scene)}
    return {at: marker for marker, (at, _) in markers.items() if marker in acting}


def turned_places(scene: SpatialScene, beam: str) -> Mapping[Fraction, MarkerRef]:
    """The places of a beam at which a torque can act about an axis across it."""
    markers = beam_markers(scene, beam)
    joints = (j for j in _outer(scene) if {*SPATIAL_JOINTS[j.kind].removed(j)} & {*ROTATIONS})
    turned = {*_turned(scene)} | {marker for j in joints for marker in (j.first, j.second)}
    return {at: marker for marker, (at, _) in markers.items() if marker in turned}


def held_in_plane(scene: SpatialScene, beam: str, axis: int) -> tuple[Fraction, ...]:
    """The ends of a beam at which a torque can act that bends it along an axis."""
    places, normal = set(), np.eye(3)[NORMALS[axis] - 1]
    turned = {*_turned(scene)}
    for marker, (at, frame) in beam_markers(scene, beam).items():
        joints = (j for j in _outer(scene) if marker in (j.first, j.second))
        axes = rotation_matrix(np.array(frame.rotation, dtype=float))
        if abs(at) == 1 and (marker in turned or any(_holds(_held(scene, j), axes, normal) for j in joints)):
            places.add(at)
    return tuple(sorted(places))


def _held(scene: SpatialScene, joint: SpatialJoint) -> frozenset[str]:
    """The rotations that a joint, or its drive, prevents; of a joint that leaves more than one, none is known."""
    removed = {*SPATIAL_JOINTS[joint.kind].removed(joint)} & {*ROTATIONS}
    if any(drive.joint == joint.name for drive in scene.drives):
        removed |= {"rz"} if len(removed) == len(ROTATIONS) - 1 else set()
    return frozenset(removed) if len(removed) >= len(ROTATIONS) - 1 else frozenset()


def _holds(held: frozenset[str], axes: np.ndarray, normal: np.ndarray) -> bool:
    """Whether a joint prevents rotations about a normal; axes: those of its marker in the frame of the beam."""
    free = [axes[:, k] for k, name in enumerate(ROTATIONS) if name not in held]
    return bool(held) and not any(abs(axis @ normal) > ALONG * np.linalg.norm(axis) for axis in free)


def _outer(scene: SpatialScene) -> Iterator[SpatialJoint]:
    """The joints but for those that weld the pieces of a beam together."""
    beams = {body.name: whole_beam(body).name for body in scene.bodies if isinstance(body, SpatialBeam)}
    for joint in scene.joints:
        ends = [beams.get(end.body) for end in (joint.first, joint.second)]
        if ends[0] is None or ends[0] != ends[1]:
            yield joint


def _loaded(scene: SpatialScene) -> Iterator[MarkerRef]:
    for action in (*scene.forces, *scene.torques, *scene.springs):
        yield from scene.markers_of(action)
    for joint in _outer(scene):
        yield from (joint.first, joint.second)


def _turned(scene: SpatialScene) -> Iterator[MarkerRef]:
    """The markers at which torques and springs can turn a beam."""
    for torque in scene.torques:
        yield from scene.markers_of(torque)
    for spring in scene.springs:
        if not spring_type(spring.kind).along_line:
            yield from spring.markers
