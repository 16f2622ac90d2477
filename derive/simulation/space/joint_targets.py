"""The targets of joints in space in initial states: their motions, and the attitudes that they mean."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS, Freedom, JointStart
from derive.mechanics.multibody.space.rows import ROTATIONS
from derive.mechanics.multibody.space.tree.plan import supported_bodies
from derive.mechanics.symbols import Family, Identity
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.configurations import quaternion_of, rotation_vector
from derive.simulation.space.marker_frames import MarkerFrame, deformed_frame, frame_of
from derive.simulation.space.poses import SpatialPoses
from derive.spec.model.instances import joined
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.spatial_scene import SpatialJoint, SpatialScene

Linearised = tuple[Vector, Matrix, Vector]
"""The deviations (n,) of a target from its values, their derivatives by the velocities (n, nv), and by time (n,)."""


@dataclass(frozen=True)
class JointColumn:
    """The coordinate and the velocity of a joint that eliminates others, by their numbers; sign: see `sign` there."""

    coordinate: int
    velocity: int
    sign: int


def joint_coordinate(
    scene: SpatialScene, joint: SpatialJoint, freedom: Freedom, native: NativeScene
) -> JointColumn | None:
    """The coordinate that is a motion of a joint; None of a constraint, or of a prescribed motion."""
    if is_constraint(joint, native):
        return None
    family = Family.ANGLE if freedom is Freedom.ROTATION else Family.GUIDE
    of_tree = supported_bodies(scene).get(joint.name)
    for marker, sign in ((joint.second, 1), (joint.first, -1)):
        if of_tree not in (None, marker.body):
            continue
        q, v = (Identity(family, derivative=d, owner=marker.body).shown for d in (0, 1))
        if q in native.coordinates:
            return JointColumn(native.coordinates.index(q), native.velocities.index(v), sign)
    return None


def is_constraint(joint: SpatialJoint, native: NativeScene) -> bool:
    """Whether a joint is a constraint of the compiled scene, and has eliminated no coordinates."""
    rows = SPATIAL_JOINTS[joint.kind].rows(joint)
    return any(joined(joint.name, row.label) in native.multipliers for row in rows[:1])


def motion_of_joint(
    scene: SpatialScene,
    joint: SpatialJoint,
    motion: JointStart,
    values: tuple[float, ...],
    rate: bool,
    native: NativeScene,
) -> Callable[[SpatialPoses], Linearised]:
    """A motion of a joint less its values: a coordinate, which counts whole turns, or functions of two frames."""
    column = joint_coordinate(scene, joint, motion.freedom, native)
    if column is None or motion.axes != (2,):
        if motion.freedom is Freedom.ROTATION:
            return rotation_of_frames(scene, joint, values[0], rate)
        return displacements_of_frames(scene, joint, motion.axes, values, rate)
    (value,) = values

    def linearised(poses: SpatialPoses) -> Linearised:
        gradient = np.zeros((1, poses.native.nv))
        gradient[0, column.velocity] = column.sign
        now = 0.0 if rate else column.sign * poses.q[column.coordinate]
        return np.array([now - value]), gradient, np.zeros(1)

    return linearised


def rotation_of_frames(
    scene: SpatialScene, joint: SpatialJoint, value: float, rate: bool
) -> Callable[[SpatialPoses], Linearised]:
    """The rotation about the z axis of a joint less its value, up to pi."""

    def linearised(poses: SpatialPoses) -> Linearised:
        first, second = (frame_of(scene, poses, marker) for marker in (joint.first, joint.second))
        axis = first.axes[:, 2]
        moving = [_moving(scene, poses, *pair) for pair in ((joint.first, first), (joint.second, second))]
        now = np.arctan2(first.axes[:, 1] @ second.axes[:, 0], first.axes[:, 0] @ second.axes[:, 0])
        gradient, drift = (axis @ (moving[1][n] - moving[0][n])[3:] for n in (0, 1))
        missed = drift - value if rate else (now - value + np.pi) % (2 * np.pi) - np.pi
        return np.array([missed]), np.atleast_2d(gradient), np.array([drift])

    return linearised


def displacements_of_frames(
    scene: SpatialScene, joint: SpatialJoint, axes: tuple[int, ...], values: tuple[float, ...], rate: bool
) -> Callable[[SpatialPoses], Linearised]:
    """The displacements along axes of the first marker of a joint less their values."""

    def linearised(poses: SpatialPoses) -> Linearised:
        first, second = (frame_of(scene, poses, marker) for marker in (joint.first, joint.second))
        along, d = first.axes[:, list(axes)].T, second.position - first.position
        turning = np.cross(along, d)  # d/dt axis . d = (w1 x axis) . d = w1 . (axis x d)
        moving = [_moving(scene, poses, *pair) for pair in ((joint.first, first), (joint.second, second))]
        gradient, drift = (along @ (moving[1][n] - moving[0][n])[:3] + turning @ moving[0][n][3:] for n in (0, 1))
        return (drift if rate else along @ d) - np.array(values), gradient, drift

    return linearised


def _moving(scene: SpatialScene, poses: SpatialPoses, marker: MarkerRef, frame: MarkerFrame) -> tuple[Matrix, Vector]:
    """The velocity and the angular velocity, inertial, of a marker by unit velocities (6, nv), and at rest (6,)."""
    if marker.body == GROUND:
        return np.zeros((6, poses.native.nv)), np.zeros(6)
    Q, lever = poses.rotation(marker.body), frame.position - poses.position(marker.body)
    cross = np.cross(np.eye(3), lever)  # rows e_k x lever, so that w x lever = cross.T w
    parts = []
    for part in poses.twist(marker.body):
        w = Q @ part[3:]
        parts.append(np.concatenate([part[:3] + cross.T @ w, w]))
    if deformed := deformed_frame(scene, poses, marker):
        parts[0][:, list(deformed.columns)] += np.vstack([Q @ deformed.moves, Q @ deformed.turns])
    return parts[0], parts[1]


# ---- attitudes ----

_PARALLEL = {
    ("rx", "ry"): (2,),
    ("rx", "rz"): (1,),
    ("ry", "rz"): (0,),
    ("rx", "ry", "rz"): (0, 1, 2),
}
"""The axes, x y z, that a joint which removes these rotations keeps parallel."""


def parallel_axes(joint: SpatialJoint) -> tuple[int, ...]:
    """The axes, x y z, of its markers that a joint keeps parallel."""
    removed = SPATIAL_JOINTS[joint.kind].removed(joint)
    return _PARALLEL.get(tuple(name for name in ROTATIONS if name in removed), ())


def attitude(scene: SpatialScene, joint: SpatialJoint) -> Callable[[SpatialPoses], Linearised]:
    """The rotation vector (3,), inertial, by which the axes that a joint keeps parallel are apart; up to pi."""
    axes = parallel_axes(joint)

    def linearised(poses: SpatialPoses) -> Linearised:
        first, second = (frame_of(scene, poses, marker) for marker in (joint.first, joint.second))
        relative = [
            b - a
            for a, b in zip(
                _moving(scene, poses, joint.first, first), _moving(scene, poses, joint.second, second), strict=True
            )
        ]
        if len(axes) == 1:
            a, b = first.axes[:, axes[0]], second.axes[:, axes[0]]
            normal = np.cross(a, b)
            sine = float(np.linalg.norm(normal))
            angle = float(np.arctan2(sine, a @ b))
            if sine < OPPOSITE and angle > 1.0:  # about any normal
                normal, sine = second.axes[:, axes[0] - 1], 1.0
            apart = normal * (angle / sine if sine > 0.0 else 1.0)
            along = np.eye(3) - np.outer(a, a)
        else:
            apart = first.axes @ rotation_vector(quaternion_of(first.axes.T @ second.axes))
            along = np.eye(3)
        turning, drift = (along @ part[3:] for part in relative)
        return along @ apart, turning, drift

    return linearised


OPPOSITE = 1e-6
"""The sine of the angle of axes below which they count as parallel."""
