"""Lines on what the scene of a robot does not have of it or has otherwise, and on what its user may not expect."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

from derive.errors import printable
from derive.short_text import counted
from derive.urdf.robot import JointKind, Robot, RobotJoint

COLLISION = "collision"
"""The element of a shape for contact."""


def left_out(robot: Robot, moving: Sequence[RobotJoint]) -> Iterator[str]:
    """The lines on a robot; `moving` are the joints that move bodies of its scene."""
    if robot.roundings:
        angles, most = counted(len(robot.roundings), "angle"), max(robot.roundings)
        yield f"taken for right angles, within {most:.1e} rad: {angles} (--keep-angles leaves them as they are)"
    locked = robot.locked
    following = [j for j in robot.joints.values() if j.name in locked and j.kind is not JointKind.FIXED]
    several = [j for j in moving if j.damping and not j.kind.has_one_motion]
    for text, joints in {
        "do not move, since the joints that they follow do not": following,
        "friction is left out, of": [j for j in moving if j.friction],
        "damping of joints with several motions is left out, of": several,
        "the zero position, in which the motion begins, is outside of the limits of": filter(_starts_outside, moving),
    }.items():
        if names := _names(joints):
            yield f"{text}{':' if joints is following else ''} {names}"
    if number := robot.unread.get(COLLISION):
        yield f"left out, since bodies do not touch: {number} <{COLLISION}>"
    if unread := [f"{number} <{printable(tag)}>" for tag, number in robot.unread.items() if tag != COLLISION]:
        yield f"not read: {', '.join(unread)}"


def _names(joints: Iterable[RobotJoint]) -> str:
    return ", ".join(printable(joint.name) for joint in joints)


def _starts_outside(joint: RobotJoint) -> bool:
    """Whether the zero position of a joint, from which it does not follow another one, is beyond its limits."""
    if joint.limits is None or joint.kind is JointKind.CONTINUOUS or joint.mimic or not joint.kind.has_one_motion:
        return False
    lower, upper = joint.limits.lower, joint.limits.upper
    return not ((lower if lower is not None else -math.inf) <= 0 <= (upper if upper is not None else math.inf))
