"""The outputs of a scene in space: what they are called, and their expressions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from derive.mechanics.multibody.instances import InstanceEquations
from derive.mechanics.multibody.joints.joint_type import PrescribedMotion
from derive.mechanics.multibody.outputs.energies import material_damping
from derive.mechanics.multibody.space.constraints import lead
from derive.mechanics.multibody.space.forces import ActionLoads, MarkerLoad, moved_to
from derive.mechanics.multibody.space.frame_motion import FrameMotion, dot
from derive.mechanics.multibody.space.joint_motion import JointMotion
from derive.mechanics.multibody.space.joints import Freedom, SpatialEliminatedJoint, SpatialJointInstance
from derive.mechanics.terms import OutputEquation
from derive.registry import Registry
from derive.spec.model.instances import identifier, joined
from derive.spec.model.keys import Key, KeyType
from derive.spec.model.markers import MarkerRef
from derive.spec.model.ports import SceneOutput
from derive.spec.model.spatial_forces import SpatialJointLoad, SpatialJointTorque, SpatialSpring
from derive.spec.model.spatial_scene import SpatialJoint, SpatialScene

AXES = (1, 2, 3)


@dataclass(frozen=True)
class SpatialParts:
    """The sources of outputs: the scene, its frames and instances, and the loads of actions and joints.

    joint_loads: of each joint that is a constraint, its multipliers as loads on both bodies. supports: of each joint
    that has eliminated coordinates, the marker of the body that it supports. joints: all of them by their names.
    drive_multipliers: of each drive that is a constraint, its multiplier. motion: that of a joint by its name.
    gear_loads: those of all gears.
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
    gear_loads: tuple[MarkerLoad, ...]

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
        of_elements = (*(a.loads for a in self.actions), *self.joint_loads.values(), self.gear_loads)
        every = [load for of in of_elements for load in of]
        for other, marker in self.supports.items():
            joint = self.joint(other)
            known = joint.first if marker == joint.second else joint.second
            if other != name and known.body == own.body:
                f, m = self._support(marker, other)
                every.append(MarkerLoad(known, *_about_other(MarkerLoad(marker, -f, -m), self.at, known)))
        for load in every:
            if load.marker.body == own.body:
                f, m = moved_to(load, sp.Matrix(self.at(load.marker).position), about)
                force, torque = force - f, torque - m
        return force, torque


def _about_other(
    load: MarkerLoad, at: Callable[[MarkerRef], FrameMotion], new: MarkerRef
) -> tuple[sp.Matrix, sp.Matrix]:
    return moved_to(load, sp.Matrix(at(load.marker).position), sp.Matrix(at(new).position))


@dataclass(frozen=True)
class SpatialComponent:
    """A number that an output consists of, see OutputComponent."""

    label: str
    unit: str
    doc: str
    expr: sp.Expr


@dataclass(frozen=True)
class SpatialOutputType:
    """A kind of output in space: a description, the keys of its table, the labels, and the components.

    of_motion: whether it shows the motion of a joint, which not all joints have. counts_inertia: whether it depends on
    the inertia of bodies whose motion is prescribed.
    """

    doc: str
    keys: tuple[Key, ...]
    labels: tuple[str, ...]
    components: Callable[[Mapping[str, Any], SpatialParts], tuple[SpatialComponent, ...]]
    of_motion: bool = False
    counts_inertia: bool = False


MARKER = Key("marker", KeyType.MARKER, "", 'The marker, such as "rod.right".', required=True)
JOINT = Key("joint", KeyType.JOINT, "", "Name of the joint.", required=True)
BETWEEN_MARKERS = Key("between", KeyType.MARKER_PAIR, "", "Two markers.", required=True)
DRIVE = Key("drive", KeyType.DRIVE, "", "Name of the drive.", required=True)
SPRING = Key("spring", KeyType.SPRING, "", "Name of the spring.", required=True)
LOAD = Key("load", KeyType.JOINT_LOAD, "", "Name of a force or a torque in a joint.", required=True)
_LABELS = tuple(map(str, AXES))
_OF_LOAD = (*_LABELS, *(f"torque{k}" for k in AXES))
"""The labels of a force and a torque."""


