"""Groups of outputs, which have one code: what it computes depends on the bodies and the forces that they name."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import repeat
from typing import Any

import sympy as sp

from derive.lowering.instances.force_numbers import force_form, moving_bodies
from derive.lowering.instances.groups import (
    Bodies,
    Group,
    GroupElement,
    NotInLoops,
    fixed_of,
    group_equations,
    with_differences,
)
from derive.lowering.instances.known_motion import STILL
from derive.lowering.instances.varying_joints import varies
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.forces.force_type import GeneralisedForce
from derive.mechanics.multibody.instances import InstanceEquations
from derive.mechanics.multibody.kinds import ForceInstance
from derive.mechanics.multibody.mechanism import damping_force
from derive.mechanics.multibody.outputs.output_type import OutputInstance
from derive.mechanics.multibody.point_motion import PointMotion, RelativeMotion
from derive.mechanics.multibody.ports import output_equations
from derive.mechanics.multibody.scene_mechanics import SceneMechanics
from derive.spec.model.markers import GROUND, MarkerRef


def output_groups(bodies: Bodies) -> tuple[tuple[Group, Equations], ...]:
    """The groups of the outputs, each with its equations; an output that no group can have depends on all bodies."""
    groups: dict[Hashable, list[GroupElement]] = {}
    made: dict[Hashable, Equations] = {}
    first = 0
    for number, output in enumerate(bodies.mechanism.outputs):
        for key, element, of_all in _elements(bodies, number, first):
            if key not in made:
                try:
                    made[key] = _output_equations(bodies, element, of_all)
                except NotInLoops:
                    continue
            groups.setdefault(key, []).append(element)
            break
        first += len(output.type.labels)
    result = []
    for key, members in groups.items():
        group, equations = Group("output", with_differences(members)), made[key]
        if any(group.first.differing):
            again = _output_equations(bodies, group.first)
            named = zip(equations.outputs, again.outputs, strict=True)
            equations = replace(again, outputs=tuple(replace(old, expr=new.expr) for old, new in named))
        result.append((group, equations))
    return tuple(result)


def _elements(bodies: Bodies, number: int, first: int) -> Iterator[tuple[Hashable, GroupElement, bool]]:
    """Yield an output with what its code depends on, and whether that is all: at first what it names alone.

    Then its bodies with the forces that act on these alone, and at last all that there is.
    """
    output = bodies.mechanism.outputs[number]
    names, known = _referenced(bodies, output)
    names, others = _with_partners(bodies, names)

    def of_forces(forces: Iterable[ForceInstance], named: bool) -> tuple[Hashable, GroupElement, bool]:
        forms = tuple(force_form(bodies.mechanism, force) for force in forces)
        ends = ([marker.body for marker in form.force.markers] for form in forms)
        at = tuple(tuple(names.index(body) if body in names else -1 for body in of) for of in ends)
        members = tuple(bodies.members[name] for name in names)
        element = GroupElement(number, members, first, forces=forms, names_forces=named)
        own = output.type, known, others, tuple(map(bodies.key, names)), element.sharing, fixed_of(bodies, names)
        return (own, at, tuple(form.key for form in forms), named), element, False

    yield of_forces([f for f in bodies.mechanism.forces if f.element.name in output.values.values()], True)
    acting = {f.element.name: (f, moving_bodies(bodies.mechanism, f)) for f in bodies.mechanism.forces}
    acting = {name: (f, moving) for name, (f, moving) in acting.items() if {*moving} & {*names}}
    if all({*moving} <= {*names} for _, moving in acting.values()):
        yield of_forces([f for f, _ in acting.values()], False)
    yield number, GroupElement(number, tuple(bodies.members.values()), first, bodies.idle_joints), True


def _with_partners(bodies: Bodies, names: tuple[str, ...]) -> tuple[tuple[str, ...], Hashable]:
    """Some bodies with those at the other ends of their varying joints, and the known markers at other such ends.

    What a varying joint exerts on a body depends on the motion of both of its bodies.
    """
    numbers = (handle.joint for name in names for handle in bodies.members[name].handles)
    joints = [joint for joint in map(bodies.mechanism.joints.__getitem__, dict.fromkeys(numbers)) if varies(joint)]
    ends = [marker for joint in joints for marker in (joint.joint.first, joint.joint.second)]
    partners = (marker.body for marker in ends if marker.body in bodies.members)
    return tuple(dict.fromkeys((*names, *partners))), tuple(map(bodies.end, ends))


def _referenced(bodies: Bodies, output: OutputInstance) -> tuple[tuple[str, ...], Hashable]:
    """The bodies with coordinates that an output names, and its values with the places of their names."""
    joints = {j.joint.name: j.joint for j in bodies.mechanism.joints}
    joints |= {j.joint.name: j.joint for j in bodies.mechanism.eliminated_joints}
    drives = {d.name: d.joint for d in bodies.mechanism.scene.drives}
    forces = {force.element.name: force for force in bodies.mechanism.forces}
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
        if isinstance(value, str) and value in forces and not all(map(bodies.known.is_known, forces[value].markers)):
            ends = (marker.body for marker in forces[value].markers)
            places = tuple(place(body) if body in bodies.members else -1 for body in ends)
            return "force", places, force_form(bodies.mechanism, forces[value]).key
        if isinstance(value, str) and (value in joints or value in drives):
            joint = joints[drives.get(value, value)]
            return "joint", plain(joint.first), plain(joint.second), joint.kind, value in drives
        hashable: Hashable = value.as_immutable() if isinstance(value, sp.MatrixBase) else value
        return hashable

    values = tuple((key, plain(value)) for key, value in output.values.items())
    return tuple(names), values


def _output_equations(bodies: Bodies, element: GroupElement, of_all: bool = False) -> Equations:
    """The equations of an output: its components, in the symbols of its bodies and of the reactions on them.

    of_all: its bodies are all that there are. Raises NotInLoops if it depends on other bodies as well.
    """
    mechanism = bodies.mechanism
    names = [m.instance.name for m in element.bodies]
    if not names:
        raise NotInLoops("an output that names no body depends on all")
    own = {name: bodies.equations(name) for name in names}
    rows = tuple(row for name in names for row in own[name].rows)
    points = {GROUND: mechanism.ground, **{name: b.points for name, b in {**bodies.known.bodies, **own}.items()}}
    forces, generalised = mechanism.forces if of_all else (), list[GeneralisedForce]()
    for form, places in zip(element.forces, element.differing or repeat(()), strict=False):
        with_symbols, new = form.with_symbols(places, lambda marker: points[marker.body][marker.marker])
        forces = (*forces, with_symbols)
        for marker, point in new.items():
            points[marker.body] = {**points[marker.body], marker.marker: point}
    for f in forces:
        at = tuple(points[m.body][m.marker] for m in f.markers)
        generalised.append(f.type.generalised_force(f.element, at, f.values, rows))
    dampings = [damping_force(damping, own) for damping in (mechanism.dampings if of_all else ())]
    joints = element.joints
    definitions = [d for f in generalised for d in f.definitions]
    for joint in (mechanism.joints[k] for k in joints):
        first, second = (points.get(m.body, {}).get(m.marker) for m in (joint.joint.first, joint.joint.second))
        if varies(joint) and first and second:
            definitions += joint.type.equations(joint.joint, RelativeMotion(first, second)).definitions
    known = {name: replace(body, points=points[name]) for name, body in bodies.known.bodies.items()}
    parts = SceneMechanics(
        scene=mechanism.scene,
        ground=points[GROUND],
        instances={**known, **own} if of_all else _Some(known, own),
        joints=tuple(mechanism.joints[k] for k in joints),
        eliminated_joints=mechanism.eliminated_joints,
        forces=_Named(forces) if element.names_forces else forces,
        generalised=(*generalised, *dampings) if of_all else _Named(),
        constraints=tuple(c for k in joints for c in bodies.known.constraints[k]),
    )
    try:
        made, constants = output_equations([mechanism.outputs[element.number]], parts)
    except (AttributeError, KeyError, StopIteration) as error:
        if of_all:
            raise
        raise NotInLoops(f"output {mechanism.outputs[element.number].name} depends on other bodies") from error
    none = GeneralisedForce((), tuple(definitions))
    constants += tuple(c for damping in (mechanism.dampings if of_all else ()) for c in damping.constants)
    return group_equations(bodies, own, none, (*element.of_forces, *constants), made, parts.constraints)


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


class _Named(tuple[Any, ...]):
    """The forces that an output names; nobody asks for all."""

    def __iter__(self) -> Any:
        """Yield these, and raise NotInLoops at their end."""
        yield from super().__iter__()
        raise NotInLoops("an output depends on all forces")


class _Still(dict[str, PointMotion]):
    """The points of a body that an output does not name: what joints do to others does not depend on their motion."""

    def __missing__(self, key: str) -> PointMotion:
        return STILL


class _Elsewhere:
    """A body that an output does not name."""

    points: Mapping[str, PointMotion] = _Still()


_ELSEWHERE = _Elsewhere()
