"""The first guess of a configuration in space: rough values, and bodies laid next to each other by their joints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS, Freedom
from derive.mechanics.multibody.space.rows import ROTATIONS
from derive.mechanics.symbols import Family, Identity, amplitude_of
from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.configurations import quaternion_of, rotation_matrix
from derive.simulation.observables.motion import si_value, simulated_drive
from derive.simulation.space.bent_beams import Pose, bent_bodies, initial_amplitudes
from derive.simulation.space.marker_frames import MarkerFrame, frame_in_body
from derive.simulation.space.poses import SpatialPoses
from derive.spec.model.markers import GROUND
from derive.spec.model.spatial_beam import SpatialBody
from derive.spec.model.spatial_bodies import SpatialRigidBody
from derive.spec.model.spatial_scene import SpatialJoint, SpatialScene

MAX_MODES = 200
TRIALS = 16
"""The number of rotations that are tried for the coordinate of a joint, from half a turn back on."""


def guessed_configuration(scene: SpatialScene, native: NativeScene, k: Vector, size: float) -> Vector:
    """A configuration (nq,) near what is given or guessed of bodies and joints."""
    q = np.zeros(native.nq)
    driven = {d.joint: float(simulated_drive(native, d, np.zeros(1))[0]) for d in scene.drives}
    wanted = laid_poses(scene, driven)
    names = {name: i for i, name in enumerate(native.coordinates)}
    for body in scene.bodies:
        own = [names[name] for name in _possible(body) if name in names]
        quaternion = [i for i in own if native.roles[i] is Role.QUATERNION]
        translation = [i for i in own if native.roles[i] is Role.TRANSLATION]
        bent = {of.name: of for of in bent_bodies(body)}[body.name]
        position, Q = bent.body_frame(wanted[body.name])
        if quaternion:
            q[quaternion] = quaternion_of(Q)
        if translation:
            q[translation] = position + Q @ _origin(body)
        amplitudes = [i for i in own if native.roles[i] is Role.AMPLITUDE]
        given = body.start.amplitudes or ()
        q[amplitudes[: len(given)]] = given
        for number, value in initial_amplitudes(body):
            q[amplitudes[number]] = value
    for body in scene.bodies:  # fitted with the poses of all bodies, which need their quaternions
        own = [names[name] for name in _possible(body) if name in names]
        single = [i for i in own if native.roles[i] in (Role.ROTATION, Role.DISPLACEMENT)]
        if single and (body.start.position or body.start.rotation):
            q = _fitted(native, k, q, single, body.name, wanted[body.name], size)
    return q


def _possible(body: SpatialBody) -> Iterator[str]:
    """The names that coordinates of a body may have, whichever joints leave."""
    axes = (1, 2, 3)
    families: list[tuple[Family, tuple[tuple[int, ...], ...]]] = [
        (Family.TRANSLATION, tuple((k,) for k in axes)),
        (Family.QUATERNION, tuple((k,) for k in (0, *axes))),
        (Family.ANGLE, ((), *((k,) for k in axes))),
        (Family.GUIDE, ((), *((k,) for k in axes))),
    ]
    for family, components in families:
        yield from (Identity(family, components=tuple(of), owner=body.name).shown for of in components)
    yield from (amplitude_of(body.name, i).shown for i in range(1, MAX_MODES + 1))


def _origin(body: SpatialBody) -> Vector:
    """The origin O of a body that keeps its coordinates, in its body frame: the centre of mass of a rigid one."""
    if isinstance(body, SpatialRigidBody):
        return np.array([si_value(x) for x in body.centre])
    return np.zeros(3)


def _fitted(
    native: NativeScene, k: Vector, q: Vector, single: list[int], body: str, wanted: Pose, size: float
) -> Vector:
    """The configuration with coordinates of a joint that bring a body nearest to a pose, one after the other."""

    def distance(trial: Vector) -> float:
        poses = SpatialPoses(native, k, 0.0, trial, size)
        moved = (poses.position(body) - wanted[0]) / size
        return float(moved @ moved + np.sum((poses.rotation(body) - wanted[1]) ** 2))

    for i in single * 2:
        if native.roles[i] is Role.ROTATION:
            trials = [q[i] + 2 * np.pi * n / TRIALS for n in range(-TRIALS // 2, TRIALS // 2)]
        else:
            unit = np.eye(native.nq)[i]
            base = distance(q)
            slope = (distance(q + size * unit) - distance(q - size * unit)) / 2
            curvature = (distance(q + size * unit) + distance(q - size * unit) - 2 * base) / 2
            trials = [q[i], q[i] - size * slope / (2 * curvature)] if curvature > 0 else [q[i]]
        states = [np.where(np.arange(native.nq) == i, value, q) for value in trials]
        q = min(states, key=distance)
    return q


JointGuess = tuple[float, Vector]
"""The rotation about z, rad, and the displacements (3,), m, of the second marker of a joint against the first."""


def _joint_start(joint: SpatialJoint, driven: float | None) -> JointGuess:
    """The motion of a joint at t = 0 that is given or prescribed, else zero."""
    joint_type, start = SPATIAL_JOINTS[joint.kind], joint.start
    x, y = start.displacements or (0.0, 0.0)
    angle, along = start.angle or 0.0, start.displacement or 0.0
    if driven is not None and joint_type.driven is Freedom.ROTATION:
        angle = driven
    elif driven is not None:
        along = driven
    if joint.pitch is not None:
        along = angle * si_value(joint.pitch) / (2 * np.pi)
    return angle, np.array([x, y, along])


def laid_poses(scene: SpatialScene, driven: Mapping[str, float]) -> dict[str, Pose]:
    """The pose of each body that is given, guessed, or such that it meets joints to bodies with a pose.

    driven: the motions of joints with a drive at t = 0, by their names.
    """
    starts = {joint.name: _joint_start(joint, driven.get(joint.name)) for joint in scene.joints}
    poses: dict[str, Pose] = {GROUND: (np.zeros(3), np.eye(3))}
    waiting = {body.name: body for body in scene.bodies}
    for body in scene.bodies:
        if body.start.position is not None and body.start.rotation is not None:
            poses[body.name] = np.array(body.start.position), _matrix(body.start.rotation)
            del waiting[body.name]
    while waiting:
        name, pose = next(_laid(scene, poses, waiting, starts), (next(iter(waiting)), None))
        poses[name] = pose or _alone(waiting[name])
        del waiting[name]
    return poses


def _alone(body: SpatialBody) -> Pose:
    start = body.start
    rotation = np.eye(3) if start.rotation is None else _matrix(start.rotation)
    return np.array(start.position or (0.0, 0.0, 0.0)), rotation


def _matrix(quaternion: tuple[float, ...]) -> Matrix:
    return rotation_matrix(np.array(quaternion) / np.linalg.norm(quaternion))


def _laid(
    scene: SpatialScene, poses: dict[str, Pose], waiting: dict[str, SpatialBody], starts: Mapping[str, JointGuess]
) -> Iterator[tuple[str, Pose]]:
    """The bodies that a joint lays next to a body with a pose; values of a start take precedence.

    Joints that remove rotations come first. A body that hangs on others is not turned.
    """
    for joint in sorted(scene.joints, key=lambda joint: not _removes_rotations(joint)):
        for known, own in ((joint.first, joint.second), (joint.second, joint.first)):
            if known.body not in poses or own.body not in waiting:
                continue
            position, Q = poses[known.body]
            at, mine = frame_in_body(scene, known), frame_in_body(scene, own)
            frame = MarkerFrame(position + Q @ at.position, Q @ at.axes)
            start = waiting[own.body].start
            angle, moved = starts[joint.name]
            if own is joint.second:
                axes, at_joint = frame.axes @ _about_z(angle), frame.position + frame.axes @ moved
            else:
                axes = frame.axes @ _about_z(-angle)
                at_joint = frame.position - axes @ moved
            if start.rotation is not None:
                rotation = _matrix(start.rotation)
            else:
                rotation = axes @ mine.axes.T if _removes_rotations(joint) else np.eye(3)
            origin = at_joint - rotation @ mine.position if start.position is None else np.array(start.position)
            yield own.body, (origin, rotation)


def _removes_rotations(joint: SpatialJoint) -> bool:
    removed = SPATIAL_JOINTS[joint.kind].removed(joint)
    return any(name in removed for name in ROTATIONS)


def _about_z(angle: float) -> Matrix:
    """The rotation matrix about z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
