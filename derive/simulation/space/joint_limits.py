"""The motions of joints against their limits, which no force enforces: a run notes where it passes them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS, Freedom
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.space.joint_targets import joint_coordinate
from derive.simulation.space.marker_frames import frame_of
from derive.simulation.space.poses import SpatialPoses
from derive.spec.model.spatial_scene import SpatialJoint, SpatialScene
from derive.spec.model.specification import AnyScene

ROUNDING = 1e-9
"""The motion beyond a limit, rad or m, that counts as rounding: a limit of zero is met by what stands still there."""


def joint_limit_notes(scene: AnyScene, native: NativeScene, k: Vector, t: Vector, q: Matrix) -> Iterator[str]:
    """A note on each joint that passes a limit in one of the states q (n, nq) at the times t (n,), s."""
    if not isinstance(scene, SpatialScene):
        return
    for joint in scene.joints:
        freedom = SPATIAL_JOINTS[joint.kind].driven
        if joint.limits is None or freedom is None:
            continue
        motion, unit = _motion(scene, joint, freedom, native, k, t, q), freedom.unit
        for limit, beyond in zip(joint.limits, (joint.limits[0] - motion, motion - joint.limits[1]), strict=True):
            if beyond.max() > ROUNDING:
                first, farthest = int(np.argmax(beyond > ROUNDING)), int(np.argmax(beyond))
                yield (
                    f"joints.{joint.name}: passes its limit of {limit:.4g} {unit} by t = {t[first]:.4g} s and reaches "
                    f"{motion[farthest]:.4g} {unit}; nothing enforces limits"
                )


def _motion(
    scene: SpatialScene, joint: SpatialJoint, freedom: Freedom, native: NativeScene, k: Vector, t: Vector, q: Matrix
) -> Vector:
    """The motion (n,) of a joint, rad or m; turns are counted from row to row."""
    if column := joint_coordinate(scene, joint, freedom, native):
        return np.asarray(column.sign * q[:, column.coordinate])
    motion = np.empty(len(t))
    for i, (time, at) in enumerate(zip(t.tolist(), q, strict=True)):
        poses = SpatialPoses(native, k, time, at, 1.0)
        first, second = (frame_of(scene, poses, marker) for marker in (joint.first, joint.second))
        if freedom is Freedom.ROTATION:
            across, along = first.axes[:, 1] @ second.axes[:, 0], first.axes[:, 0] @ second.axes[:, 0]
            motion[i] = np.arctan2(across, along)
        else:
            motion[i] = first.axes[:, 2] @ (second.position - first.position)
    return np.unwrap(motion) if freedom is Freedom.ROTATION else motion
