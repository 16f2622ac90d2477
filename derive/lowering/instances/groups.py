"""Elements that several bodies take part in: forces between two bodies, damping across pieces, and outputs.

Elements of a group have one code, as bodies of a class have. Their equations contain the definitions of all of their
bodies, in the symbols of the first element.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from derive.errors import TisserandError
from derive.lowering.instances.classes import BodyClass, Member, fixed_values, force_key, moving_bodies
from derive.lowering.instances.known_motion import STILL, KnownMotion, canonical
from derive.lowering.instances.varying_joints import varies
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.forces.force_type import GeneralisedForce
from derive.mechanics.multibody.instances import InstanceEquations, instance_equations
from derive.mechanics.multibody.kinds import ForceInstance
from derive.mechanics.multibody.mechanism import Mechanism, damping_force
from derive.mechanics.multibody.outputs.output_type import OutputInstance
from derive.mechanics.multibody.point_motion import PointMotion, RelativeMotion
from derive.mechanics.multibody.ports import output_equations
from derive.mechanics.multibody.scene_mechanics import SceneMechanics
from derive.mechanics.terms import Constraint, ModelConstant, OutputEquation
from derive.spec.model.markers import GROUND, MarkerRef


class NotInLoops(TisserandError):
    """An element depends on more of the mechanism than the bodies that it names."""


@dataclass(frozen=True)
class GroupElement:
    """A force, a damping, a varying joint or an output: its number among those, and its bodies with coordinates.

    first: the number of its first component, if it is an output; further: joints that no body with coordinates has.
    """

    number: int
    bodies: tuple[Member, ...]
    first: int = 0
    further: tuple[int, ...] = ()

    @property
    def joints(self) -> tuple[int, ...]:
        """The numbers of the joints of its bodies, each once, and of the further ones."""
        of_bodies = (handle.joint for member in self.bodies for handle in member.handles)
        return tuple(dict.fromkeys((*of_bodies, *self.further)))

    @property
    def sharing(self) -> tuple[int, ...]:
        """For each joint at its bodies the place of that joint among `joints`."""
        joints = self.joints
        return tuple(joints.index(handle.joint) for member in self.bodies for handle in member.handles)

    @property
    def coordinates(self) -> tuple[int, ...]:
        """The indices of the coordinates of its bodies."""
        return tuple(m.coordinate + k for m in self.bodies for k in range(len(m.instance.coordinates.rows)))

    @property
    def constants(self) -> tuple[ModelConstant, ...]:
        """The constants of its bodies."""
        return tuple(c for member in self.bodies for c in member.constants)

    @property
    def coordinate(self) -> int:
        """The index of the first coordinate of its first body."""
        return self.bodies[0].coordinate if self.bodies else 0


@dataclass(frozen=True)
class Group:
    """Elements that differ in the values of constants alone."""

    what: str
    members: tuple[GroupElement, ...]

    @property
    def first(self) -> GroupElement:
        """The element after which the group and its symbols are named."""
        return self.members[0]

    @property
    def name(self) -> str:
        """The name of the group in the generated code."""
        return f"{self.what}_{self.first.number}"


class Bodies:
    """The bodies of a mechanism by their names, with the classes they belong to."""

    def __init__(self, mechanism: Mechanism, classes: Iterable[BodyClass], known: KnownMotion) -> None:
        self.mechanism, self.known = mechanism, known
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

    def end(self, marker: MarkerRef) -> Hashable:
        """The class of a body and its marker, or a marker whose motion is known."""
        return self.key(marker.body), marker.marker


def force_groups(bodies: Bodies) -> tuple[Group, ...]:
    """The groups of the forces that act between bodies, and of the damping between pieces."""
    groups: dict[Hashable, list[GroupElement]] = {}
    mechanism = bodies.mechanism
    for number, force in enumerate(mechanism.forces):
        names = moving_bodies(mechanism, force)
        if len(names) > 1:
            order = tuple(names.index(m.body) if m.body in names else m.body for m in force.markers)
            key = force_key(force), order, tuple(map(bodies.key, names)), fixed_of(bodies, names)
            element = GroupElement(number, tuple(bodies.members[name] for name in names))
            groups.setdefault(key, []).append(element)
    result = [Group("force", tuple(members)) for members in groups.values()]
    for number, damping in enumerate(mechanism.dampings):
        own = tuple(bodies.members[name] for name in damping.components)
        result.append(Group("damping", (GroupElement(number, own),)))
    return tuple(result)


def output_groups(bodies: Bodies) -> tuple[tuple[Group, Equations], ...]:
    """The groups of the outputs, each with its equations; an output that no group can have depends on all bodies."""
    groups: dict[Hashable, list[GroupElement]] = {}
    made: dict[Hashable, Equations] = {}
    first = 0
    for number, output in enumerate(bodies.mechanism.outputs):
        names, known = _referenced(bodies, output)
        names, others = _with_partners(bodies, names)
        element = GroupElement(number, tuple(bodies.members[name] for name in names), first)
        key = output.type, known, others, tuple(map(bodies.key, names)), element.sharing, fixed_of(bodies, names)
        if key not in made:
            try:
                made[key] = _output_equations(bodies, element)
            except NotInLoops:
                element = GroupElement(number, tuple(bodies.members.values()), first, bodies.idle_joints)
                made[key, number] = _output_equations(bodies, element, of_all=True)
        groups.setdefault(key if key in made else (key, number), []).append(element)
        first += len(output.type.labels)
    return tuple((Group("output", tuple(members)), made[key]) for key, members in groups.items())


def _with_partners(bodies: Bodies, names: tuple[str, ...]) -> tuple[tuple[str, ...], Hashable]:
    """Some bodies with those at the other ends of their varying joints, and the known markers at other such ends.

    What a varying joint exerts on a body depends on the motion of both of its bodies.
    """
    numbers = (handle.joint for name in names for handle in bodies.members[name].handles)
    joints = [joint for joint in map(bodies.mechanism.joints.__getitem__, dict.fromkeys(numbers)) if varies(joint)]
    ends = [marker for joint in joints for marker in (joint.joint.first, joint.joint.second)]
    partners = (marker.body for marker in ends if marker.body in bodies.members)
    return tuple(dict.fromkeys((*names, *partners))), tuple(map(bodies.end, ends))


def fixed_of(bodies: Bodies, names: Iterable[str]) -> Hashable:
    """The values of constants in which the elements of a group with these bodies do not differ."""
    return fixed_values((c for name in names for c in bodies.members[name].constants), bodies.mechanism)


def _referenced(bodies: Bodies, output: OutputInstance) -> tuple[tuple[str, ...], Hashable]:
    """The bodies with coordinates that an output names, and its values with the places of their names."""
    joints = {j.joint.name: j.joint for j in bodies.mechanism.joints}
    joints |= {j.joint.name: j.joint for j in bodies.mechanism.eliminated_joints}
    drives = {d.name: d.joint for d in bodies.mechanism.scene.drives}
    names: dict[str, None] = {}

    def place(body: str) -> Hashable:
        if body not in bodies.members:
            return body
        names.setdefault(body)
        return list(names).index(body)

    def plain(value: Any) -> Hashable:
        if isinstance(value, MarkerRef):
            return place(value.body), value.marker
        if isinstance(value, tuple):
            return tuple(map(plain, value))
        if isinstance(value, str) and value in bodies.members:
            return place(value)
        if isinstance(value, str) and (value in joints or value in drives):
            joint = joints[drives.get(value, value)]
            return "joint", plain(joint.first), plain(joint.second), joint.kind, value in drives
        hashable: Hashable = value.as_immutable() if isinstance(value, sp.MatrixBase) else value
        return hashable

    values = tuple((key, plain(value)) for key, value in output.values.items())
    return tuple(names), values


def force_equations(bodies: Bodies, group: Group) -> Equations:
    """The equations of a force between bodies, or of a damping: its terms on all rows of its bodies."""
    names = [m.instance.name for m in group.first.bodies]
    own = {name: bodies.equations(name) for name in names}
    rows = tuple(row for name in names for row in own[name].rows)
    made: GeneralisedForce
    constants: tuple[ModelConstant, ...] = ()
    if group.what == "damping":
        damping = bodies.mechanism.dampings[group.first.number]
        made, constants = damping_force(damping, own), damping.constants
    else:
        force: ForceInstance = bodies.mechanism.forces[group.first.number]

        def at(marker: MarkerRef) -> PointMotion:
            return own[marker.body].points[marker.marker] if marker.body in own else bodies.known.point(marker)

        made = force.type.generalised_force(force.element, tuple(map(at, force.markers)), force.values, rows)
    return group_equations(bodies, own, made, constants)


def _output_equations(bodies: Bodies, element: GroupElement, of_all: bool = False) -> Equations:
    """The equations of an output: its components, in the symbols of its bodies and of the reactions on them.

    of_all: its bodies are all that there are. Raises NotInLoops if it depends on other bodies as well.
    """
    mechanism = bodies.mechanism
    names = [m.instance.name for m in element.bodies]
    if not names:
        raise NotInLoops("an output that names no body depends on all")
    own = {name: bodies.equations(name) for name in names}
    forces = tuple(f for f in mechanism.forces if of_all or {*moving_bodies(mechanism, f)} & {*names})
    if any(not {*moving_bodies(mechanism, f)} <= {*names} for f in forces):
        raise NotInLoops("a force acts between the bodies of an output and others")
    points = {GROUND: mechanism.ground, **{name: b.points for name, b in {**bodies.known.bodies, **own}.items()}}
    rows = tuple(row for name in names for row in own[name].rows)
    generalised = [
        f.type.generalised_force(f.element, tuple(points[m.body][m.marker] for m in f.markers), f.values, rows)
        for f in forces
    ]
    dampings = [damping_force(damping, own) for damping in (mechanism.dampings if of_all else ())]
    joints = element.joints
    definitions = [d for f in generalised for d in f.definitions]
    for joint in (mechanism.joints[k] for k in joints):
        first, second = (points.get(m.body, {}).get(m.marker) for m in (joint.joint.first, joint.joint.second))
        if varies(joint) and first and second:
            definitions += joint.type.equations(joint.joint, RelativeMotion(first, second)).definitions
    parts = SceneMechanics(
        scene=mechanism.scene,
        ground=mechanism.ground,
        instances={**bodies.known.bodies, **own} if of_all else _Some(bodies.known.bodies, own),
        joints=tuple(mechanism.joints[k] for k in joints),
        eliminated_joints=mechanism.eliminated_joints,
        forces=forces,
        generalised=(*generalised, *dampings) if of_all else (),
        constraints=tuple(c for k in joints for c in bodies.known.constraints[k]),
    )
    try:
        made, constants = output_equations([mechanism.outputs[element.number]], parts)
    except (AttributeError, KeyError, StopIteration) as error:
        if of_all:
            raise
        raise NotInLoops(f"output {mechanism.outputs[element.number].name} depends on other bodies") from error
    force = GeneralisedForce((), tuple(definitions))
    constants += tuple(c for damping in (mechanism.dampings if of_all else ()) for c in damping.constants)
    return group_equations(bodies, own, force, constants, made, parts.constraints)


class _Some(dict[str, Any]):
    """Some bodies by their names; any other one is a body whose motion does not matter, and nobody asks for all."""

    def __init__(self, *of: Mapping[str, InstanceEquations]) -> None:
        super().__init__(pair for bodies in of for pair in bodies.items())

    def __missing__(self, key: str) -> _Elsewhere:
        return _ELSEWHERE

    def values(self) -> Any:
        """Raise NotInLoops."""
        raise NotInLoops("an output depends on all bodies")

    items = values
    __iter__ = values


class _Still(dict[str, PointMotion]):
    """The points of a body that an output does not name: what joints do to others does not depend on their motion."""

    def __missing__(self, key: str) -> PointMotion:
        return STILL


class _Elsewhere:
    """A body that an output does not name."""

    points: Mapping[str, PointMotion] = _Still()


_ELSEWHERE = _Elsewhere()


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
    more = [c for c in (*known.coefficients, *constants) if c.symbol not in present]
    return Equations(
        name=known.name,
        doc="",
        frame_doc="",
        coordinates=tuple(c for body in own.values() for c in body.coordinates),
        rows=tuple(row for body in own.values() for row in body.rows),
        rates=tuple(row.v for body in own.values() for row in body.rows),
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
