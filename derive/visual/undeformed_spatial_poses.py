"""The poses of the undeformed bodies of a scene in space at t = 0, with joints and drives closed, for drawings."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from derive.algebra import sp
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS, Freedom
from derive.mechanics.multibody.space.rows import RelativeFunction, row_variables
from derive.simulation.configurations import rotation_matrix
from derive.simulation.inputs import with_functions
from derive.simulation.observables.motion import drive_values, si_value
from derive.simulation.space.bent_beams import Pose
from derive.simulation.space.guess import laid_poses
from derive.simulation.space.marker_frames import MarkerFrame, frame_in_body
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.spatial_beam import SpatialBody
from derive.spec.model.spatial_scene import SpatialJoint, SpatialScene
from derive.visual.undeformed_poses import Array, closed, inputs_or_zero

FIRM = 1e-3
"""The change of a given pose over that of others where both would close a joint."""

SpatialPosesByName = Mapping[str, Pose]
"""The position (3,), m, and the rotation tensor (3, 3) of each undeformed body, and of the ground."""


def initial_spatial_poses(scene: SpatialScene) -> dict[str, Pose]:
    """The pose of each undeformed body at t = 0.

    Newton's method starts from the initial values of the specification and closes the joints with the least changes,
    which are small for given poses; drives and initial values of joints are kept. Where it finds no closed
    configuration, the poses are those that it started from. Run-time inputs without a function are zero.
    """
    scene = with_functions(replace(scene, inputs=inputs_or_zero(scene.inputs)), {})
    driven = {drive.joint: float(drive_values(drive, np.zeros(1))[0]) for drive in scene.drives}
    guess = laid_poses(scene, driven)
    names = [body.name for body in scene.bodies]
    every = [_JointRows(scene, joint, driven.get(joint.name)) for joint in scene.joints]

    def residual(changes: Array) -> Array:
        poses = _changed(guess, names, changes)
        return np.concatenate([np.zeros(0), *(rows.values(poses) for rows in every)])

    mobility = np.repeat([FIRM if _is_given(body) else 1.0 for body in scene.bodies], 6)
    return _changed(guess, names, closed(residual, np.zeros(6 * len(names)), mobility))


def _is_given(body: SpatialBody) -> bool:
    """Whether a pose is given that the initial state keeps."""
    return not body.start.guess and (body.start.position is not None or body.start.rotation is not None)


def spatial_frame(scene: SpatialScene, marker: MarkerRef, poses: SpatialPosesByName) -> MarkerFrame:
    """The frame of a marker of an undeformed body, or of the ground, in the inertial frame."""
    own, (position, Q) = frame_in_body(scene, marker), poses[marker.body]
    return MarkerFrame(position + Q @ own.position, Q @ own.axes)


def _changed(poses: SpatialPosesByName, names: list[str], changes: Array) -> dict[str, Pose]:
    """Poses after displacements and rotation vectors (6 n,) of the bodies."""
    result = {GROUND: poses[GROUND]}
    for name, change in zip(names, changes.reshape(-1, 6), strict=True):
        position, Q = poses[name]
        half = change[3:] / 2
        quaternion = np.concatenate([[np.cos(np.linalg.norm(half))], np.sinc(np.linalg.norm(half) / np.pi) * half])
        result[name] = position + change[:3], rotation_matrix(quaternion) @ Q
    return result


@dataclass(frozen=True)
class _JointRows:
    """The rows of a joint that vanish, and that of its drive with the motion `driven` at t = 0."""

    scene: SpatialScene
    joint: SpatialJoint
    driven: float | None

    def values(self, poses: SpatialPosesByName) -> Array:
        """The values (rows,) for undeformed bodies with these poses."""
        rows = [(row, 0.0) for row in SPATIAL_JOINTS[self.joint.kind].rows(self.joint)] + list(self._prescribed())
        first, second = (spatial_frame(self.scene, end, poses) for end in (self.joint.first, self.joint.second))
        length = 1.0 if self.joint.distance is None else si_value(self.joint.distance)
        lead = 1.0 if self.joint.pitch is None else si_value(self.joint.pitch) / (2 * np.pi)
        frames = (*first.position, *first.axes.ravel(), *second.position, *second.axes.ravel())
        return np.array([_function(row)(*frames, at, np.cos(at), np.sin(at), length, lead) for row, at in rows])

    def _prescribed(self) -> Iterator[tuple[RelativeFunction, float]]:
        """The rows of motions that the drive prescribes, or that are given as initial values, with these motions."""
        of, start = SPATIAL_JOINTS[self.joint.kind], self.joint.start
        given = {Freedom.ROTATION: start.angle, Freedom.DISPLACEMENT: start.displacement}
        if of.driven is not None and self.driven is not None:
            given[of.driven] = self.driven
        yield from ((freedom.row, float(at)) for freedom, at in given.items() if at is not None)


@lru_cache(64)
def _function(row: RelativeFunction) -> Callable[..., float]:
    """A row as a function of numbers: both frames, the motion of the drive with cosine and sine, length and lead."""
    of = row_variables()
    frames = (*of.first.x, *of.first.A, *of.second.x, *of.second.A)
    function: Callable[..., float] = sp.lambdify(
        [*frames, of.motion[0], of.cos, of.sin, of.length, of.lead],
        row.g,
        [{"Atan2": math.atan2, "Wrapped": lambda x, s: math.remainder(x, 2 * math.pi * s)}, "numpy"],
    )
    return function
