"""The joints of a scene in space in a configuration: those that are open, and those met the wrong way round.

Rotation rows are products of axes that vanish for reversed axes as well, so that an initial state is compared with the
attitude that each joint means.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from derive.errors import Problem, SpecError
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS, Freedom
from derive.mechanics.multibody.space.rows import DISPLACEMENTS, ROTATIONS, SCREW
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.configurations import quaternion_of, rotation_vector
from derive.simulation.space.joint_targets import parallel_axes
from derive.simulation.space.marker_frames import frame_of
from derive.simulation.space.poses import SpatialPoses
from derive.spec.model.instances import joined
from derive.spec.model.spatial_scene import SpatialJoint, SpatialScene

_ORTHOGONAL = {("rx",): (2, 1), ("ry",): (2, 0), ("rz",): (1, 0)}
"""The axes of the first and of the second marker that a joint which removes one rotation keeps orthogonal."""


def check_attitudes(scene: SpatialScene, poses: SpatialPoses) -> None:
    """Raise SpecError where axes that a joint keeps parallel point in opposite directions."""
    problems = [problem for joint in scene.joints for problem in _reversed(scene, joint, poses)]
    if problems:
        raise SpecError(tuple(problems))


def _reversed(scene: SpatialScene, joint: SpatialJoint, poses: SpatialPoses) -> Iterator[Problem]:
    first, second = (frame_of(scene, poses, marker).axes for marker in (joint.first, joint.second))
    opposite = [(a, b, angle) for a, b, angle, meant in _angles(joint, first, second) if meant == 0.0 and angle > 90.0]
    if opposite:
        each = " and ".join(f"{a} is {angle:.4g} degrees from {b}" for a, b, angle in opposite)
        which = "which should be parallel" if len(opposite) == 1 else "which should be parallel in pairs"
        text = (
            f"the {joint.kind} joint {joint.name} is met the wrong way round: {each}, {which}; turn a marker by half a "
            "turn, or give bodies a start nearer to the attitude that is meant"
        )
        yield Problem(f"joints.{joint.name}.between", text)


def _angles(joint: SpatialJoint, first: Matrix, second: Matrix) -> Iterator[tuple[str, str, float, float]]:
    """The axes of the two markers of a joint that it keeps at an angle: their names, the angle, and the one meant.

    The names are those of the second marker, then of the first; angles are in degrees, and 0 or 90 are meant.
    """
    removed = SPATIAL_JOINTS[joint.kind].removed(joint)
    rotations = tuple(name for name in ROTATIONS if name in removed)
    pairs = [(axis, axis, 0.0) for axis in parallel_axes(joint)]
    pairs += [(*_ORTHOGONAL[rotations], 90.0)] if rotations in _ORTHOGONAL else []
    for i, j, meant in pairs:
        sine, cosine = np.linalg.norm(np.cross(first[:, i], second[:, j])), first[:, i] @ second[:, j]
        angle = float(np.degrees(np.arctan2(sine, cosine)))
        yield f"{'xyz'[j]} of {joint.second}", f"{'xyz'[i]} of {joint.first}", angle, meant


def misalignment(scene: SpatialScene, poses: SpatialPoses, body: str, rotation: Matrix) -> str:
    """The joint of a body that its rotation (3, 3) misses most where other bodies are in these poses, as a text.

    It names the axes that the joint keeps parallel or orthogonal, and their angle; empty where there is no such joint.
    """
    worst, text = MISALIGNED, ""
    turned = rotation @ poses.rotation(body).T
    for joint in scene.joints:
        if body not in (joint.first.body, joint.second.body):
            continue
        first, second = (
            (turned if marker.body == body else np.eye(3)) @ frame_of(scene, poses, marker).axes
            for marker in (joint.first, joint.second)
        )
        for a, b, angle, meant in _angles(joint, first, second):
            if abs(angle - meant) > worst:
                worst = abs(angle - meant)
                how = "parallel" if meant == 0.0 else "orthogonal"
                text = (
                    f"with it, {a} would be {angle:.4g} degrees from {b}, and the {joint.kind} joint {joint.name} "
                    f"keeps them {how}"
                )
    return text


MISALIGNED = 1e-6
"""Degrees: axes that are nearer to the angle that is meant are aligned."""


def open_joints(scene: SpatialScene, poses: SpatialPoses, g: Vector) -> tuple[Problem, ...]:
    """The joints and gears that are not met, with the remaining distance and angle of each; g: all constraints."""
    missed = dict(zip(poses.native.multipliers, g, strict=True))
    problems = []
    for joint in scene.joints:
        first, second = (frame_of(scene, poses, marker) for marker in (joint.first, joint.second))
        joint_type = SPATIAL_JOINTS[joint.kind]
        removed = joint_type.removed(joint)
        d = first.axes.T @ (second.position - first.position)
        apart = [float(d[i]) for i, name in enumerate(DISPLACEMENTS) if name in removed]
        if joint_type.keeps_distance and joint.distance is not None:
            apart = [float(np.linalg.norm(d)) - float(joint.distance)]
        if joint_type.is_screw:
            apart.append(float(missed.get(joined(joint.name, SCREW.label), 0.0)))
        turned = rotation_vector(quaternion_of(first.axes.T @ second.axes))
        angles = [float(turned[i]) for i, name in enumerate(ROTATIONS) if name in removed]
        distance, angle = float(np.linalg.norm(apart)), float(np.linalg.norm(angles))
        if distance > SEEN * poses.size or angle > SEEN:
            problems.append(Problem(f"joints.{joint.name}", _open_text(distance, angle)))
    for gear in scene.gears:
        amount = abs(float(missed[gear.name]))
        if amount > SEEN:
            coupled = next(joint for joint in scene.joints if joint.name == gear.joints[1])
            rotates = SPATIAL_JOINTS[coupled.kind].coupled(coupled) is Freedom.ROTATION
            problems.append(Problem(f"gears.{gear.name}", _open_text(*((0.0, amount) if rotates else (amount, 0.0)))))
    return tuple(problems)


def _open_text(distance: float, angle: float) -> str:
    return (
        f"the mechanism cannot be assembled: this is off by {distance:.4g} m and {np.degrees(angle):.4g} degrees where "
        "all joints are met as well as can be; give bodies a start nearer to the closed mechanism, check that lengths "
        "can reach, and that every drive begins where the mechanism can be"
    )


SEEN = 1e-9
"""Parts of the size of the scene, and rad: joints that are off by less are met."""
