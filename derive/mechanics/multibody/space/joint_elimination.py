"""Joint elimination in space: the coordinates that a joint leaves a rigid body behind a known marker."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from derive.algebra import sp, zero
from derive.mechanics.multibody.space.coordinates import behind_marker, joint_coordinate, on_ball
from derive.mechanics.multibody.space.joint_coordinate import JointCoordinate
from derive.mechanics.multibody.space.joints import Freedom, SpatialJointType
from derive.mechanics.multibody.space.rows import DISPLACEMENTS, ROTATIONS
from derive.spec.model.spatial_scene import SpatialJoint

if TYPE_CHECKING:
    from derive.mechanics.motion.body_motion import Motion
    from derive.mechanics.multibody.coordinates import CoordinateMap
    from derive.mechanics.multibody.joints.joint_type import PrescribedMotion
    from derive.mechanics.multibody.space.frame_motion import FrameMotion

_ORDER = {"rx": ("rz", "ry"), "ry": ("rz", "rx"), "rz": ("ry", "rx")}
"""The two rotations of a joint that removes the third: first about the axis of the known marker, if it is the first."""

SHARED = (("z",), ("x", "y"), ("x", "y", "z"))
"""The displacements that are along the axes of either marker, where the bodies rotate about z against each other."""


@dataclass(frozen=True)
class SpatialSupport:
    """A rigid body that a joint connects to a marker whose motion is known.

    `motion` is that of the body, whose origin O is its marker of the joint; `own_axes` are the axes of this marker in
    the body, `known` is the motion of the other one, `attached_to` the text that names its body. `sign` is 1 if the
    body is body 2 of the joint, -1 if it is body 1. `lead` is the displacement of a screw for a rotation of 1 rad.
    """

    body: str
    motion: Motion
    own_axes: sp.ImmutableMatrix
    known: FrameMotion
    attached_to: str
    sign: int
    drive: PrescribedMotion | None
    lead: sp.Expr = field(default_factory=zero)


def minimal_spatial_coordinates(
    joint_type: SpatialJointType, joint: SpatialJoint, support: SpatialSupport
) -> CoordinateMap | None:
    """The coordinates of a rigid body that a joint supports; None if the joint eliminates none.

    With a drive they follow the drive, since neither the joint nor the drive is a constraint then.
    """
    free = joint_type.free(joint)
    if free is None or len(free) == len(DISPLACEMENTS) + len(ROTATIONS):
        return None
    displacements = tuple(motion for motion in free if motion in DISPLACEMENTS)
    rotations = tuple(motion for motion in free if motion in ROTATIONS)
    if displacements and support.sign < 0 and not (rotations in ((), ("rz",)) and displacements in SHARED):
        return None  # along axes that turn with the body
    if displacements and any(support.known.angular_velocity):
        return None  # along axes that a drive turns: the mass matrix would be a function of time
    coordinates, ball = joint_coordinates(joint_type, free, support)
    reason = reason_text(joint, support, coordinates, ball)
    if ball:
        return on_ball(support.body, support.motion, support.known, coordinates, reason)
    return behind_marker(support.body, support.motion, support.known, support.own_axes, coordinates, reason)


def joint_coordinates(
    joint_type: SpatialJointType, free: tuple[str, ...], support: SpatialSupport
) -> tuple[list[JointCoordinate], bool]:
    """The relative motions that a joint leaves, in their order; whether it leaves all rotations, which are not listed.

    free: their names. A drive of the support prescribes one of them.
    """
    displacements = tuple(motion for motion in free if motion in DISPLACEMENTS)
    rotations = tuple(motion for motion in free if motion in ROTATIONS)
    if len(rotations) == 2:
        (removed,) = (motion for motion in ROTATIONS if motion not in rotations)
        rotations = _ORDER[removed][:: support.sign]
    driven = {Freedom.ROTATION: "rz", Freedom.DISPLACEMENT: "z"}[joint_type.driven] if joint_type.driven else ""
    ball = len(rotations) == len(ROTATIONS)
    if joint_type.is_screw:
        displacements = ()  # its displacement is a function of its rotation
    coordinates = []
    for group in (displacements, () if ball else rotations):
        for motion in group:
            prescribed = None
            if support.drive and motion == driven:
                position, rate, second = (support.sign * of for of in support.drive.motion)
                prescribed = position, rate, second
            coordinate = joint_coordinate(support.body, motion, len(group) > 1, prescribed)
            coordinates.append(replace(coordinate, along=support.lead) if joint_type.is_screw else coordinate)
    return coordinates, ball


def reason_text(joint: SpatialJoint, support: SpatialSupport, coordinates: list[JointCoordinate], ball: bool) -> str:
    """The text that says which coordinates a body keeps, and why."""
    kept = [c.coordinate.q.name for c in coordinates if c.coordinate]
    if not kept and not ball:
        cause = (
            f"drive {support.drive.name} prescribes its motion"
            if support.drive
            else f"joint {joint.name} fixes it to {support.attached_to}"
        )
        return f"{cause}; this eliminates 6 degrees of freedom and 6 constraints"
    names = ", ".join([*kept, *(["its rotation"] if ball else [])])
    count = len(kept) + (3 if ball else 0)
    return (
        f"joint {joint.name} connects it to {support.attached_to}, and only {names} "
        f"{'remain' if len(kept) + ball > 1 else 'remains'}; this eliminates {6 - count} degrees of freedom and "
        f"{6 - count} constraints"
    )
