"""The tables of the elements of a scene: joints, drives, forces, torques, springs, inputs and outputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from derive.mechanics.multibody.forces.registry import DEFAULT_KINDS, FORCES, kinds
from derive.mechanics.multibody.joints.joint_type import JointType
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.outputs.registry import OUTPUTS
from derive.mechanics.multibody.space.joints import SpatialJointType
from derive.spec.model.documentation import purpose
from derive.spec.model.forces import Force, SceneForce, Spring, Torque
from derive.spec.model.instances import COUNT
from derive.spec.model.joints import CustomJoint, Drive, Joint, JointInitialValues
from derive.spec.model.keys import KeyType, declared_keys
from derive.spec.model.ports import SceneOutput
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene import NAMED, SceneInput
from derive.spec.model.spatial_scene import SpatialJoint
from derive.spec.parsing.values import WrongValueError
from derive.spec.tables.declared_tables import DeclaredTable, declare
from derive.spec.tables.registered_tables import Declares, registered_table

ELEMENTS: dict[str, type] = {"forces": Force, "torques": Torque, "springs": Spring}
"""The frozen type whose markers and description the elements of a section have."""


def _check_input(given: SceneInput) -> None:
    if given.function is not None and given.function.kind == "input":
        raise WrongValueError("the value of an input is a number or a function of t, not another input")


def _drive(motion: Any = None, speed: Any = None, **given: Any) -> Drive:
    if (motion is None) == (speed is None):
        raise WrongValueError('write either motion = "0.1*sin(2*pi*t)", a function of t, or speed = 150')
    if motion is not None and "offset" in given:
        raise WrongValueError("`offset` goes with `speed`; add it to `motion` instead")
    return Drive(motion=motion, speed=speed, **given)


declare(JointInitialValues, "JointStartTable")
declare(Drive, "DriveTable", make=_drive, keys=(*declared_keys(Drive), COUNT))
declare(SceneInput, "InputTable", check=_check_input, keys=(*declared_keys(SceneInput), COUNT))


def speed_unit(joint_type: JointType | SpatialJointType | None) -> str | None:
    """The unit of the speed of a drive of a joint of some type; None if there is no such drive."""
    driven = joint_type.driven if joint_type else None
    return f"{driven.unit}/s" if driven else None


def with_speed_units(
    drives: tuple[Drive, ...],
    joints: tuple[Joint, ...] | tuple[SpatialJoint, ...],
    types: Mapping[str, JointType] | Mapping[str, SpatialJointType],
) -> tuple[Drive, ...]:
    """The drives with the units of their speeds, where these are parameters without units."""
    kinds = {joint.name: joint.kind for joint in joints}

    def with_unit(drive: Drive) -> Drive:
        if not isinstance(drive.speed, Parameter) or drive.speed.unit:
            return drive
        return replace(drive, speed=replace(drive.speed, unit=speed_unit(types[kinds[drive.joint]]) or ""))

    return tuple(with_unit(drive) for drive in drives)


OF_KIND = ("angle", "axis")
"""The fields of a joint that are keys of some kinds of joints alone."""


def joint_table() -> DeclaredTable:
    """The table of a joint, with the kinds and keys of all joints that are registered now."""
    keys = tuple(key for key in declared_keys(Joint) if key.field not in OF_KIND)
    return registered_table("JointTable", purpose(Joint), "joint", (*JOINTS.items(),), (*keys, COUNT), _joint)


def _joint(kind: str, own: Mapping[str, Any], given: dict[str, Any]) -> Joint:
    first, second = own["first"]
    fields = {key: given.pop(key) for key in OF_KIND if key in given}
    if given:
        return CustomJoint("", kind, first, second, values=given, start=own["start"], **fields)
    return Joint("", kind, first, second, start=own["start"], **fields)


def force_table(section: str) -> DeclaredTable:
    """The table of an element of a section, with all kinds that are registered now."""
    of = ELEMENTS[section]
    keys = tuple(key for key in declared_keys(of) if key.type in (KeyType.MARKER, KeyType.MARKER_PAIR))
    types = (*kinds(section).items(),)
    return registered_table(
        f"{of.__name__}Table", purpose(of), NAMED[section], types, (*keys, COUNT), _force, DEFAULT_KINDS[section]
    )


def _force(kind: str, own: Mapping[str, Any], given: dict[str, Any]) -> SceneForce:
    force_type = FORCES[kind]
    for key, value in given.items():
        if key in force_type.lengths and (value.default if isinstance(value, Parameter) else value) < 0:
            raise WrongValueError(f"`{key}` is a length, zero or more; only that of a rotational spring has a sign")
    markers = tuple(marker for value in own.values() for marker in (value if isinstance(value, tuple) else (value,)))
    return force_type.element("", kind, markers, given)


def output_table(title: str = "OutputTable", types: Mapping[str, Declares] = OUTPUTS) -> DeclaredTable:
    """The table of an output, with the kinds and keys of all outputs that are registered now."""
    return registered_table(title, purpose(SceneOutput), "output", (*types.items(),), (COUNT,), _output)


def _output(kind: str, own: Mapping[str, Any], given: dict[str, Any]) -> SceneOutput:
    return SceneOutput("", kind, given)
