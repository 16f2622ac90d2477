"""The classes of the bodies of a mechanism: bodies of a class have one code, and differ in numbers alone."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
from itertools import accumulate

import sympy as sp

from derive.mechanics.multibody.bodies.body_type import CrossSection
from derive.mechanics.multibody.joints.relative_rows import Axes
from derive.mechanics.multibody.kinds import BodyInstance, JointInstance
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.terms import ModelConstant
from derive.spec.model.markers import GROUND, MarkerRef


@dataclass(frozen=True)
class Handle:
    """A joint at a marker of a body: its number among the constraints, and whether the body is its first one."""

    joint: int
    is_first: bool
    marker: str


@dataclass(frozen=True)
class Member:
    """A body of a class: its number in the mechanism, its joints, and the indices of its first coordinate and row."""

    number: int
    instance: BodyInstance
    handles: tuple[Handle, ...]
    coordinate: int

    @property
    def constants(self) -> tuple[ModelConstant, ...]:
        """The constants of the body and of its cross-sections, in the same order for all members of a class."""
        component = self.instance.component
        return (*component.body.constants, *component.point_constants)


@dataclass(frozen=True)
class BodyClass:
    """Bodies with coordinates that differ in the values of their constants alone."""

    members: tuple[Member, ...]

    @property
    def first(self) -> Member:
        """The member after which the class and its symbols are named."""
        return self.members[0]

    @property
    def name(self) -> str:
        """The name of the class in the generated code."""
        return self.first.instance.name


def obstacle(mechanism: Mechanism) -> str:
    """The reason why a mechanism cannot be lowered to loops over its instances; empty if it can be."""
    if mechanism.parameters:
        return "it has parameters"
    if mechanism.forces or mechanism.dampings:
        return "it has forces, springs or damping between pieces"
    if mechanism.outputs or mechanism.scene.inputs:
        return "it has inputs or outputs"
    if any(not instance.moves or instance.coordinates.definitions for instance in mechanism.instances):
        return "the motion of a body is prescribed"
    if any(instance.coordinates.reason for instance in mechanism.instances):
        return "a joint eliminates coordinates"
    for joint in mechanism.joints:
        if joint.type.axes is not Axes.INERTIAL or not set(joint.type.removes) <= set(joint.type.axes.rows):
            return f"the axes of joint {joint.joint.name} move"
        if joint.drive is not None:
            return f"drive {joint.drive.name} acts between bodies"
    return ""


def body_classes(mechanism: Mechanism) -> tuple[BodyClass, ...]:
    """The classes of the bodies that have coordinates, in the order of their first members."""
    handles: dict[str, list[Handle]] = {instance.name: [] for instance in mechanism.instances}
    for number, joint in enumerate(mechanism.joints):
        for marker, is_first in ((joint.joint.first, True), (joint.joint.second, False)):
            if marker.body != GROUND:
                handles[marker.body].append(Handle(number, is_first, marker.marker))
    sizes = [len(instance.coordinates.rows) for instance in mechanism.instances]
    firsts = [0, *accumulate(sizes)]
    classes: dict[Hashable, list[Member]] = {}
    for number, instance in enumerate(mechanism.instances):
        member = Member(number, instance, tuple(handles[instance.name]), firsts[number])
        classes.setdefault(_key(member, mechanism.joints), []).append(member)
    return tuple(BodyClass(tuple(members)) for members in classes.values())


def _key(member: Member, joints: tuple[JointInstance, ...]) -> Hashable:
    """All that the code of a body depends on, besides numbers."""
    component = member.instance.component
    sections = tuple((name, _without_values(section)) for name, section in component.sections.items())
    at = tuple((h.is_first, h.marker, joints[h.joint].type, _plain(joints[h.joint])) for h in member.handles)
    return member.instance.kind, component.markers, sections, at


def _plain(joint: JointInstance) -> Hashable:
    nowhere = MarkerRef(GROUND, "")
    return replace(joint.joint, name="", first=nowhere, second=nowhere)


def _without_values(section: CrossSection) -> CrossSection:
    def plain(constants: tuple[ModelConstant, ...]) -> tuple[ModelConstant, ...]:
        return tuple(replace(c, value=sp.S.Zero) for c in constants)

    point = replace(section.point, coefficients=plain(section.point.coefficients))
    return CrossSection(point, plain(section.rotations))
