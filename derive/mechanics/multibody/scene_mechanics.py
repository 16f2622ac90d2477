"""The motion of all points of a mechanism and the forces on its bodies, from which outputs are computed.

The force and the torque on a body, or on a part of it, are factors of a virtual rigid displacement of this part alone:
two translations and a rotation about a point. Forces, springs and joints state their virtual work on it as they do on
the coordinates of the mechanism, so that reactions follow where a joint has eliminated coordinates as well.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.multibody.point_motion import PointMotion, RelativeMotion
from derive.mechanics.symbols import local
from derive.mechanics.terms import Constraint, EquationOfMotion
from derive.spec.model.joints import Drive, Joint
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.scene import Scene

if TYPE_CHECKING:
    from derive.mechanics.multibody.bodies.body_type import ComponentDamping
    from derive.mechanics.multibody.forces.force_type import GeneralisedForce
    from derive.mechanics.multibody.instances import InstanceEquations
    from derive.mechanics.multibody.joints.joint_type import JointType
    from derive.mechanics.multibody.kinds import EliminatedJoint, ForceInstance, JointInstance

Part = Callable[[MarkerRef], bool]
"""A predicate: whether a marker belongs to a part of a mechanism."""

_VIRTUAL = tuple(
    EquationOfMotion(f"virtual {k}", local(f"virtual_v{k}"), local(f"virtual_a{k}"), "", "", "") for k in (1, 2, 3)
)
"""The rows of the virtual displacement of a part: translations along e1 and e2, and the rotation about e3."""


@dataclass(frozen=True)
class Resultant:
    """A force (column of 2, inertial frame, N) and the torque about e3 with respect to a point (N m)."""

    force: sp.Matrix
    torque: sp.Expr

    def __add__(self, other: Resultant) -> Resultant:
        return Resultant(self.force + other.force, self.torque + other.torque)

    def __neg__(self) -> Resultant:
        return Resultant(-self.force, -self.torque)

    def about(self, old: sp.Matrix, new: sp.Matrix) -> Resultant:
        """The equivalent force and torque about `new` in place of `old`, both in the inertial frame."""
        lever = old - new
        return Resultant(self.force, self.torque + lever[0] * self.force[1] - lever[1] * self.force[0])


NOTHING = Resultant(sp.zeros(2, 1), sp.S.Zero)


@dataclass(frozen=True)
class SceneMechanics:
    """The parts of a mechanism: the equations of its instances by their names, joints, forces and constraints.

    `generalised` are the forces of `forces` on the rows of the mechanism; `dampings` act between components;
    `constraints` are those of `joints`.
    """

    scene: Scene
    ground: Mapping[str, PointMotion]
    instances: Mapping[str, InstanceEquations]
    joints: tuple[JointInstance, ...]
    eliminated_joints: tuple[EliminatedJoint, ...]
    forces: tuple[ForceInstance, ...]
    generalised: tuple[GeneralisedForce, ...]
    dampings: tuple[ComponentDamping, ...]
    constraints: tuple[Constraint, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the instances."""
        return tuple(self.instances)

    def point(self, marker: MarkerRef) -> PointMotion:
        """The motion of a marker of an instance or of the ground."""
        of_body = self.ground if marker.body == GROUND else self.instances[marker.body].points
        return of_body[marker.marker]

    def reaction(self, joint: str) -> Resultant:
        """The force and torque that a joint with its drive exerts on body 2; the torque is about the second marker."""
        joints = [j.joint for j in self.joints] + [j.joint for j in self.eliminated_joints]
        second = next(j.second for j in joints if j.name == joint)
        for instance in self.joints:
            if instance.joint.name == joint:
                return self._joint(instance, lambda marker: marker == second, self.position(second))
        support = self.eliminated_joint(joint)
        own = support.own
        on_body = self._support(support)
        on_second = on_body if own == second else -on_body
        return on_second.about(self.position(own), self.position(second))

    def loads(self, part: Part, about: sp.Matrix, without: str = "") -> Resultant:
        """The forces at markers, springs and joints, but for the joint `without`, that act on a part."""
        result = NOTHING
        for force in self.forces:
            result += self.force_on(force, part, about)
        for joint in self.joints:
            result += self._joint(joint, part, about)
        for support in self.eliminated_joints:
            if support.joint.name != without and part(support.known):
                at = self.position(support.own)
                result += (-self._support(support)).about(at, about)
        return result

    def force_on(self, force: ForceInstance, part: Part, about: sp.Matrix) -> Resultant:
        """The force and torque that a force, a torque or a spring exerts on a part; the torque is about `about`."""
        points = tuple(self._displaced(marker, part, about) for marker in force.markers)
        made = force.type.generalised_force(force.element, points, force.values, _VIRTUAL)
        totals = [-sp.Add(*(term.expr for term in made.terms if term.row == row.name)) for row in _VIRTUAL]
        return _resultant(totals)

    def virtual_work(self, force: str) -> GeneralisedForce:
        """The virtual work of a force on the rows of the mechanism, by its name, and what it stores and dissipates."""
        return next(made for of, made in zip(self.forces, self.generalised, strict=True) if of.element.name == force)

    def power(self, force: ForceInstance) -> sp.Expr:
        """The power of a force, a torque or a spring (W): its virtual work on the actual velocities."""
        rate = _VIRTUAL[0].a
        points = []
        for marker in force.markers:
            at = self.point(marker)
            accelerations = sp.ImmutableMatrix(at.velocity * rate)
            points.append(replace(at, acceleration=accelerations, angular_acceleration=at.angular_velocity * rate))
        made = force.type.generalised_force(force.element, tuple(points), force.values, _VIRTUAL[:1])
        return sp.expand(-sp.Add(*(term.expr for term in made.terms)))

    def inertia(self, body: str, about: sp.Matrix) -> Resultant:
        """The rate of change of momentum of an instance, less its weight."""
        instance = self.instances[body]
        force = sp.Matrix(instance.free_residual[:2])
        return Resultant(force, instance.free_residual[2]).about(sp.Matrix(instance.origin), about)

    def drive_force(self, drive: Drive) -> sp.Expr:
        """The force or the torque on body 2 by which a drive prescribes the relative coordinate of its joint."""
        for constraint in self.constraints:
            if constraint.shown == drive.name:
                return constraint.multiplier
        joint = self.eliminated_joint(drive.joint)
        second, reaction = joint.joint.second, self.reaction(drive.joint)
        factors = self._factors(joint.joint, joint.type, lambda marker: marker == second, self.position(second), True)
        unknown = sp.Matrix(factors).T.LUsolve(sp.Matrix([*reaction.force, reaction.torque]))
        return sp.expand(unknown[-1])

    def eliminated_joint(self, name: str) -> EliminatedJoint:
        """A joint that has eliminated coordinates, by its name."""
        return next(joint for joint in self.eliminated_joints if joint.joint.name == name)

    def position(self, marker: MarkerRef) -> sp.Matrix:
        """The position of a marker in the inertial frame."""
        return sp.Matrix(self.point(marker).position)

    def _support(self, support: EliminatedJoint) -> Resultant:
        """The force of a joint that has eliminated coordinates on its supported body; torque about its marker."""
        body, about = support.own.body, self.position(support.own)
        loads = self.loads(lambda marker: marker.body == body, about, without=support.joint.name)
        return self.inertia(body, about) + -loads

    def _joint(self, instance: JointInstance, part: Part, about: sp.Matrix) -> Resultant:
        """The force and torque that a joint with multipliers, and its drive, exert on a part."""
        joint = instance.joint
        if part(joint.first) == part(joint.second):
            return NOTHING
        own = [c.multiplier for c in self.constraints if c.of == joint.name]
        factors = self._factors(joint, instance.type, part, about, instance.drive is not None)
        return _resultant(list(sp.Matrix(factors).T * sp.Matrix(own)))

    def _factors(
        self, joint: Joint, joint_type: JointType, part: Part, about: sp.Matrix, driven: bool
    ) -> list[list[sp.Expr]]:
        """The factors of each multiplier of a joint in the resultant on a part; the multiplier of its drive is last."""
        ends = (self._displaced(marker, part, about) for marker in (joint.first, joint.second))
        made = joint_type.equations(joint, RelativeMotion(*ends))
        accelerations = [residual[2] for residual in made.residuals]
        if driven:
            assert made.driven is not None
            accelerations.append(made.driven[2])
        return [[sp.expand(a).coeff(row.a) for row in _VIRTUAL] for a in accelerations]

    def _displaced(self, marker: MarkerRef, part: Part, about: sp.Matrix) -> PointMotion:
        """The motion of a marker whose acceleration is replaced by the virtual displacement of the part."""
        at = self.point(marker)
        if not part(marker):
            still = sp.ImmutableMatrix([0, 0])
            return replace(at, acceleration=still, angular_acceleration=sp.S.Zero)
        first, second, rotation = (row.a for row in _VIRTUAL)
        lever = sp.Matrix(at.position) - about
        displacement = sp.ImmutableMatrix([first - rotation * lever[1], second + rotation * lever[0]])
        return replace(at, acceleration=displacement, angular_acceleration=rotation)


def _resultant(totals: list[sp.Expr]) -> Resultant:
    first, second, torque = totals
    return Resultant(sp.Matrix([first, second]), torque)
