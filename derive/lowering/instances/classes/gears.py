"""Gears among the constraints of loops over instances: they couple the bodies of two joints, which are up to four.

A gear is numbered behind the joints, and has one constraint. Its bodies have handles at it as they have at joints: the
system of the joints contains it as a joint of several bodies.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from typing import TypeAlias

from derive.algebra import sp
from derive.lowering.instances.classes.dimension import AnyJoint, plain_joint, space
from derive.mechanics.multibody.space.frame_motion import FrameMotion
from derive.mechanics.multibody.space.gears import GearInstance, gear_constraint
from derive.mechanics.multibody.space.joint_motion import joint_motion
from derive.mechanics.multibody.space.mechanism import AnyMechanism, SpatialMechanism
from derive.mechanics.terms import Constraint, EquationOfMotion
from derive.spec.model.markers import GROUND, MarkerRef


@dataclass(frozen=True)
class CoupledJoints:
    """A gear with the mechanism whose joints it couples."""

    mechanism: SpatialMechanism
    instance: GearInstance
    multipliers: int = 1
    drive: None = None

    @property
    def markers(self) -> tuple[MarkerRef, ...]:
        """The first and the second marker of its first joint, then those of its second joint."""
        joints = (self.mechanism.joints_by_name[name].joint for name in self.instance.gear.joints)
        return tuple(marker for joint in joints for marker in (joint.first, joint.second))

    @property
    def bodies(self) -> tuple[str, ...]:
        """The bodies with coordinates among those of its joints, each once."""
        names = (marker.body for marker in self.markers if marker.body != GROUND)
        return tuple({name: None for name in names if self.mechanism.instance(name).moves})

    @property
    def form(self) -> Hashable:
        """All that its constraint depends on, besides the motions of its markers."""
        joints = (self.mechanism.joints_by_name[name] for name in self.instance.gear.joints)
        kinds = tuple((type(joint), joint.type, plain_joint(joint), joint.drive) for joint in joints)
        return kinds, self.instance.ratio, self.instance.offset

    def constraint(self, at: Callable[[MarkerRef], FrameMotion], rows: tuple[EquationOfMotion, ...]) -> Constraint:
        """Its constraint for the motions of its markers; rows: those of the bodies whose factors in G are wanted."""
        mechanism = self.mechanism
        return gear_constraint(
            self.instance,
            lambda name: joint_motion(mechanism.joints_by_name[name], at, mechanism.instances_by_name, rows),
            rows,
        )

    def known_part(self, point: Callable[[MarkerRef], FrameMotion]) -> Constraint:
        """Its constraint if no body with coordinates has it; else nothing of it, since its group computes all.

        point: the motions of markers that are known.
        """
        if not self.bodies:
            return self.constraint(point, ())
        zero = sp.S.Zero
        return replace(self.constraint(lambda _: space().other, ()), position=zero, rate=zero, bias=zero)


Constraining: TypeAlias = "AnyJoint | CoupledJoints"
"""What has constraints: a joint, or a gear."""


def constraining(mechanism: AnyMechanism) -> tuple[Constraining, ...]:
    """The joints that are constraints, and the gears behind them."""
    if isinstance(mechanism, SpatialMechanism):
        return (*mechanism.joints, *gears_of(mechanism))
    return mechanism.joints


def gears_of(mechanism: AnyMechanism) -> tuple[CoupledJoints, ...]:
    """The gears, which are in space alone."""
    if not isinstance(mechanism, SpatialMechanism):
        return ()
    return tuple(CoupledJoints(mechanism, gear) for gear in mechanism.gears)
