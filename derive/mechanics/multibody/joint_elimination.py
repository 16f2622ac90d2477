"""No more than a scene needs: which bodies lose coordinates to a joint, and which joints are then no constraints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from derive.mechanics.equations import Coefficient, LeftOut
from derive.mechanics.multibody import coordinates as keep
from derive.mechanics.multibody.components import Member, rigid_member
from derive.mechanics.multibody.constraints import Driven
from derive.mechanics.multibody.coordinates import Held
from derive.mechanics.multibody.point_motion import PointMotion, fixed_point
from derive.spec.model.scene import GROUND, Joint, RigidBody


@dataclass(frozen=True)
class Reduced:
    """A rigid body that a joint holds: itself about the joint, the coordinates it keeps, and what was left out."""

    member: Member
    held: Held
    joint: str
    drive: str | None
    left_out: LeftOut


def reduced(
    body: RigidBody,
    joint: Joint,
    known: Mapping[str, Mapping[str, PointMotion]],
    drive: Driven | None,
    gravity: tuple[Coefficient, ...],
) -> Reduced | None:
    """What is left of a body behind a joint to a body whose motion is `known`; None if that takes nothing away."""
    ours, other = (joint.second, joint.first) if joint.second.body == body.name else (joint.first, joint.second)
    if other.body not in known or ours.body != body.name:
        return None
    at = known[other.body][other.marker]
    sign = 1 if joint.second.body == body.name else -1
    member = rigid_member(body, ours.marker, gravity)
    motion, name = member.body.motion, body.name
    to = "the ground" if other.body == GROUND else other.body
    angle = sign * sp.Rational(joint.angle)

    def found(held: Held, uses_drive: bool = False) -> Reduced:
        left = LeftOut(name, held.reason)
        return Reduced(member, held, joint.name, drive.name if drive and uses_drive else None, left)

    if joint.kind in ("weld", "fixed"):
        turn = (at.turn + angle, at.spin, at.spin_rate)
        reason = f"joint {joint.name} fixes it to {to}: no coordinates and no constraints, in place of 3 and 3"
        return found(keep.known(name, motion, at, turn, reason))
    if joint.kind == "revolute":
        if drive:
            turn = tuple(a + sign * b for a, b in zip((at.turn, at.spin, at.spin_rate), drive.motion, strict=True))
            reason = f"drive {drive.name} prescribes its motion: no coordinates and no constraints, in place of 3 and 3"
            return found(keep.known(name, motion, at, turn, reason), uses_drive=True)
        kept = "its rotation alone, in place of 3 coordinates and 2 constraints"
        reason = f"joint {joint.name} holds a point of it to {to}: {kept}"
        return found(keep.turning(name, motion, at, reason))
    if not keep.is_still(at) or sign < 0 or at.turn != 0:
        return None
    axis = keep.unit_axis(joint)
    if drive:
        s, v, a = drive.motion
        moved = PointMotion(
            (),
            sp.ImmutableMatrix(at.position + s * axis),
            sp.ImmutableMatrix(v * axis),
            sp.ImmutableMatrix(a * axis),
            at.turn,
            at.spin,
            at.spin_rate,
        )
        reason = f"drive {drive.name} prescribes its motion: no coordinates and no constraints, in place of 3 and 3"
        return found(keep.known(name, motion, moved, (angle, sp.S.Zero, sp.S.Zero), reason), uses_drive=True)
    reason = f"joint {joint.name} guides it: its displacement alone, in place of 3 coordinates and 2 constraints"
    return found(keep.sliding(name, motion, at, axis, angle, reason))


def ground(points: Mapping[str, sp.Matrix]) -> dict[str, PointMotion]:
    """The points of the ground."""
    return {name: fixed_point(position) for name, position in points.items()}
