"""The joints of a scene in space in a configuration: those that are open, and those met the wrong way round.

Rotation rows are products of axes that vanish for reversed axes as well, so that an initial state is compared with the
attitude that each joint means.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.mechanics.multibody.space.rows import DISPLACEMENTS, ROTATIONS
from derive.simulation.configurations import quaternion_of, rotation_vector
from derive.simulation.errors import SimulationError
from derive.simulation.space.marker_frames import frame_of
from derive.simulation.space.poses import SpatialPoses
from derive.spec.model.spatial_scene import SpatialJoint, SpatialScene

_PARALLEL = {
    ("rx", "ry"): (2,),
    ("rx", "rz"): (1,),
    ("ry", "rz"): (0,),
    ("rx", "ry", "rz"): (0, 1, 2),
}
"""The axes, x y z, that a joint which removes these rotations keeps parallel."""


class ReversedJoint(SimulationError):
    """Joints are met with axes that point the other way, or frames that are turned by half a turn."""


def check_attitudes(scene: SpatialScene, poses: SpatialPoses) -> None:
    """Raise ReversedJoint where axes that a joint keeps parallel point in opposite directions."""
    if lines := tuple(line for joint in scene.joints for line in _reversed(scene, joint, poses)):
        raise ReversedJoint("\n".join(lines))


def _reversed(scene: SpatialScene, joint: SpatialJoint, poses: SpatialPoses) -> Iterator[str]:
    removed = SPATIAL_JOINTS[joint.kind].removed(joint)
    axes = _PARALLEL.get(tuple(name for name in ROTATIONS if name in removed), ())
    first, second = (frame_of(scene, poses, marker) for marker in (joint.first, joint.second))
    for axis in axes:
        cosine = float(first.axes[:, axis] @ second.axes[:, axis])
        if cosine < 0.0:
            angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
            name = "xyz"[axis]
            yield (
                f"the {joint.kind} joint {joint.name} is met the wrong way round: {name} of {joint.second} is "
                f"{angle:.4g} degrees from {name} of {joint.first}, which should be parallel; turn a marker by half "
                "a turn, or give bodies a start nearer to the attitude that is meant"
            )


def open_joints(scene: SpatialScene, poses: SpatialPoses) -> str:
    """The joints that are not met, with the remaining distance and angle of each, as text."""
    parts = []
    for joint in scene.joints:
        first, second = (frame_of(scene, poses, marker) for marker in (joint.first, joint.second))
        joint_type = SPATIAL_JOINTS[joint.kind]
        removed = joint_type.removed(joint)
        d = first.axes.T @ (second.position - first.position)
        apart = np.array([d[i] for i, name in enumerate(DISPLACEMENTS) if name in removed])
        if joint_type.keeps_distance and joint.distance is not None:
            apart = np.array([np.linalg.norm(d) - float(joint.distance)])
        turned = rotation_vector(quaternion_of(first.axes.T @ second.axes))
        angles = np.array([turned[i] for i, name in enumerate(ROTATIONS) if name in removed])
        distance, angle = float(np.linalg.norm(apart)), float(np.linalg.norm(angles))
        if distance > SEEN * poses.size or angle > SEEN:
            parts.append(f"{joint.name} (off by {distance:.4g} m and {np.degrees(angle):.4g} degrees)")
    return ", ".join(parts)


SEEN = 1e-9
"""Parts of the size of the scene, and rad: joints that are off by less are met."""
