"""Outputs in space in groups that have one code; sums over the bodies, actions and drives are groups of their terms."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass, replace
from functools import partial

from derive.lowering.instances.classes.dimension import plain_joint
from derive.lowering.instances.classes.groups import Bodies, Group, GroupElement, fixed_of, group_equations
from derive.lowering.instances.classes.named_parts import NamedParts
from derive.lowering.instances.classes.spatial_actions import action_key
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.forces.force_type import GeneralisedForce
from derive.mechanics.multibody.space.joints import SpatialEliminatedJoint
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.mechanics.multibody.space.output_parts import SpatialParts
from derive.mechanics.multibody.space.outputs import spatial_output_equations, spatial_output_type
from derive.mechanics.terms import OutputEquation
from derive.spec.model.markers import MarkerRef
from derive.spec.model.ports import SceneOutput
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.spatial_start import NOT_GIVEN_IN_SPACE


@dataclass(frozen=True)
class _Part:
    """An output, or a term of one that is a sum: the number of its first component, and what its code depends on.

    key: besides the bodies, the joints and the actions that it asks for. body: the one that it asks for, if that is
    known to be all.
    """

    output: SceneOutput
    first: int
    key: Hashable
    make: Callable[[NamedParts], tuple[OutputEquation, ...]]
    adds: bool = False
    body: str = ""


def spatial_output_groups(bodies: Bodies) -> Iterator[tuple[Group, Equations]]:
    """Yield the groups of the outputs, with the equations of the first of each."""
    groups: dict[Hashable, list[GroupElement]] = {}
    made: dict[Hashable, Equations] = {}
    for number, part in enumerate(_parts(bodies)):
        named = NamedParts(bodies)
        components = () if part.body else part.make(named)
        names = (part.body,) if part.body in bodies.members else named.bodies
        members = tuple(bodies.members[name] for name in names)
        element = GroupElement(number, members, part.first, part.adds, named.idle_joints)
        like = part.key, _asked_for(named), _numbers(named, part.output), element.sharing, fixed_of(bodies, names)
        key: Hashable = number if named.constants else like
        groups.setdefault(key, []).append(element)
        if key not in made:
            components = components or part.make(named)
            own = {name: bodies.equations(name) for name in names}
            conditions = tuple(c for k in element.joints for c in bodies.known.constraints[k])
            loads = GeneralisedForce((), tuple(named.definitions.values()))
            made[key] = group_equations(bodies, own, loads, tuple(named.constants), components, conditions)
    for key, elements in groups.items():
        yield Group("output", tuple(elements)), made[key]


def output_components(bodies: Bodies) -> tuple[OutputEquation, ...]:
    """The components of all outputs, of which the groups have the values."""
    return tuple(c for output in bodies.mechanism.scene.outputs for c in _described(output, bodies))


def spatial_sums(bodies: Bodies) -> list[tuple[int, int]]:
    """The numbers of the first component of each output that is a sum, and of its components."""
    return [(part.first, len(spatial_output_type(part.output.kind).labels)) for part in _outputs(bodies) if part.adds]


def _parts(bodies: Bodies) -> Iterator[_Part]:
    """Yield the outputs, and the terms of those that are sums."""
    for part in _outputs(bodies):
        yield from _terms(bodies, part) if part.adds else (part,)


def _outputs(bodies: Bodies) -> Iterator[_Part]:
    first = 0
    for output in bodies.mechanism.scene.outputs:
        make, adds = partial(_components, output), spatial_output_type(output.kind).adds
        yield _Part(output, first, (output.kind, _plain(output, bodies)), make, adds)
        first += len(_described(output, bodies))


def _components(output: SceneOutput, named: NamedParts) -> tuple[OutputEquation, ...]:
    components, constants = spatial_output_equations((output,), named.of_scene())
    named.constants += constants
    return components


def _described(output: SceneOutput, bodies: Bodies) -> tuple[OutputEquation, ...]:
    """The components of an output, of a sum without its terms."""
    named, scene = NamedParts(bodies), bodies.mechanism.scene
    if spatial_output_type(output.kind).adds:
        return spatial_output_equations((output,), named.of_scene(replace(scene, drives=()), (), (), ()))[0]
    return _components(output, named)


def _terms(bodies: Bodies, of: _Part) -> Iterator[_Part]:
    """Yield the terms of an output that is a sum: those of each body, action, damping and drive."""
    mechanism: SpatialMechanism = bodies.mechanism
    still = replace(mechanism.scene, drives=())

    def term(key: Hashable, parts: Callable[[NamedParts], SpatialParts], body: str = "") -> _Part:
        def make(named: NamedParts) -> tuple[OutputEquation, ...]:
            return spatial_output_equations((of.output,), parts(named))[0]

        return replace(of, key=(of.key, key), make=make, body=body)

    for name in (instance.name for instance in mechanism.instances):
        yield term(bodies.key(name), lambda named, name=name: named.of_scene(still, (name,), (), ()), name)  # type: ignore[misc]
    for action in mechanism.forces:
        yield term("action", lambda named, action=action: named.of_scene(still, (), (action,), ()))  # type: ignore[misc]
    for damping in mechanism.dampings:
        key = damping.components
        yield term(key, lambda named, damping=damping: named.of_scene(still, (), (), (damping,)))  # type: ignore[misc]
    for drive in mechanism.scene.drives:
        alone = replace(mechanism.scene, drives=(drive,))
        if isinstance(mechanism.joints_by_name[drive.joint], SpatialEliminatedJoint):
            yield replace(of, key=(of.key, drive.name), make=partial(_of_support, of.output, alone, still))
        else:
            yield term(drive.name, lambda named, alone=alone: named.of_scene(alone, (), (), ()))  # type: ignore[misc]


def _of_support(
    output: SceneOutput, alone: SpatialScene, still: SpatialScene, named: NamedParts
) -> tuple[OutputEquation, ...]:
    """The term of a drive whose joint has eliminated coordinates: its reaction is what all other loads lack."""
    with_drive, without = (spatial_output_equations((output,), named.of_scene(scene))[0] for scene in (alone, still))
    return tuple(replace(a, expr=a.expr - b.expr) for a, b in zip(with_drive, without, strict=True))


def _asked_for(named: NamedParts) -> Hashable:
    """The bodies, joints and actions that an output asks for, besides numbers of bodies."""
    names, of = named.bodies, named.of
    order = tuple(names.index(m.body) if m.body in names else -1 for m in named.markers)
    actions = tuple(action_key(of, action, names) for action in named.actions)
    return order, tuple(map(of.key, names)), tuple(map(of.end, named.markers)), actions


def _numbers(named: NamedParts, output: SceneOutput) -> Hashable:
    """The numbers of bodies that an output contains: stresses by unit amplitudes at markers, and all of its beams."""
    if not spatial_output_type(output.kind).of_numbers:
        return None
    members = ((named.of.members.get(m.body), m.marker) for m in named.markers)
    sections = (m.instance.component.sections[marker] for m, marker in members if m)
    beams = (body for body in named.mechanism.scene.bodies if isinstance(body, SpatialBeam) and body.name in named.own)
    plain = (replace(beam, name="", start=NOT_GIVEN_IN_SPACE) for beam in beams)
    return tuple(section.stresses for section in sections), tuple(plain)


def _plain(output: SceneOutput, bodies: Bodies) -> Hashable:
    """The values of the keys of an output without the names of markers, joints and actions."""
    mechanism: SpatialMechanism = bodies.mechanism
    joints, actions = mechanism.joints_by_name, {f.element.name for f in mechanism.forces}
    result: list[tuple[str, Hashable]] = []
    for key, value in output.values.items():
        if isinstance(value, str) and key == "joint" and value in joints:
            joint = joints[value]
            result.append((key, (type(joint), joint.type, plain_joint(joint), joint.drive)))
        elif isinstance(value, str) and key in ("spring", "load") and value in actions:
            result.append((key, None))
        elif not isinstance(value, MarkerRef) and not _has_markers(value):
            result.append((key, value))
    return tuple(result)


def _has_markers(value: object) -> bool:
    return isinstance(value, tuple) and any(isinstance(part, MarkerRef) for part in value)
