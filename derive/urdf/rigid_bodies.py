"""The rigid bodies of a robot: links that fixed joints connect are one body."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from derive.urdf.robot import HERE, Link, Matrix, Placement, Robot, RobotJoint, Vector


@dataclass(frozen=True, eq=False)
class LinkPart:
    """A link of a rigid body, with its placement in the frame of the body."""

    link: Link
    placement: Placement


@dataclass(frozen=True, eq=False)
class RobotBody:
    """Links that move as one body, whose frame is that of the first; `joint` moves it, None of the root."""

    joint: RobotJoint | None
    parts: list[LinkPart] = field(default_factory=list)

    @property
    def name(self) -> str:
        """The name of its first link."""
        return self.parts[0].link.name

    @property
    def mass(self) -> float:
        """The sum of the masses, kg."""
        return sum(part.link.inertia.mass for part in self.parts if part.link.inertia)

    @property
    def centre(self) -> Vector:
        """The centre of mass in the frame of the body, m; the origin of a body without mass."""
        if not self.mass:
            return np.zeros(3)
        (first, *others) = [part for part in self.parts if part.link.inertia and part.link.inertia.mass]
        if not others:
            return _centre(first)
        return sum((_mass(part) * _centre(part) for part in (first, *others)), np.zeros(3)) / self.mass

    @property
    def tensor(self) -> Matrix:
        """The tensor of inertia about the centre of mass along the axes of the body, kg m^2."""
        result, centre = np.zeros((3, 3)), self.centre
        for part in self.parts:
            if part.link.inertia:
                rotation, lever = part.placement.rotation, _centre(part) - centre
                result += rotation @ part.link.inertia.matrix @ rotation.T
                result += _mass(part) * (lever @ lever * np.eye(3) - np.outer(lever, lever))
        return result


def _mass(part: LinkPart) -> float:
    assert part.link.inertia
    return part.link.inertia.mass


def _centre(part: LinkPart) -> Vector:
    assert part.link.inertia
    return part.placement.of(part.link.inertia.origin.placement).position


def rigid_bodies(robot: Robot) -> list[RobotBody]:
    """The rigid bodies from the root on, each behind the one that carries it, limb by limb."""
    locked = robot.locked
    waiting = [RobotBody(None, [LinkPart(robot.links[robot.root], HERE)])]
    bodies = []
    while waiting:
        body = waiting.pop()
        bodies.append(body)
        carried = []
        for part in body.parts:  # grows at its end
            for joint in robot.joints_behind(part.link.name):
                link = robot.links[joint.child]
                if joint.name in locked:
                    body.parts.append(LinkPart(link, part.placement.of(_locked_placement(joint, locked[joint.name]))))
                else:
                    carried.append(RobotBody(joint, [LinkPart(link, HERE)]))
        waiting += reversed(carried)
    return bodies


def joints_on(robot: Robot, body: RobotBody) -> Iterator[tuple[RobotJoint, LinkPart]]:
    """The joints that move other bodies on this one, with the link that carries each."""
    locked = robot.locked
    for part in body.parts:
        for joint in robot.joints_behind(part.link.name):
            if joint.name not in locked:
                yield joint, part


def _locked_placement(joint: RobotJoint, position: float) -> Placement:
    """The placement of the child of a joint that stays where it is."""
    origin = joint.origin.placement
    return origin.of(joint.moved(position)) if position else origin
