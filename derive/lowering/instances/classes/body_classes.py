"""The classes of the bodies of a mechanism: bodies of a class have one code, and differ in numbers alone."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate

from derive.algebra import sp
from derive.lowering.instances.classes.dimension import AnyJoint, plain_joint
from derive.lowering.instances.classes.force_numbers import (
    ForceForm,
    Place,
    differing_constants,
    differing_places,
    force_form,
    moving_bodies,
)
from derive.lowering.instances.classes.gears import Constraining, CoupledJoints, constraining, gears_of
from derive.mechanics.multibody.bodies.body_type import CrossSection
from derive.mechanics.multibody.kinds import BodyInstance
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.multibody.space.mechanism import AnyMechanism
from derive.mechanics.terms import ModelConstant
from derive.spec.model.instances import identifier, instance_parts
from derive.spec.model.markers import GROUND

NO_JOINT = -1
"""The number of the joint at a handle that the members of a class have, besides this one."""


@dataclass(frozen=True)
class Handle:
    """A joint at a marker of a body: its number among the joints and gears, and the number of the body at it.

    A body has one handle at a gear, and no marker there.
    """

    joint: int
    side: int
    marker: str
    is_gear: bool = False

    @property
    def is_first(self) -> bool:
        """Whether the body is the first one of the joint."""
        return self.side == 0


@dataclass(frozen=True)
class Member:
    """A body of a class: its number in the mechanism, its joints, and the forces on it.

    coordinate: the index of its first coordinate; row: that of its first equation of motion, and velocity; differing:
    for each force the places of the numbers in which the members of the class differ.
    """

    number: int
    instance: BodyInstance
    handles: tuple[Handle, ...]
    forces: tuple[ForceForm, ...]
    coordinate: int
    row: int
    differing: tuple[tuple[Place, ...], ...] = ()

    @property
    def of_body(self) -> tuple[ModelConstant, ...]:
        """The constants of the body and of its cross-sections, in the same order for all members of a class."""
        component = self.instance.component
        return (*component.body.constants, *component.point_constants)

    @property
    def of_forces(self) -> tuple[ModelConstant, ...]:
        """The numbers of the forces on the body in which the members of the class differ."""
        return differing_constants(self.forces, self.differing)

    @property
    def constants(self) -> tuple[ModelConstant, ...]:
        """All of its constants, in the same order for all members of a class."""
        return (*self.of_body, *self.of_forces)


@dataclass(frozen=True)
class BodyClass:
    """Bodies with coordinates that differ in the values of their constants alone.

    leading: the member after which the class and its symbols are named, and which has all handles; is_joined: whether
    some of the others do not, see `joined_classes.py`. along_first: whether the rows of its joints are along the axes
    of their first bodies, see `first_body_joints.py`, so that all of these joints vary.
    """

    members: tuple[Member, ...]
    leading: int = 0
    is_joined: bool = False
    along_first: bool = False

    @property
    def first(self) -> Member:
        """The leading member."""
        return self.members[self.leading]

    @property
    def name(self) -> str:
        """The name of the class in the generated code."""
        name = identifier(self.first.instance.name)
        joined = f"joined_{name}" if self.is_joined else name
        return f"{joined}_along_first" if self.along_first else joined


def body_classes(mechanism: AnyMechanism) -> tuple[BodyClass, ...]:
    """The classes of the bodies that have coordinates, in the order of their first members."""
    handles: dict[str, list[Handle]] = {instance.name: [] for instance in mechanism.instances}
    joints: Sequence[AnyJoint] = mechanism.joints
    for number, joint in enumerate(joints):
        for side, marker in enumerate((joint.joint.first, joint.joint.second)):
            if marker.body != GROUND:
                handles[marker.body].append(Handle(number, side, marker.marker))
    for number, gear in enumerate(gears_of(mechanism), len(joints)):
        for side, name in enumerate(gear.bodies):
            handles[name].append(Handle(number, side, "", is_gear=True))
    forces: dict[str, list[ForceForm]] = {instance.name: [] for instance in mechanism.instances}
    if isinstance(mechanism, Mechanism):  # in space groups have all of them
        for force in mechanism.forces:
            bodies = moving_bodies(mechanism, force)
            if len(bodies) == 1:
                forces[bodies[0]].append(force_form(mechanism, force))
    classes: dict[Hashable, list[Member]] = {}
    for number, (instance, *firsts) in enumerate(zip(mechanism.instances, *_firsts(mechanism), strict=False)):
        if instance.moves:
            name = instance.name
            member = Member(number, instance, tuple(handles[name]), tuple(forces[name]), firsts[0], firsts[1])
            classes.setdefault(_key(member, mechanism), []).append(member)
    return tuple(BodyClass(with_forces(members)) for members in classes.values())


def _firsts(mechanism: AnyMechanism) -> tuple[Iterator[int], Iterator[int]]:
    """The indices of the first coordinate and of the first equation of motion of each body."""
    maps = [instance.coordinates for instance in mechanism.instances]
    return accumulate((len(of.coordinates) for of in maps), initial=0), accumulate(
        (len(of.rows) for of in maps), initial=0
    )


def with_forces(members: Sequence[Member]) -> tuple[Member, ...]:
    """The members of a class with the places of the numbers of forces in which they differ.

    Members have no forces where these have different forms: groups of forces then add them to the bodies.
    """
    if len({*map(force_keys, members)}) > 1:
        return tuple(replace(member, forces=()) for member in members)
    differing = differing_places([member.forces for member in members])
    return tuple(replace(member, differing=differing) for member in members)


def force_keys(member: Member) -> tuple[Hashable, ...]:
    """The forms of the forces on a member."""
    return tuple(force.key for force in member.forces)


def handles_of(members: Iterable[Member]) -> tuple[list[list[tuple[int, bool]]], list[list[int]]]:
    """For each body the numbers of its joints, with whether it is their first body, and of its gears."""
    own = [member.handles for member in members]
    joints = [[(h.joint, h.is_first) for h in handles if not h.is_gear] for handles in own]
    return joints, [[h.joint for h in handles if h.is_gear] for handles in own]


def marker_classes(mechanism: AnyMechanism) -> dict[str, BodyClass]:
    """The classes of the bodies with markers, whose joints and forces do not matter, by their names.

    The name is that of the table whose instances they are, if they are all of them, and else that of the first body.
    """
    classes: dict[Hashable, list[Member]] = {}
    for number, (instance, *firsts) in enumerate(zip(mechanism.instances, *_firsts(mechanism), strict=False)):
        if instance.moves and instance.component.markers:
            member = Member(number, instance, (), (), firsts[0], firsts[1])
            classes.setdefault(_key(member, mechanism), []).append(member)
    tables = [{instance_parts(m.instance.component.specified).table for m in members} for members in classes.values()]
    result = {}
    for own, members in zip(tables, classes.values(), strict=True):
        (table, *others) = own
        whole = table and not others and sum(table in of for of in tables) == 1
        name = table if whole else identifier(members[0].instance.name)
        result[name] = BodyClass(tuple(members))
    return result


def _key(member: Member, mechanism: AnyMechanism) -> Hashable:
    """All that the code of a body depends on, besides numbers and the forces on it."""
    of = constraining(mechanism)
    return body_key(member), tuple(_of_handle(member, h, of[h.joint]) for h in member.handles)


def _of_handle(member: Member, h: Handle, of: Constraining) -> Hashable:
    """All that a body's rows of a joint or of a gear depend on, besides its motion and numbers."""
    if isinstance(of, CoupledJoints):
        own = tuple(marker.marker if marker.body == member.instance.name else None for marker in of.markers)
        return h.side, own, of.form
    return h.side, h.marker, of.type, of.multipliers, plain_joint(of)  # a drive adds a multiplier


def body_key(member: Member) -> Hashable:
    """All that the code of a body without its joints depends on, besides numbers and the forces on it."""
    instance = member.instance
    component = instance.component
    if instance.coordinates.reason:
        return instance.name  # what it follows is known, and is written out for this body
    sections = tuple((name, _without_values(section)) for name, section in component.sections.items())
    return instance.kind, component.markers, sections, fixed_values(member.of_body)


def fixed_values(constants: Iterable[ModelConstant]) -> tuple[sp.Expr | None, ...]:
    """The values of constants that depend on parameters, in which the members of a class do not differ."""
    return tuple(None if c.value.is_Rational else c.value for c in constants)


def _without_values(section: CrossSection) -> CrossSection:
    def plain(constants: tuple[ModelConstant, ...]) -> tuple[ModelConstant, ...]:
        return tuple(replace(c, value=sp.S.Zero) for c in constants)

    point = replace(section.point, coefficients=plain(section.point.coefficients))
    return replace(section, point=point, rotations=plain(section.rotations), stresses=())