def _vector(name: str, unit: str, text: str) -> SpatialOutputType:
    def components(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
        vector = getattr(parts.at(values["marker"]), name)
        return tuple(
            SpatialComponent(str(k), unit, f"{text} of {values['marker']} along e{k}", vector[k - 1]) for k in AXES
        )

    return SpatialOutputType(f"{text} of a marker in the inertial frame", (MARKER,), _LABELS, components)


def _joint_coordinate(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    joint = values["joint"]
    of = parts.motion(joint)
    doc = f"relative motion in joint {joint}" + ("" if of.counted else ", a rotation from -pi to pi")
    return (SpatialComponent("", of.freedom.unit, doc, of.motion.value),)


def _joint_speed(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    joint = values["joint"]
    of = parts.motion(joint)
    doc = f"rate of the relative motion in joint {joint}"
    return (SpatialComponent("", f"{of.freedom.unit}/s", doc, of.motion.rate),)


def _distance(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    first, second = (parts.at(marker) for marker in values["between"])
    d = second.position - first.position
    text = f"distance between {values['between'][0]} and {values['between'][1]}"
    return (SpatialComponent("", "m", text, sp.sqrt(dot(d, d))),)


def _energy(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    kinetic, strain, weight = (sp.Add(*(i.energies[k] for i in parts.instances.values())) for k in range(3))
    strain += sp.Add(*(action.potential for action in parts.actions))
    return (
        SpatialComponent("kinetic", "J", "kinetic energy", kinetic),
        SpatialComponent("strain", "J", "strain energy, with that of springs", strain),
        SpatialComponent("gravity", "J", "potential of gravity", weight),
        SpatialComponent("total", "J", "kinetic energy and potentials", kinetic + strain + weight),
    )


def _reaction(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    return _force_and_torque(*parts.reaction(values["joint"]), f"of joint {values['joint']} on body 2 along e")


def _force_and_torque(force: sp.Matrix, torque: sp.Matrix, text: str) -> tuple[SpatialComponent, ...]:
    """The inertial components of a force and a torque; `text` is what follows their noun in descriptions."""
    return (
        *(SpatialComponent(str(k), "N", f"force {text}{k}", force[k - 1]) for k in AXES),
        *(SpatialComponent(f"torque{k}", "N m", f"torque {text}{k}", torque[k - 1]) for k in AXES),
    )


def _drive(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    name = values["drive"]
    _, _, driven = parts.drive(name)
    noun, unit = ("torque", "N m") if driven is Freedom.ROTATION else ("force", "N")
    return (SpatialComponent("", unit, f"{noun} of drive {name} on body 2", parts.drive_force(name)),)


def _spring(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    spring = next(s for s in parts.scene.springs if s.name == values["spring"])
    (action,) = (action for action in parts.actions if action.element == spring)
    load = next(load for load in action.loads if load.marker == spring.second)
    return _force_and_torque(load.force, load.torque, f"of spring {spring.name} on {spring.second} along e")


def _joint_load(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    (action,) = (
        a for a in parts.actions if isinstance(a.element, SpatialJointLoad) and a.element.name == values["load"]
    )
    of, value = action.element, action.value
    unit = "N m" if isinstance(of, SpatialJointTorque) else "N"
    return (
        SpatialComponent("", unit, f"{of.kind} {of.name} on body 2 of its joint", value),
        SpatialComponent("power", "W", f"power of {of.kind} {of.name}", parts.power(action.loads)),
    )


def _power(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    loads = [parts.power(a.loads) for a in parts.actions if not isinstance(a.element, SpatialSpring)]
    driven = [(d.name, parts.drive(d.name)[1].motion[1]) for d in parts.scene.drives]
    drives = [parts.drive_force(name) * speed for name, speed in driven]
    dissipated = sp.Add(*(action.dissipation for action in parts.actions))
    dissipated += sp.Add(*map(material_damping, parts.instances.values()))
    return (
        SpatialComponent("loads", "W", "power of forces and torques", sp.Add(*loads)),
        SpatialComponent("drives", "W", "power of the drives", sp.Add(*drives)),
        SpatialComponent("dissipated", "W", "power of dampers and of material damping", dissipated),
    )


SPATIAL_OUTPUTS: Registry[SpatialOutputType] = Registry(
    "output in space",
    {
        "position": _vector("position", "m", "position"),
        "velocity": _vector("velocity", "m/s", "velocity"),
        "acceleration": _vector("acceleration", "m/s^2", "acceleration"),
        "angular_velocity": _vector("angular_velocity", "rad/s", "angular velocity"),
        "angular_acceleration": _vector("angular_acceleration", "rad/s^2", "angular acceleration"),
        "joint": SpatialOutputType(
            "rotation about z of a joint with parallel z axes, or displacement of a prismatic one",
            (JOINT,),
            ("",),
            _joint_coordinate,
            of_motion=True,
        ),
        "joint_speed": SpatialOutputType("rate of that motion", (JOINT,), ("",), _joint_speed, of_motion=True),
        "distance": SpatialOutputType("distance of two markers", (BETWEEN_MARKERS,), ("",), _distance),
        "energy": SpatialOutputType(
            "kinetic, strain (with springs), gravitational and total energy",
            (),
            ("kinetic", "strain", "gravity", "total"),
            _energy,
            counts_inertia=True,
        ),
        "reaction": SpatialOutputType(
            "what a joint exerts on body 2, with its drive, the torque about the second marker",
            (JOINT,),
            _OF_LOAD,
            _reaction,
            counts_inertia=True,
        ),
        "drive": SpatialOutputType("the torque or the force of a drive", (DRIVE,), ("",), _drive, counts_inertia=True),
        "spring": SpatialOutputType(
            "what a spring with its damper exerts on its second marker, the torque about this marker",
            (SPRING,),
            _OF_LOAD,
            _spring,
        ),
        "joint_load": SpatialOutputType(
            "the force or the torque of a load in a joint, and its power", (LOAD,), ("", "power"), _joint_load
        ),
        "power": SpatialOutputType(
            "power of loads and drives, and dissipation: their sum is the time derivative of the total energy",
            (),
            ("loads", "drives", "dissipated"),
            _power,
            counts_inertia=True,
        ),
    },
)


def spatial_output_equations(outputs: tuple[SceneOutput, ...], parts: SpatialParts) -> tuple[OutputEquation, ...]:
    """The components of all outputs of a scene."""
    equations = []
    for output in outputs:
        for part in SPATIAL_OUTPUTS[output.kind].components(output.values, parts):
            shown = joined(output.name, part.label)
            equations.append(OutputEquation(identifier(shown), shown, part.unit, part.doc, part.expr))
    return tuple(equations)
