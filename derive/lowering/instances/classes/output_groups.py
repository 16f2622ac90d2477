"""Groups of outputs, which have one code: what it computes depends on the bodies and the forces that they name."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, repeat
from typing import Any

from derive.algebra import sp
from derive.lowering.instances.classes.force_numbers import force_form, moving_bodies
from derive.lowering.instances.classes.groups import (
    Bodies,
    Group,
    GroupElement,
    NotInLoops,
    fixed_of,
    group_equations,
    with_differences,
)
from derive.lowering.instances.classes.output_scene import NamedForces, output_scene
from derive.lowering.instances.classes.varying_joints import varies
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.forces.force_type import GeneralisedForce
from derive.mechanics.multibody.kinds import ForceInstance
from derive.mechanics.multibody.outputs.output_type import OutputInstance, SumOutput
from derive.mechanics.multibody.point_motion import RelativeMotion
from derive.mechanics.multibody.ports import output_equations
from derive.mechanics.terms import OutputEquation
from derive.spec.model.markers import GROUND, MarkerRef


@dataclass(frozen=True)
class _Part:
    """An output, or an addend of one: the number of its first component, and whether it is an addend."""

    output: OutputInstance
    first: int
    adds: bool


def output_groups(bodies: Bodies) -> tuple[tuple[Group, Equations], ...]:
    """The groups of the outputs, each with its equations; an output that no group can have depends on all bodies.

    Sums have groups of addends: those of each body, force and drive, and one of all whose motion is known.
    """
    groups: dict[Hashable, list[GroupElement]] = {}
    made: dict[Hashable, Equations] = {}
    parts = [*_parts(bodies)]
    known = _known_addends(bodies, parts)
    for number, part in enumerate(parts):
        for key, element, of_all in _elements(bodies, number, part) if number not in known else ():
            if key not in made:
                try:
                    made[key] = _output_equations(bodies, part.output, element, of_all)
                except NotInLoops:
                    continue
            groups.setdefault(key, []).append(element)
            break
    result = list(_known_sums(bodies, parts, known))
    for key, members in groups.items():
        group, equations = Group("output", with_differences(members)), made[key]
        if any(group.first.differing):
            again = _output_equations(bodies, parts[group.first.number].output, group.first)
            named = zip(equations.outputs, again.outputs, strict=True)
            equations = replace(again, outputs=tuple(replace(old, expr=new.expr) for old, new in named))
        result.append((group, equations))
    return tuple(result)


def _parts(bodies: Bodies) -> Iterator[_Part]:
    """Yield the outputs, sums empty, and then the addends of the sums."""
    outputs = bodies.mechanism.outputs
    firsts = [*accumulate((len(output.type.labels) for output in outputs), initial=0)]
    yield from (_Part(output, first, False) for output, first in zip(outputs, firsts, strict=False))
    for output, first in zip(outputs, firsts, strict=False):
        if isinstance(output.type, SumOutput):
            for addend, values in output.type.addends(bodies.mechanism):
                yield _Part(OutputInstance(output.name, addend, values), first, True)


def _known_addends(bodies: Bodies, parts: Sequence[_Part]) -> dict[int, tuple[sp.Expr, ...]]:
    """The components of the addends that depend on nothing but what is known, by their numbers; sums have none."""
    forces = _known_forces(bodies)
    scene = output_scene(bodies, {}, NamedForces(force for force, _ in forces), [made for _, made in forces])
    values = {c.symbol: c.value for c in bodies.known.context.equations.coefficients if c.value.is_Rational}
    result: dict[int, tuple[sp.Expr, ...]] = {}
    for number, part in enumerate(parts):
        output = part.output
        if isinstance(output.type, SumOutput):
            result[number] = ()
        elif part.adds and not _referenced(bodies, output)[0]:
            try:
                components = output.type.components(output.name, output.values, scene).components
            except (AttributeError, KeyError, StopIteration, NotInLoops):  # it depends on other bodies as well
                continue
            result[number] = tuple(c.expr.xreplace(values) for c in components)
    return result


def _known_forces(bodies: Bodies) -> list[tuple[ForceInstance, GeneralisedForce]]:
    """The forces between markers whose motion is known, with what they store and dissipate."""
    known = bodies.known
    forces = (force for force in bodies.mechanism.forces if all(map(known.is_known, force.markers)))
    return [(f, f.type.generalised_force(f.element, tuple(map(known.point, f.markers)), f.values, ())) for f in forces]


def _known_sums(
    bodies: Bodies, parts: Sequence[_Part], known: Mapping[int, tuple[sp.Expr, ...]]
) -> Iterator[tuple[Group, Equations]]:
    """Yield a group of one element for each output with such addends: their sum."""
    of_outputs: dict[int, list[int]] = {}
    definitions = GeneralisedForce((), tuple(d for _, made in _known_forces(bodies) for d in made.definitions))
    for number in known:
        if parts[number].adds:
            of_outputs.setdefault(parts[number].first, []).append(number)
    for first, numbers in of_outputs.items():
        totals = [sp.Add(*each) for each in zip(*(known[number] for number in numbers), strict=True)]
        sums = [OutputEquation("", "", "", "", total) for total in totals]
        element = GroupElement(numbers[0], (), first, adds=True)
        yield Group("output", (element,)), group_equations(bodies, {}, definitions, (), tuple(sums))


def _elements(bodies: Bodies, number: int, part: _Part) -> Iterator[tuple[Hashable, GroupElement, bool]]:
    """Yield an output with what its code depends on, and whether that is all: at first what it names alone.

    Then its bodies with the forces that act on these alone, and at last all that there is.
    """
    output = part.output
    names, known = _referenced(bodies, output)
    names, others = _with_partners(bodies, names)

    def of_forces(forces: Iterable[ForceInstance], named: bool) -> tuple[Hashable, GroupElement, bool]:
        forms = tuple(force_form(bodies.mechanism, force) for force in forces)
        ends = ([marker.body for marker in form.force.markers] for form in forms)
        at = tuple(tuple(names.index(body) if body in names else -1 for body in of) for of in ends)
        members = tuple(bodies.members[name] for name in names)
        element = GroupElement(number, members, part.first, part.adds, forces=forms, names_forces=named)
        own = output.type, known, others, tuple(map(bodies.key, names)), element.sharing, fixed_of(bodies, names)
        return (own, at, tuple(form.key for form in forms), named), element, False

    values = (value for value in output.values.values() if isinstance(value, str))
    yield of_forces([bodies.forces[value] for value in values if value in bodies.forces], True)
    acting = {f.element.name: f for name in names for f in bodies.acting[name]}
    if all({*moving_bodies(bodies.mechanism, f)} <= {*names} for f in acting.values()):
        yield of_forces([f for name, f in bodies.forces.items() if name in acting], False)
    everything = tuple(bodies.members.values())
    yield number, GroupElement(number, everything, part.first, part.adds, bodies.idle_joints), True


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
    joints, forces = bodies.named_joints, bodies.forces
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
        if isinstance(value, str) and value in joints:
            joint, is_drive = joints[value]
            return "joint", plain(joint.first), plain(joint.second), joint.kind, is_drive
        hashable: Hashable = value.as_immutable() if isinstance(value, sp.MatrixBase) else value
        return hashable

    values = tuple((key, plain(value)) for key, value in output.values.items())
    return tuple(names), values


def _output_equations(bodies: Bodies, output: OutputInstance, element: GroupElement, of_all: bool = False) -> Equations:
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
    joints = element.joints
    definitions = [d for f in generalised for d in f.definitions]
    for joint in (mechanism.joints[k] for k in joints):
        first, second = (points.get(m.body, {}).get(m.marker) for m in (joint.joint.first, joint.joint.second))
        if varies(joint) and first and second:
            definitions += joint.type.equations(joint.joint, RelativeMotion(first, second)).definitions
    acting = NamedForces(forces) if element.names_forces else forces
    parts = output_scene(bodies, own, acting, generalised, element.joints, points, of_all)
    try:
        made, constants = output_equations([output], parts)
    except (AttributeError, KeyError, StopIteration) as error:
        if of_all:
            raise
        raise NotInLoops(f"output {output.name} depends on other bodies") from error
    none = GeneralisedForce((), tuple(definitions))
    return group_equations(bodies, own, none, (*element.of_forces, *constants), made, parts.constraints)
