"""The joints of the links in a loop: how forces pass them to the links before, and motions from these.

A link turns about its axis e by `turns` times the rate of its joint, and advances along it by `advances` times that.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from derive.lowering.instances.places import Place
from derive.lowering.trees.link_loop import LinkLoop
from derive.lowering.trees.motion import LEVER, axis
from derive.lowering.vectors import Vector, cross, dot, plus, scaled


@dataclass(frozen=True)
class JointAxes:
    """The axis of each link, its lever from the link before it, and whether it turns with this one, as 1 or 0."""

    axis: Vector
    lever: Vector
    follows: ca.SX
    turns: ca.SX
    advances: ca.SX

    def along(self, force: Vector, torque: Vector) -> ca.SX:
        """The generalised force of a force and a torque about the origin of the link."""
        return self.advances * dot(self.axis, force) + self.turns * dot(self.axis, torque)

    def passed(self, force: Vector, torque: Vector) -> Vector:
        """The force and the torque about the origin of the link before it."""
        return [*force, *plus(scaled(self.follows, torque), cross(self.lever, force))]

    def carried(self, a: Vector, alpha: Vector) -> tuple[Vector, Vector]:
        """The acceleration and the angular acceleration of the link by those of the one before it."""
        return plus(a, cross(alpha, self.lever)), scaled(self.follows, alpha)

    def moved(self, a: Vector, alpha: Vector, rate: ca.SX) -> Vector:
        """Both accelerations with that of the joint."""
        linear, angular = scaled(self.advances * rate, self.axis), scaled(self.turns * rate, self.axis)
        return [*plus(a, linear), *plus(alpha, angular)]


def joint_axes(loop: LinkLoop, here: Place) -> JointAxes:
    """The joints of the links of a loop, whose quantities are at a place."""
    e, r, follows = axis(loop, here), loop.vector(LEVER, here), loop.number(lambda of: of.follows)
    turns, advances = loop.number(lambda of: of.turns), loop.number(lambda of: of.advances)
    return JointAxes(e, r, follows, turns, advances)
