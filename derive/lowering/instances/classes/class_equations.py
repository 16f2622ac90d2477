"""The equations of a class of bodies: those of its first member with what it contributes to its joints.

Most constraints are linear in the displacement and the rotation between the two markers of a joint, so that g, gdot and
gamma are sums of what each body contributes, and of the contribution of what is known. Varying joints compute these
themselves, and a body contributes its rows of G to the system of the joints alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, chain
from types import MappingProxyType
from typing import Any

from derive.algebra import sp
from derive.lowering.instances.classes.body_classes import BodyClass, Handle, Member
from derive.lowering.instances.classes.dimension import AnyJoint, of_joint
from derive.lowering.instances.classes.gears import CoupledJoints, constraining
from derive.lowering.instances.classes.known_motion import KnownMotion, canonical
from derive.lowering.instances.classes.varying_joints import at_rest, varies
from derive.lowering.instances.classes.varying_parts import VaryingPart, gear_part, part_along_first, varying_part
from derive.mechanics.equations import Equations
from derive.mechanics.expansion import mass_matrix
from derive.mechanics.multibody.forces.force_type import GeneralisedForce
from derive.mechanics.multibody.instances import InstanceEquations, instance_equations
from derive.mechanics.multibody.point_motion import PointMotion
from derive.mechanics.multibody.ports import input_symbols
from derive.mechanics.multibody.space.joints import SpatialJointInstance
from derive.mechanics.multibody.space.mechanism import AnyMechanism
from derive.mechanics.terms import Constraint, Eliminated, Intermediate, MarkerEquations
from derive.spec.model.markers import MarkerRef


@dataclass(frozen=True)
class ClassEquations:
    """The equations of the first member of a class.

    Its `constraints` are what it contributes to those of its joints, one joint after the other; `rows` are their
    numbers for each of its handles, none for varying joints. system, system_rows: the same with varying joints, of
    which there are rows of G alone; varying: what it contributes to these by its handle. given: the symbols of what is
    known that the equations contain, given_still: those that do not depend on the time; constants: the number
    of those whose values may differ from member to member, first among the coefficients. axes: the rotation tensor of
    the body if its joints are along the axes of their first bodies, and its translation in `system` along its own.
    """

    equations: Equations
    rows: tuple[tuple[int, ...], ...]
    given: tuple[sp.Symbol, ...]
    given_still: tuple[sp.Symbol, ...]
    constants: int
    system: Equations
    system_rows: tuple[tuple[int, ...], ...]
    varying: Mapping[int, VaryingPart]
    axes: sp.ImmutableMatrix | None = None


def class_equations(mechanism: AnyMechanism, of: BodyClass, known: KnownMotion) -> ClassEquations:
    """The equations of the first member of a class, in its symbols."""
    instance = of.first.instance
    own = instance_equations(instance, mechanism.kinds[instance.kind], False)
    forces = _forces(of.first, own, known)
    definitions = [d for d in own.definitions if d.symbol not in known.symbols]
    definitions += [d for force in forces for d in force.definitions]
    elements = constraining(mechanism)
    parts, varying = list[tuple[Constraint, ...]](), dict[int, VaryingPart]()
    for h, handle in enumerate(of.first.handles):
        joint = elements[handle.joint]
        if isinstance(joint, CoupledJoints):
            part = varying[h] = gear_part(joint, instance.name, own)
            defined, contributed = part.definitions, part.constraints
        elif of.along_first and isinstance(joint, SpatialJointInstance):
            part = varying[h] = part_along_first(joint, handle.marker, handle.is_first, own)
            defined, contributed = part.definitions, part.constraints
        elif varies(joint):
            part = varying[h] = varying_part(joint, handle.marker, handle.is_first, own)
            defined, contributed = part.definitions, part.constraints
        else:
            defined, contributed = _contribution(joint, handle, own)
        definitions += defined
        parts.append(contributed)
    terms = (*own.terms, *(term for force in forces for term in force.terms))
    number = {row.name: i for i, row in enumerate(own.rows)}
    inputs = input_symbols(mechanism.scene)
    moving = known.moving_with(definitions)

    def still(expr: sp.Expr) -> sp.Expr:
        """An expression, or 0 if it depends on the time, which energies and momenta do not know."""
        return sp.S.Zero if expr.free_symbols & moving else expr

    energies, carried = [still(e) for e in own.energies], _carried(instance.name, own, moving)
    pose: Any = mechanism.pose(instance.name, own)
    of_members = (*own.coefficients, *of.first.of_forces)
    present = {c.symbol for c in of_members}
    more = tuple(c for c in known.context.equations.coefficients if c.symbol not in present)
    equations = Equations(
        name=mechanism.scene.name,
        doc="",
        frame_doc="",
        coordinates=own.coordinates,
        rows=own.rows,
        rates=own.rates,
        parameters=mechanism.parameters,
        coefficients=canonical((*of_members, *more), mechanism),
        definitions=tuple(definitions),
        terms=terms,
        vanished=own.vanished,
        mass=mass_matrix(own.rows, terms),
        mass_zeros=tuple((number[i], number[j], why) for i, j, why in own.mass_zeros),
        kinetic_energy=energies[0],
        strain_energy=energies[1] + sp.Add(*(still(force.potential) for force in forces)),
        weight_energy=energies[2] if mechanism.scene.gravity else None,
        linear_momentum=tuple(sp.S.Zero if carried else p for p in own.linear),
        angular_momentum=tuple(sp.S.Zero if carried else p for p in own.angular),
        markers=tuple(m for m in own.markers if not _depends_on(m, moving)),
        constraints=tuple(c for k, of_joint in enumerate(parts) for c in of_joint if k not in varying),
        inputs=inputs,
        poses=(pose,),
        eliminated=carried,
        splines=known.context.equations.splines,
    )
    result = with_known(equations, known, len(of_members), parts, varying)
    return replace(result, axes=own.motions[of.first.handles[0].marker].frame) if of.along_first else result


def with_known(
    equations: Equations,
    known: KnownMotion,
    constants: int,
    parts: Sequence[tuple[Constraint, ...]] = (),
    varying: Mapping[int, VaryingPart] = MappingProxyType({}),
) -> ClassEquations:
    """The equations of a class or a group with the symbols of what is known in them.

    parts: what a body contributes to the constraints of its joints, of which some are varying.
    """
    system = replace(equations, constraints=tuple(chain.from_iterable(parts))) if varying else equations
    given = given_symbols(system, known)
    return ClassEquations(
        equations=equations,
        rows=_numbers([0 if k in varying else len(part) for k, part in enumerate(parts)]),
        given=given,
        given_still=tuple(s for s in given if s not in known.moving),
        constants=constants,
        system=system,
        system_rows=_numbers([len(part) for part in parts]),
        varying=varying,
    )


def _numbers(counts: list[int]) -> tuple[tuple[int, ...], ...]:
    """The numbers of elements in parts of so many."""
    firsts = accumulate(counts, initial=0)
    return tuple(tuple(range(first, first + count)) for first, count in zip(firsts, counts, strict=False))


def _contribution(
    joint: AnyJoint, handle: Handle, own: InstanceEquations
) -> tuple[tuple[Intermediate, ...], tuple[Constraint, ...]]:
    """The definitions and the parts of the constraints of a joint that depend on one of its bodies."""
    still, motion = of_joint(joint).still, own.motions[handle.marker]
    ends = (motion, still) if handle.is_first else (still, motion)
    definitions, conditions = joint.constraints(*ends, None, own.rows)
    _, offsets = joint.constraints(still, still, None, ())
    contributed = [
        replace(c, position=sp.expand(c.position - offset.position))
        for c, offset in zip(conditions, offsets, strict=True)
    ]
    if joint.drive is not None:
        contributed.append(_driven(joint, ends, own))
    return definitions, tuple(contributed)


def _driven(joint: AnyJoint, ends: tuple[Any, Any], own: InstanceEquations) -> Constraint:
    """The part of the constraint of a drive that depends on one body: the relative motion that it prescribes."""
    drive, still = at_rest(joint.drive), of_joint(joint).still
    _, conditions = joint.constraints(*ends, drive, own.rows)
    _, offsets = joint.constraints(still, still, drive, ())
    return replace(conditions[-1], position=sp.expand(conditions[-1].position - offsets[-1].position))


def _forces(member: Member, own: InstanceEquations, known: KnownMotion) -> list[GeneralisedForce]:
    """The terms of the forces on one body, whose other markers have a known motion."""

    def at(marker: MarkerRef) -> PointMotion:
        return own.points[marker.marker] if marker.body == member.instance.name else known.point(marker)

    result = []
    for force, places in zip(member.forces, member.differing, strict=True):
        result.append(force.generalised(places, at, own.rows))
    return result


def _depends_on(marker: MarkerEquations, moving: frozenset[sp.Symbol]) -> bool:
    """Whether a marker depends on the time, which functions of markers do not know."""
    every = (marker.position.free_symbols, *(d.expr.free_symbols for d in marker.definitions))
    return any(symbols & moving for symbols in every)


def _carried(name: str, own: InstanceEquations, moving: frozenset[sp.Symbol]) -> tuple[Eliminated, ...]:
    every = (*own.energies, *own.linear, *own.angular)
    if not any(e.free_symbols & moving for e in every):
        return ()
    reason = "a drive carries it along, and these functions know no time"
    return (Eliminated(f"{name} in energy, momentum and markers", reason),)


def given_symbols(equations: Equations, known: KnownMotion) -> tuple[sp.Symbol, ...]:
    """The symbols of what is known in some equations, in the order of their definitions."""
    parts = [d.expr for d in equations.definitions]
    parts += [*(term.expr for term in equations.terms), *(out.expr for out in equations.outputs)]
    parts += [equations.kinetic_energy, equations.strain_energy, equations.weight_energy or sp.S.Zero]
    parts += [*equations.linear_momentum, *equations.angular_momentum]
    parts += [e for pose_of in equations.poses for _, e in pose_of.parts]
    for c in equations.constraints:
        parts += [c.position, c.rate, c.bias, *(factor for _, factor in c.jacobian)]
    present = frozenset().union(*(part.free_symbols for part in parts))
    return tuple(d.symbol for d in known.definitions if d.symbol in present)
