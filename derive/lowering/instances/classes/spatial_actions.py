"""Forces, torques and springs in space in groups that have one code, each with the bodies of its markers.

Numbers belong to the code here: actions that differ in them are in groups of their own.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import fields

from derive.algebra import sp
from derive.lowering.instances.classes.dimension import plain_joint
from derive.lowering.instances.classes.force_numbers import moving_bodies
from derive.lowering.instances.classes.groups import (
    Bodies,
    Group,
    GroupElement,
    damping_groups,
    fixed_of,
    group_equations,
)
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.forces.force_type import GeneralisedForce
from derive.mechanics.multibody.space.frame_motion import FrameMotion
from derive.mechanics.multibody.space.mechanism import SpatialActionInstance, SpatialMechanism
from derive.spec.model.markers import MarkerRef


def action_groups(bodies: Bodies) -> Iterator[tuple[Group, Equations]]:
    """Yield the groups of the actions on bodies with coordinates, and of damping, with the equations of the first."""
    groups: dict[Hashable, list[GroupElement]] = {}
    for number, force in enumerate(bodies.mechanism.forces):
        names = moving_bodies(bodies.mechanism, force)
        if names:
            element = GroupElement(number, tuple(bodies.members[name] for name in names))
            groups.setdefault(action_key(bodies, force, names), []).append(element)
    for members in groups.values():
        group = Group("force", tuple(members))
        yield group, _equations(bodies, group)
    yield from damping_groups(bodies)


def action_key(bodies: Bodies, force: SpatialActionInstance, names: tuple[str, ...]) -> Hashable:
    """All that the code of an action depends on, besides the numbers of its bodies."""
    element, values = force.element, force.values
    own = ((f.name, getattr(element, f.name)) for f in fields(element))
    plain = tuple((k, v) for k, v in own if k not in ("name", "joint", "values", *values) and not _is_marker(v))
    numbers = tuple((k, v.as_immutable() if isinstance(v, sp.MatrixBase) else v) for k, v in values.items())
    order = tuple(names.index(m.body) if m.body in names else -1 for m in force.markers)
    counted = bodies.mechanism.joint_of(force)
    form = counted and (type(counted), counted.type, plain_joint(counted), counted.drive)
    ends = tuple(map(bodies.end, force.markers))
    return type(element), plain, numbers, order, ends, form, fixed_of(bodies, names)


def _is_marker(value: object) -> bool:
    return isinstance(value, MarkerRef) or value is None


def _equations(bodies: Bodies, group: Group) -> Equations:
    """The equations of the first action of a group: its terms on all rows of its bodies."""
    mechanism: SpatialMechanism = bodies.mechanism
    own = {m.instance.name: bodies.equations(m.instance.name) for m in group.first.bodies}
    rows = tuple(row for body in own.values() for row in body.rows)

    def at(marker: MarkerRef) -> FrameMotion:
        motion: FrameMotion = (
            own[marker.body].motions[marker.marker] if marker.body in own else bodies.known.point(marker)
        )
        return motion

    made = mechanism.loads(mechanism.forces[group.first.number], at, rows)
    moving = made.potential.free_symbols & bodies.known.moving_with(made.definitions)
    stored = sp.S.Zero if moving else made.potential  # as energies do not know the time
    return group_equations(bodies, own, GeneralisedForce(made.terms(at, rows), made.definitions, stored))
