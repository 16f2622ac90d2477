"""Elements besides the bodies of classes: forces between two bodies or on some of a class, and damping.

Elements of a group have one code, as bodies of a class have. Their equations contain the definitions of all of their
bodies, in the symbols of the first element.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from derive.algebra import sp
from derive.errors import TisserandError
from derive.lowering.instances.classes.body_classes import BodyClass, Member, body_key, fixed_values
from derive.lowering.instances.classes.force_numbers import (
    ForceForm,
    Place,
    differing_constants,
    differing_places,
    force_form,
    moving_bodies,
)
from derive.lowering.instances.classes.known_motion import KnownMotion, canonical
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.component_damping import damping_force
from derive.mechanics.multibody.forces.force_type import GeneralisedForce
from derive.mechanics.multibody.instances import InstanceEquations, instance_equations
from derive.mechanics.multibody.kinds import ForceInstance
from derive.mechanics.multibody.point_motion import PointMotion
from derive.mechanics.multibody.space.mechanism import AnyMechanism, SpatialMechanism
from derive.mechanics.terms import Constraint, ModelConstant, OutputEquation
from derive.spec.model.joints import Joint
from derive.spec.model.markers import MarkerRef


class NotInLoops(TisserandError):
    """An element depends on more of the mechanism than the bodies that it names."""


@dataclass(frozen=True)
class GroupElement:
    """A force, a damping, a varying joint or an output: its number among those, and its bodies with coordinates.

    first: the number of its first component, if it is an output; adds: whether it is added to other parts of this
    output; further: joints that no body with coordinates has; forces, differing: the forces on which it depends, and
    the places of the numbers in which those of its group differ; names_forces: whether it depends on those that it
    names alone.
    """

    number: int
    bodies: tuple[Member, ...]
    first: int = 0
    adds: bool = False
    further: tuple[int, ...] = ()
    forces: tuple[ForceForm, ...] = ()
    differing: tuple[tuple[Place, ...], ...] = ()
    names_forces: bool = False

    @property
    def joints(self) -> tuple[int, ...]:
        """The numbers of the joints of its bodies, each once, and of the further ones."""
        of_bodies = (handle.joint for member in self.bodies for handle in member.handles)
        return tuple(dict.fromkeys((*of_bodies, *self.further)))

    @property
    def sharing(self) -> tuple[int, ...]:
        """The number in `joints` of the joint at each handle of its bodies."""
        joints = self.joints
        return tuple(joints.index(handle.joint) for member in self.bodies for handle in member.handles)

    @property
    def coordinates(self) -> tuple[int, ...]:
        """The indices of the coordinates of its bodies."""
        return tuple(m.coordinate + k for m in self.bodies for k in range(len(m.instance.coordinates.coordinates)))

    @property
    def rows(self) -> tuple[int, ...]:
        """The indices of the equations of motion of its bodies, which are those of their velocities."""
        return tuple(m.row + k for m in self.bodies for k in range(len(m.instance.coordinates.rows)))

    @property
    def of_forces(self) -> tuple[ModelConstant, ...]:
        """The numbers of forces in which the elements of its group differ."""
        return differing_constants(self.forces, self.differing)

    @property
    def constants(self) -> tuple[ModelConstant, ...]:
        """The constants of its bodies, and those of forces."""
        return (*(c for member in self.bodies for c in member.of_body), *self.of_forces)

    @property
    def coordinate(self) -> int:
        """The index of the first coordinate of its first body."""
        return self.bodies[0].coordinate if self.bodies else 0


@dataclass(frozen=True)
class Group:
    """Elements that differ in the values of constants alone.

    along_first: whether they are joints with rows along the axes of their first bodies.
    """

    what: str
    members: tuple[GroupElement, ...]
    along_first: bool = False

    @property
    def first(self) -> GroupElement:
        """The element after which the group and its symbols are named."""
        return self.members[0]

    @property
    def name(self) -> str:
        """The name of the group in the generated code."""
        name = f"{self.what}_{self.first.number}"
        return f"{name}_along_first" if self.along_first else name


class Bodies:
    """The bodies of a mechanism by their names, with the classes they belong to."""

    def __init__(self, mechanism: AnyMechanism, classes: Iterable[BodyClass], known: KnownMotion) -> None:
        self.mechanism: Any = mechanism  # in the plane or in space, as what groups its elements knows
        self.known = known
        self.members = {m.instance.name: m for of in classes for m in of.members}
        self.number = {m.instance.name: k for k, of in enumerate(classes) for m in of.members}

    def equations(self, body: str) -> InstanceEquations:
        """The equations of a body with coordinates."""
        instance = self.members[body].instance
        return instance_equations(instance, self.mechanism.kinds[instance.kind], False)

    def key(self, body: str) -> Hashable:
        """The class of a body, or its name if its motion is known."""
        return self.number.get(body, body)

    @property
    def idle_joints(self) -> tuple[int, ...]:
        """The numbers of the joints between markers whose motion is known."""
        ends = ((joint.joint.first.body, joint.joint.second.body) for joint in self.mechanism.joints)
        return tuple(k for k, bodies in enumerate(ends) if not any(body in self.members for body in bodies))

    @cached_property
    def forces(self) -> Mapping[str, ForceInstance]:
        """The forces by their names."""
        return {force.element.name: force for force in self.mechanism.forces}

    @cached_property
    def acting(self) -> Mapping[str, tuple[ForceInstance, ...]]:
        """The forces on each body with coordinates."""
        result: dict[str, list[ForceInstance]] = {name: [] for name in self.members}
        for force in self.mechanism.forces:
            for name in moving_bodies(self.mechanism, force):
                result[name].append(force)
        return {name: tuple(forces) for name, forces in result.items()}

    @cached_property
    def named_joints(self) -> Mapping[str, tuple[Joint, bool]]:
        """The joints by their names, and those with drives by the names of these; the flag says which name it is."""
        every = [j.joint for j in self.mechanism.joints] + [j.joint for j in self.mechanism.eliminated_joints]
        result = {joint.name: (joint, False) for joint in every}
        return result | {d.name: (result[d.joint][0], True) for d in self.mechanism.scene.drives}

    def end(self, marker: MarkerRef) -> Hashable:
        """The class of a body and its marker, or a marker whose motion is known."""
        return self.key(marker.body), marker.marker

    def form(self, marker: MarkerRef) -> Hashable:
        """The class of the motion of a marker: in space that of its body without the joints, no part of the motion."""
        if marker.body not in self.members or not isinstance(self.mechanism, SpatialMechanism):
            return self.end(marker)
        return body_key(self.members[marker.body]), marker.marker


def force_groups(bodies: Bodies) -> tuple[tuple[Group, Equations], ...]:
    """The groups of the forces that no body alone computes, and of the damping between pieces, with their equations."""
    groups: dict[Hashable, list[GroupElement]] = {}
    mechanism = bodies.mechanism
    for number, force in enumerate(mechanism.forces):
        names = moving_bodies(mechanism, force)
        if names and not any(form.force is force for form in bodies.members[names[0]].forces):
            form = force_form(mechanism, force)
            order = tuple(names.index(m.body) if m.body in names else -1 for m in force.markers)
            key = form.key, order, tuple(map(bodies.key, names)), fixed_of(bodies, names)
            element = GroupElement(number, tuple(bodies.members[name] for name in names), forces=(form,))
            groups.setdefault(key, []).append(element)
    result = [Group("force", with_differences(members)) for members in groups.values()]
    return (*((group, force_equations(bodies, group)) for group in result), *damping_groups(bodies))


def damping_groups(bodies: Bodies) -> Iterator[tuple[Group, Equations]]:
    """Yield a group for the damping between the pieces of each beam, with its equations."""
    for number, damping in enumerate(bodies.mechanism.dampings):
        own = {name: bodies.equations(name) for name in damping.components}
        group = Group("damping", (GroupElement(number, tuple(bodies.members[name] for name in own)),))
        yield group, group_equations(bodies, own, damping_force(damping, own), damping.constants)


def with_differences(members: list[GroupElement]) -> tuple[GroupElement, ...]:
    """The elements of a group with the places of the numbers of forces in which they differ."""
    differing = differing_places([member.forces for member in members])
    return tuple(replace(member, differing=differing) for member in members)


def fixed_of(bodies: Bodies, names: Iterable[str]) -> Hashable:
    """The values of constants in which the elements of a group with these bodies do not differ."""
    return fixed_values(c for name in names for c in bodies.members[name].of_body)


def force_equations(bodies: Bodies, group: Group) -> Equations:
    """The equations of a force between bodies: its terms on all rows of its bodies."""
    names = [m.instance.name for m in group.first.bodies]
    own = {name: bodies.equations(name) for name in names}
    rows = tuple(row for name in names for row in own[name].rows)

    def at(marker: MarkerRef) -> PointMotion:
        return own[marker.body].points[marker.marker] if marker.body in own else bodies.known.point(marker)

    (force,), (differing,) = group.first.forces, group.first.differing
    made = force.generalised(differing, at, rows)
    if made.potential.free_symbols & bodies.known.moving_with(made.definitions):
        made = replace(made, potential=sp.S.Zero)  # as energies do not know the time
    return group_equations(bodies, own, made, group.first.of_forces)


def group_equations(
    bodies: Bodies,
    own: Mapping[str, InstanceEquations],
    force: GeneralisedForce,
    constants: tuple[ModelConstant, ...] = (),
    outputs: tuple[OutputEquation, ...] = (),
    conditions: tuple[Constraint, ...] = (),
) -> Equations:
    """Equations with the coordinates and the definitions of some bodies, and no terms but those of a force."""
    known = bodies.known.context.equations
    of_own = (*(d for body in own.values() for d in body.definitions), *force.definitions)
    definitions = tuple(d for d in of_own if d.symbol not in bodies.known.symbols)
    of_bodies = [c for body in own.values() for c in body.coefficients]
    present = {c.symbol for c in of_bodies}
    more = [c for c in (*constants, *known.coefficients) if c.symbol not in present]
    return Equations(
        name=known.name,
        doc="",
        frame_doc="",
        coordinates=tuple(c for body in own.values() for c in body.coordinates),
        rows=tuple(row for body in own.values() for row in body.rows),
        rates=tuple(rate for body in own.values() for rate in body.rates),
        parameters=known.parameters,
        coefficients=canonical((*of_bodies, *more), bodies.mechanism),
        definitions=definitions,
        terms=force.terms,
        vanished=(),
        kinetic_energy=sp.S.Zero,
        strain_energy=force.potential,
        weight_energy=None,
        linear_momentum=(),
        angular_momentum=(),
        markers=(),
        constraints=conditions,
        inputs=known.inputs,
        outputs=outputs,
        splines=known.splines,
    )
