"""The initial values of a scene in space as targets: vectors of the configuration, and the values they should have.

Rotations are compared by rotation vectors, so that no attitude is singular.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS, Freedom
from derive.mechanics.symbols import amplitude_of
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.configurations import quaternion_of, rotation_matrix, rotation_vector
from derive.simulation.initial.targets import KeyOfTarget, Strength
from derive.simulation.observables.motion import simulated_drive
from derive.simulation.space.bent_beams import BentBody, bent_bodies, initial_curves
from derive.simulation.space.joint_targets import (
    Linearised,
    attitude,
    is_constraint,
    joint_coordinate,
    motion_of_joint,
    parallel_axes,
    rotation_of_frames,
)
from derive.simulation.space.poses import SpatialPoses
from derive.spec.model.beam_pieces import whole_beam
from derive.spec.model.spatial_beam import SpatialBeam, SpatialBody
from derive.spec.model.spatial_scene import SpatialJoint, SpatialScene


@dataclass(frozen=True, eq=False)
class SpatialTarget(KeyOfTarget):
    """A vector of the configuration and its values in SI units; with `rate` those of its time derivative.

    table, key: its table and key in the specification. angular: whether it counts in rad, not m. linearised: the
    deviations in a configuration; of a rate without the velocities, as `rate` then adds their products. body: that of
    the rotation of a body. guessable: whether its table may say that it is a first guess.
    """

    table: str
    key: str
    values: tuple[float, ...]
    strength: Strength
    angular: bool
    rate: bool
    linearised: Callable[[SpatialPoses], Linearised]
    amplitudes: tuple[int, ...] = ()
    body: str = ""
    guessable: bool = True

    def rotation(self) -> Matrix:
        """The rotation matrix (3, 3) of a rotation, whose values are those of a quaternion."""
        quaternion = np.array(self.values)
        return rotation_matrix(quaternion / np.linalg.norm(quaternion))


def spatial_targets(scene: SpatialScene, native: NativeScene) -> tuple[SpatialTarget, ...]:
    """All targets of a scene: what it gives or guesses of bodies, joints and drives, and defaults of the positions."""
    result = [target for body in scene.bodies for target in _of_body(body, native)]
    joints = {joint.name: joint for joint in scene.joints}
    for joint in scene.joints:
        result += _of_joint(scene, joint, joint, f"joints.{joint.name}.start", native)
        if parallel_axes(joint) and is_constraint(joint, native):
            # rotations are products of axes, which vanish for some that are reversed or exchanged as well
            table, function = f"joints.{joint.name}", attitude(scene, joint)
            target = SpatialTarget(table, "between", (0.0,) * 3, Strength.GIVEN, True, False, function, guessable=False)
            result.append(target)
    for drive in scene.drives:
        joint = joints[drive.joint]
        result += _of_joint(scene, joint, drive, f"drives.{drive.name}.start", native)
        freedom = SPATIAL_JOINTS[joint.kind].driven
        if freedom is Freedom.ROTATION and joint_coordinate(scene, joint, freedom, native) is None:
            # the constraint of the drive is the sine of the difference, which is zero half a turn away as well
            key = "motion" if drive.speed is None else "speed"
            value = float(simulated_drive(native, drive, np.zeros(1))[0])
            function = rotation_of_frames(scene, joint, value, False)
            table = f"drives.{drive.name}"
            result.append(SpatialTarget(table, key, (value,), Strength.GIVEN, True, False, function, guessable=False))
    return tuple(result)


def _of_body(body: SpatialBody, native: NativeScene) -> Iterator[SpatialTarget]:
    """The targets of a body; those of a beam in pieces belong to its first piece, and are means over all."""
    of = body
    if isinstance(body, SpatialBeam) and body.piece_of is not None:
        if body.piece_of.number:
            return
        of = whole_beam(body)
    bodies = bent_bodies(body)
    start, table = of.start, f"bodies.{of.name}.start"
    given = Strength.GUESS if start.guess else Strength.GIVEN
    if start.position is not None:
        function = _mean(bodies, partial(_position, value=np.array(start.position)))
        yield SpatialTarget(table, "position", start.position, given, False, False, function)
    if start.rotation is not None:
        quaternion = np.array(start.rotation)
        reference = rotation_matrix(quaternion / np.linalg.norm(quaternion))
        function = _mean(bodies, partial(_rotation, reference=reference))
        yield SpatialTarget(table, "rotation", start.rotation, given, True, False, function, body=bodies[0].name)
    for key, values in (("amplitudes", start.amplitudes), ("amplitude_rates", start.amplitude_rates)):
        amplitudes = [(body.name, i, value) for i, value in enumerate(values or ())]
        yield from _amplitudes(native, table, key, amplitudes, given, key == "amplitude_rates")
    for curve in initial_curves(of) if isinstance(of, SpatialBeam) else ():
        amplitudes = [(bent.name, *each) for k, bent in enumerate(bodies) for each in curve.amplitudes(k)]
        yield from _amplitudes(native, table, curve.key, amplitudes, given, curve.rate)
    if start.velocity is not None:
        function = _mean(bodies, partial(_twist, part=slice(0, 3), value=np.array(start.velocity)))
        yield SpatialTarget(table, "velocity", start.velocity, given, False, True, function)
    if start.angular_velocity is not None:
        function = _mean(bodies, partial(_twist, part=slice(3, 6), value=np.array(start.angular_velocity)))
        yield SpatialTarget(table, "angular_velocity", start.angular_velocity, given, True, True, function)


def _amplitudes(
    native: NativeScene,
    table: str,
    key: str,
    amplitudes: Sequence[tuple[str, int, float]],
    strength: Strength,
    rate: bool,
) -> Iterator[SpatialTarget]:
    """The target of amplitudes, or of their rates, which are given with the names of bodies and numbers from 0."""
    if not amplitudes:
        return
    columns = [native.velocities.index(amplitude_of(body, i + 1, 1).name) for body, i, _ in amplitudes]
    places = [native.coordinates.index(amplitude_of(body, i + 1).shown) for body, i, _ in amplitudes]
    values = tuple(value for _, _, value in amplitudes)

    def linearised(poses: SpatialPoses) -> Linearised:
        gradient = np.zeros((len(columns), poses.native.nv))
        gradient[np.arange(len(columns)), columns] = 1.0
        now = np.zeros(len(values)) if rate else poses.q[places]
        return now - np.array(values), gradient, np.zeros(len(values))

    yield SpatialTarget(table, key, values, strength, False, rate, linearised, tuple(columns))


def _mean(
    bodies: tuple[BentBody, ...], of_body: Callable[[SpatialPoses, BentBody], Linearised]
) -> Callable[[SpatialPoses], Linearised]:
    """The mean of a vector over some bodies."""

    def linearised(poses: SpatialPoses) -> Linearised:
        every = [of_body(poses, body) for body in bodies]
        deviation, gradient, drift = (np.mean(of, axis=0) for of in zip(*every, strict=True))
        return deviation, gradient, drift

    return linearised


def _position(poses: SpatialPoses, body: BentBody, value: Vector) -> Linearised:
    twist, drift = body.twist(poses)
    return body.position(poses) - value, twist[:3], drift[:3]


def _rotation(poses: SpatialPoses, body: BentBody, reference: Matrix) -> Linearised:
    twist, drift = body.twist(poses)
    return rotation_vector(quaternion_of(reference.T @ body.axes(poses))), twist[3:], drift[3:]


def _twist(poses: SpatialPoses, body: BentBody, part: slice, value: Vector) -> Linearised:
    twist, drift = body.twist(poses)
    return drift[part] - value, twist[part], drift[part]


# ---- joints and drives ----


def _of_joint(
    scene: SpatialScene, joint: SpatialJoint, of: object, table: str, native: NativeScene
) -> Iterator[SpatialTarget]:
    start, joint_type = of.start, SPATIAL_JOINTS[joint.kind]  # type: ignore[attr-defined]
    strength = Strength.GUESS if start.guess else Strength.GIVEN
    for motion in joint_type.starts(joint_type.removed(joint)):
        rates = [motion.rate, *(["speed"] if motion.freedom is joint_type.driven else [])]
        for key, rate in ((motion.key, False), *((name, True) for name in rates)):
            given = getattr(start, key, None)
            if given is not None:
                values = given if isinstance(given, tuple) else (given,)
                function = motion_of_joint(scene, joint, motion, values, rate, native)
                angular = motion.freedom is Freedom.ROTATION
                yield SpatialTarget(table, key, values, strength, angular, rate, function)
