"""Groups of varying joints and of gears, with one code each: it computes the constraints from all of their bodies."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from typing import Any

from derive.algebra import sp
from derive.lowering.instances.classes.dimension import AnyJoint, plain_joint
from derive.lowering.instances.classes.gears import CoupledJoints, constraining, gears_of
from derive.lowering.instances.classes.groups import Bodies, Group, GroupElement, fixed_of, group_equations
from derive.lowering.instances.classes.varying_joints import drive_of, varies
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.forces.force_type import GeneralisedForce
from derive.mechanics.multibody.space.first_body_rows import joint_along_first
from derive.mechanics.multibody.space.joints import SpatialJointInstance
from derive.spec.model.markers import MarkerRef


def joint_groups(bodies: Bodies, along_first: bool = False) -> tuple[Group, ...]:
    """The groups of the varying joints that have a body with coordinates; along_first: of all joints."""
    groups: dict[Hashable, list[GroupElement]] = {}
    for number, joint in enumerate(bodies.mechanism.joints):
        names = tuple(marker.body for marker in markers_of(joint) if marker.body in bodies.members)
        if (along_first or varies(joint)) and names:
            ends = tuple(map(bodies.form, markers_of(joint)))
            prescribed = drive_of(joint) if joint.drive and drive_of(joint) == joint.drive else None
            key = joint.type, plain_joint(joint), joint.multipliers, prescribed, ends, fixed_of(bodies, names)
            element = GroupElement(number, tuple(bodies.members[name] for name in names))
            groups.setdefault(key, []).append(element)
    joints = tuple(Group("joint", tuple(members), along_first) for members in groups.values())
    return (*joints, *_gear_groups(bodies))


def _gear_groups(bodies: Bodies) -> Iterator[Group]:
    """Yield the groups of the gears that have a body with coordinates."""
    groups: dict[Hashable, list[GroupElement]] = {}
    for number, gear in enumerate(gears_of(bodies.mechanism), len(bodies.mechanism.joints)):
        if names := gear.bodies:
            order = tuple(names.index(m.body) if m.body in names else -1 for m in gear.markers)
            key = gear.form, order, tuple(map(bodies.form, gear.markers)), fixed_of(bodies, names)
            element = GroupElement(number, tuple(bodies.members[name] for name in names))
            groups.setdefault(key, []).append(element)
    yield from (Group("gear", tuple(members)) for members in groups.values())


def joint_equations(bodies: Bodies, group: Group) -> tuple[Equations, tuple[sp.Expr, ...]]:
    """The equations of the first joint or gear of a group: its constraints, with the drive of `drive_of`.

    The multipliers follow if the rows are along the axes of its first body: from those of these rows.
    """
    joint = constraining(bodies.mechanism)[group.first.number]
    own = {m.instance.name: bodies.equations(m.instance.name) for m in group.first.bodies}
    rows = tuple(row for body in own.values() for row in body.rows)

    def at(marker: MarkerRef) -> Any:
        return own[marker.body].motions[marker.marker] if marker.body in own else bodies.known.point(marker)

    if isinstance(joint, CoupledJoints):
        return group_equations(bodies, own, GeneralisedForce((), ()), conditions=(joint.constraint(at, rows),)), ()
    first, second = map(at, markers_of(joint))
    if group.along_first and isinstance(joint, SpatialJointInstance):
        of = joint_along_first(joint, first, second, rows)
        force = GeneralisedForce((), of.definitions)
        return group_equations(bodies, own, force, conditions=of.constraints), of.reactions
    definitions, conditions = joint.constraints(first, second, drive_of(joint), rows)
    return group_equations(bodies, own, GeneralisedForce((), definitions), conditions=conditions), ()


def markers_of(joint: AnyJoint) -> tuple[MarkerRef, MarkerRef]:
    """The first and the second marker of a joint."""
    return joint.joint.first, joint.joint.second
