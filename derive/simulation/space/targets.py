"""The initial values of a scene in space as targets: vectors of the configuration, and the values they should have.

Rotations are compared by rotation vectors, so that no attitude is singular.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS, Freedom
from derive.mechanics.symbols import Family, amplitude, owned, quantity
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.configurations import rotation_matrix
from derive.simulation.initial.targets import Strength
from derive.simulation.observables.motion import simulated_drive
from derive.simulation.space.marker_frames import deformed_frame, frame_of
from derive.simulation.space.poses import SpatialPoses
from derive.spec.model.instances import identifier, joined
from derive.spec.model.markers import GROUND
from derive.spec.model.spatial_scene import SpatialBody, SpatialJoint, SpatialScene

Linearised = tuple[Vector, Matrix, Vector]
"""The deviations (n,) of a target from its values, their derivatives by the velocities (n, nv), and by time (n,)."""


@dataclass(frozen=True, eq=False)
class SpatialTarget:
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

    @property
    def path(self) -> str:
        """The key with its table, such as bodies.rod.start.rotation."""
        return f"{self.table}.{self.key}"

    @property
    def unit(self) -> str:
        """The unit of the values."""
        return ("rad" if self.angular else "m") + ("/s" if self.rate else "")


def spatial_targets(scene: SpatialScene, native: NativeScene) -> tuple[SpatialTarget, ...]:
    """All targets of a scene: what it gives or guesses of bodies, joints and drives, and defaults of the positions."""
    result = [target for body in scene.bodies for target in _of_body(body, native)]
    joints = {joint.name: joint for joint in scene.joints}
    for joint in scene.joints:
        result += _of_joint(scene, joint, joint, f"joints.{joint.name}.start", native)
    for drive in scene.drives:
        joint = joints[drive.joint]
        result += _of_joint(scene, joint, drive, f"drives.{drive.name}.start", native)
        freedom = SPATIAL_JOINTS[joint.kind].driven
        if freedom is Freedom.ROTATION and joint_coordinate(joint, native) is None:
            # the constraint of the drive is the sine of the difference, which is zero half a turn away as well
            key = "motion" if drive.speed is None else "speed"
            value = float(simulated_drive(native, drive, np.zeros(1))[0])
            function = _function_of_frames(scene, joint, freedom, value, False)
            table = f"drives.{drive.name}"
            result.append(SpatialTarget(table, key, (value,), Strength.GIVEN, True, False, function, guessable=False))
    return tuple(result)


def _of_body(body: SpatialBody, native: NativeScene) -> Iterator[SpatialTarget]:
    start, table = body.start, f"bodies.{body.name}.start"
    given = Strength.GUESS if start.guess else Strength.GIVEN
    if start.position is not None:
        yield SpatialTarget(
            table, "position", start.position, given, False, False, _position(body.name, np.array(start.position))
        )
    if start.rotation is not None:
        quaternion = np.array(start.rotation)
        reference = rotation_matrix(quaternion / np.linalg.norm(quaternion))
        yield SpatialTarget(
            table, "rotation", start.rotation, given, True, False, _rotation(body.name, reference), body=body.name
        )
    for key, values in (("amplitudes", start.amplitudes), ("amplitude_rates", start.amplitude_rates)):
        if values:
            rate = key == "amplitude_rates"
            columns = tuple(_amplitude(native, body.name, i) for i in range(1, len(values) + 1))
            places = tuple(
                native.coordinates.index(owned(amplitude(i), body.name).name) for i, _ in enumerate(values, 1)
            )
            yield SpatialTarget(
                table, key, values, given, False, rate, _amplitudes(places, columns, np.array(values), rate), columns
            )
    if start.velocity is not None:
        function = _twist(body.name, slice(0, 3), np.array(start.velocity))
        yield SpatialTarget(table, "velocity", start.velocity, given, False, True, function)
    if start.angular_velocity is not None:
        function = _twist(body.name, slice(3, 6), np.array(start.angular_velocity))
        yield SpatialTarget(table, "angular_velocity", start.angular_velocity, given, True, True, function)


def _amplitude(native: NativeScene, body: str, i: int) -> int:
    """The number of the velocity of an amplitude."""
    return native.velocities.index(owned(amplitude(i, 1), body).name)


def _amplitudes(
    places: tuple[int, ...], columns: tuple[int, ...], values: Vector, rate: bool
) -> Callable[[SpatialPoses], Linearised]:
    """The amplitudes at some coordinates less their values; or their rates, which are the velocities `columns`."""

    def linearised(poses: SpatialPoses) -> Linearised:
        gradient = np.zeros((len(columns), poses.native.nv))
        gradient[np.arange(len(columns)), list(columns)] = 1.0
        now = np.zeros(len(values)) if rate else poses.q[list(places)]
        return now - values, gradient, np.zeros(len(values))

    return linearised


def _position(body: str, value: Vector) -> Callable[[SpatialPoses], Linearised]:
    def linearised(poses: SpatialPoses) -> Linearised:
        twist, drift = poses.twist(body)
        return poses.position(body) - value, twist[:3], drift[:3]

    return linearised


def _rotation(body: str, reference: Matrix) -> Callable[[SpatialPoses], Linearised]:
    def linearised(poses: SpatialPoses) -> Linearised:
        twist, drift = poses.twist(body)
        return poses.rotation_from(body, reference), twist[3:], drift[3:]

    return linearised


def _twist(body: str, part: slice, value: Vector) -> Callable[[SpatialPoses], Linearised]:
    def linearised(poses: SpatialPoses) -> Linearised:
        twist, drift = poses.twist(body)
        return drift[part] - value, twist[part], drift[part]

    return linearised


# ---- joints and drives ----


def _of_joint(
    scene: SpatialScene, joint: SpatialJoint, of: object, table: str, native: NativeScene
) -> Iterator[SpatialTarget]:
    start = of.start  # type: ignore[attr-defined]
    freedom = SPATIAL_JOINTS[joint.kind].driven
    if freedom is None:
        return
    strength = Strength.GUESS if start.guess else Strength.GIVEN
    angular = freedom is Freedom.ROTATION
    if start.coordinate is not None:
        key = "angle" if start.angle is not None else "displacement"
        function = _motion_of_joint(scene, joint, freedom, start.coordinate, False, native)
        yield SpatialTarget(table, key, (start.coordinate,), strength, angular, False, function)
    if start.speed is not None:
        function = _motion_of_joint(scene, joint, freedom, start.speed, True, native)
        yield SpatialTarget(table, "speed", (start.speed,), strength, angular, True, function)


@dataclass(frozen=True)
class JointColumn:
    """The coordinate and the velocity of a joint that eliminates others, by their numbers; sign: see `sign` there."""

    coordinate: int
    velocity: int
    sign: int


def joint_coordinate(joint: SpatialJoint, native: NativeScene) -> JointColumn | None:
    """The coordinate that is the motion of a joint; None of a joint that is a constraint, or that has a drive."""
    joint_type = SPATIAL_JOINTS[joint.kind]
    first_row = next((identifier(joined(joint.name, row.label)) for row in joint_type.rows(joint)), None)
    if joint_type.driven is None or first_row in native.multipliers:
        return None
    family = Family.ANGLE if joint_type.driven is Freedom.ROTATION else Family.GUIDE
    for marker, sign in ((joint.second, 1), (joint.first, -1)):
        q, v = (owned(quantity(family, derivative=d), marker.body).name for d in (0, 1))
        if q in native.coordinates:
            return JointColumn(native.coordinates.index(q), native.velocities.index(v), sign)
    return None


def _motion_of_joint(
    scene: SpatialScene, joint: SpatialJoint, freedom: Freedom, value: float, rate: bool, native: NativeScene
) -> Callable[[SpatialPoses], Linearised]:
    """The motion of a joint less its value: a coordinate, which counts whole turns, or a function of two frames."""
    column = joint_coordinate(joint, native)
    if column is None:
        return _function_of_frames(scene, joint, freedom, value, rate)

    def linearised(poses: SpatialPoses) -> Linearised:
        gradient = np.zeros((1, poses.native.nv))
        gradient[0, column.velocity] = column.sign
        now = 0.0 if rate else column.sign * poses.q[column.coordinate]
        return np.array([now - value]), gradient, np.zeros(1)

    return linearised


def _function_of_frames(
    scene: SpatialScene, joint: SpatialJoint, freedom: Freedom, value: float, rate: bool
) -> Callable[[SpatialPoses], Linearised]:
    """The rotation about, or the displacement along, the z axis of a joint less its value; rotations up to pi."""

    def linearised(poses: SpatialPoses) -> Linearised:
        first, second = (frame_of(scene, poses, marker) for marker in (joint.first, joint.second))
        axis = first.axes[:, 2]
        moving = {}
        for marker, frame in ((joint.first, first), (joint.second, second)):
            if marker.body == GROUND:
                moving[marker] = np.zeros((6, poses.native.nv)), np.zeros(6)
                continue
            twist, drift = poses.twist(marker.body)
            Q, lever = poses.rotation(marker.body), frame.position - poses.position(marker.body)
            cross = np.cross(np.eye(3), lever)  # rows e_k x lever, so that w x lever = cross.T w
            parts = []
            for part in (twist, drift):
                w = Q @ part[3:]
                parts.append(np.concatenate([part[:3] + cross.T @ w, w]))
            if deformed := deformed_frame(scene, poses, marker):
                parts[0][:, list(deformed.columns)] += np.vstack([Q @ deformed.moves, Q @ deformed.turns])
            moving[marker] = parts[0], parts[1]
        relative = [moving[joint.second][n] - moving[joint.first][n] for n in (0, 1)]
        if freedom is Freedom.ROTATION:
            now = np.arctan2(first.axes[:, 1] @ second.axes[:, 0], first.axes[:, 0] @ second.axes[:, 0])
            gradient, drift_of = (axis @ part[3:] for part in relative)
        else:
            d = second.position - first.position
            now = axis @ d
            turning = np.cross(axis, d)  # d/dt axis . d = (w1 x axis) . d = w1 . (axis x d)
            gradient, drift_of = (
                axis @ part[:3] + turning @ moving[joint.first][n][3:] for n, part in enumerate(relative)
            )
        gradient = np.atleast_2d(gradient)
        if rate:
            return np.array([drift_of - value]), gradient, np.array([drift_of])
        missed = now - value
        if freedom is Freedom.ROTATION:
            missed = (missed + np.pi) % (2 * np.pi) - np.pi
        return np.array([missed]), gradient, np.array([drift_of])

    return linearised
