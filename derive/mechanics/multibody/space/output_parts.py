"""The parts of outputs of a scene in space: their sources, components, and the declaration of a kind of output."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from derive.algebra import sp
from derive.mechanics.motion.vectors import dot
from derive.mechanics.multibody.space.constraints import lead
from derive.mechanics.multibody.space.forces import ActionLoads, MarkerLoad, moved_to
from derive.mechanics.multibody.space.joints import Freedom, SpatialEliminatedJoint, SpatialJointInstance
from derive.spec.model.keys import Key
from derive.spec.model.markers import MarkerRef
from derive.spec.model.spatial_scene import SpatialJoint, SpatialScene

if TYPE_CHECKING:
    from derive.mechanics.multibody.instances import InstanceEquations
    from derive.mechanics.multibody.joints.joint_type import PrescribedMotion
    from derive.mechanics.multibody.space.frame_motion import FrameMotion
    from derive.mechanics.multibody.space.joint_motion import JointMotion
    from derive.mechanics.terms import ModelConstant


@dataclass(frozen=True)
class SpatialParts:
    """The sources of outputs: the scene, its frames and instances, and the loads of actions and joints.

    joint_loads: of each joint that is a constraint, its multipliers as loads on both bodies. supports: of each joint
    that has eliminated coordinates, the marker of the body that it supports. joints: all of them by their names.
    drive_multipliers: of each drive that is a constraint, its multiplier. motion: that of a joint by its name.
    gear_loads: those of gears on a body, by its name. dissipations: the powers of dampings between components, W.
    sections: those of beams that outputs have asked for so far, as several outputs of a section have its equilibrium in
    common.
    """

    scene: SpatialScene
    at: Callable[[MarkerRef], FrameMotion]
    instances: Mapping[str, InstanceEquations]
    actions: tuple[ActionLoads, ...]
    joint_loads: Mapping[str, tuple[MarkerLoad, ...]]
    supports: Mapping[str, MarkerRef]
    joints: Mapping[str, SpatialJointInstance | SpatialEliminatedJoint]
    drive_multipliers: Mapping[str, sp.Expr]
    motion: Callable[[str], JointMotion]
    gear_loads: Callable[[str], Iterable[MarkerLoad]]
    dissipations: Iterable[sp.Expr]
    sections: dict[tuple[MarkerRef, bool], Any] = field(default_factory=dict)

    def joint(self, name: str) -> SpatialJoint:
        """A joint by its name, with its constants as expressions."""
        joint: SpatialJoint = self.joints[name].joint
        return joint

    def drive(self, name: str) -> tuple[SpatialJointInstance | SpatialEliminatedJoint, PrescribedMotion, Freedom]:
        """The joint of a drive, the motion that the drive prescribes, and which motion of the joint that is."""
        (joint,) = (of for of in self.joints.values() if of.drive and of.drive.name == name)
        assert joint.drive is not None and joint.type.driven is not None, "the specification refuses other drives"
        return joint, joint.drive, joint.type.driven

    def drive_force(self, name: str) -> sp.Expr:
        """The torque, or the force, by which a drive prescribes the motion of its joint, on body 2.

        Where the joint has eliminated coordinates it is the virtual work of the reaction on the motion that the drive
        prescribes, since the joint itself does none: about z, along z, or on a thread both.
        """
        if name in self.drive_multipliers:
            return self.drive_multipliers[name]
        joint, _, driven = self.drive(name)
        axis = self.at(joint.joint.first).axes[:, 2]
        force, torque = self.reaction(joint.joint.name)
        if driven is Freedom.DISPLACEMENT:
            return dot(axis, force)
        return dot(axis, torque) + lead(joint.joint) * dot(axis, force)

    def power(self, loads: tuple[MarkerLoad, ...]) -> sp.Expr:
        """The power (W) of loads: their virtual work on the velocities."""
        frames = [(load, self.at(load.marker)) for load in loads]
        return sp.Add(*(dot(of.force, f.velocity) + dot(of.torque, f.angular_velocity) for of, f in frames))

    def reaction(self, name: str) -> tuple[sp.Matrix, sp.Matrix]:
        """The force and the torque of a joint, with its drive, on body 2; the torque is about the second marker."""
        joint = self.joint(name)
        if name in self.joint_loads:
            load = next(load for load in self.joint_loads[name] if load.marker == joint.second)
            return load.force, load.torque
        own = self.supports[name]
        force, torque = self._support(own, name)
        if own == joint.second:
            return force, torque
        old, new = (sp.Matrix(self.at(marker).position) for marker in (own, joint.second))
        return moved_to(MarkerLoad(own, -force, -torque), old, new)

    def _support(self, own: MarkerRef, name: str) -> tuple[sp.Matrix, sp.Matrix]:
        """The load of an eliminated joint on the body it supports, about its marker there, which is the origin O.

        It is what the equations of the free body lack besides all other loads.
        """
        instance, about = self.instances[own.body], sp.Matrix(self.at(own).position)
        force = sp.Matrix(instance.free_residual[:3])
        torque = sp.Matrix(self.at(own).frame) * sp.Matrix(instance.free_residual[3:6])
        for load in self.loads_on(own.body, without=name):
            f, m = moved_to(load, sp.Matrix(self.at(load.marker).position), about)
            force, torque = force - f, torque - m
        return force, torque

    def loads_on(self, body: str, without: str = "") -> Iterator[MarkerLoad]:
        """Yield all loads on a body at its markers: those of forces, springs, gears and joints but for one of these."""
        for action in self.actions:
            yield from action.on(body)
        for name, of in self.joints.items():
            if name in self.joint_loads and body in (of.joint.first.body, of.joint.second.body):
                yield from (load for load in self.joint_loads[name] if load.marker.body == body)
        yield from self.gear_loads(body)
        for name, marker in self.supports.items():
            joint = self.joint(name)
            known = joint.first if marker == joint.second else joint.second
            if name != without and known.body == body:
                f, m = self._support(marker, name)
                yield MarkerLoad(known, *_about_other(MarkerLoad(marker, -f, -m), self.at, known))


def _about_other(
    load: MarkerLoad, at: Callable[[MarkerRef], FrameMotion], new: MarkerRef
) -> tuple[sp.Matrix, sp.Matrix]:
    return moved_to(load, sp.Matrix(at(load.marker).position), sp.Matrix(at(new).position))


@dataclass(frozen=True)
class SpatialComponent:
    """A number that an output consists of, see OutputComponent.

    constants: those in it that the equations of motion do not have; components may have them in common.
    """

    label: str
    unit: str
    doc: str
    expr: sp.Expr
    constants: tuple[ModelConstant, ...] = ()


@dataclass(frozen=True)
class SpatialOutputType:
    """A kind of output in space: a description, the keys of its table, the labels, and the components.

    of_motion: whether it shows the motion of a joint, which not all joints have. counts_inertia: whether it depends on
    the inertia of bodies whose motion is prescribed. adds: whether each component is a sum over the bodies, the actions
    and the drives, of terms that depend on one of them. of_numbers: whether components contain numbers of a body for
    which its equations have no symbols: stresses, and integrals along a part of a beam.
    """

    doc: str
    keys: tuple[Key, ...]
    labels: tuple[str, ...]
    components: Callable[[Mapping[str, Any], SpatialParts], tuple[SpatialComponent, ...]]
    of_motion: bool = False
    counts_inertia: bool = False
    adds: bool = False
    of_numbers: bool = False
