"""A mechanism: equations once for each kind of body, instances that refer to a kind, and their expansion."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain

import sympy as sp

from derive.errors import Problem, SpecError
from derive.mechanics.equations import Equations
from derive.mechanics.expansion import mass_matrix
from derive.mechanics.generic_forces import DAMPING_TERM
from derive.mechanics.multibody.bodies.body_type import ComponentDamping
from derive.mechanics.multibody.bodies.rigid import BODY_FRAME
from derive.mechanics.multibody.constraints import constraints
from derive.mechanics.multibody.forces.force_type import GeneralisedForce
from derive.mechanics.multibody.instances import InstanceEquations, instance_equations
from derive.mechanics.multibody.kinds import BodyInstance, BodyKind, EliminatedJoint, ForceInstance, JointInstance
from derive.mechanics.multibody.mechanism_text import frame_doc, mechanism_doc
from derive.mechanics.multibody.outputs.output_type import OutputInstance
from derive.mechanics.multibody.point_motion import PointMotion, RelativeMotion
from derive.mechanics.multibody.ports import input_symbols, output_equations
from derive.mechanics.multibody.scene_mechanics import SceneMechanics
from derive.mechanics.prescribed_motion import drive_motion
from derive.mechanics.symbols import t
from derive.mechanics.terms import (
    Constraint,
    Coordinate,
    Eliminated,
    EquationOfMotion,
    InputSymbol,
    Intermediate,
    MarkerEquations,
    ModelConstant,
    ParameterSymbol,
    Pose,
    Term,
)
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.scene import Redundant, Scene
from derive.spec.model.scene_functions import splines, time_functions
from derive.spec.model.specification import AnyScene
from derive.spec.model.time_function import TimeFunction

Instances = Mapping[str, InstanceEquations]

RIGID = 3
"""The coordinates of a free body in the plane that come before its amplitudes."""


@dataclass(frozen=True)
class Mechanism:
    """The kinds, instances, joints and forces of a scene. `expanded()` returns the equations of the whole mechanism.

    kinds: the equations of its bodies, each once; instances: its bodies in the order of the specification; order: their
    names in the order in which their definitions follow each other, since a body may follow another's motion; ground:
    the markers of the inertial frame; joints: those that are constraints, with their drives; forces: what acts on
    markers; dampings: what acts between the components of a body; eliminated_joints: those that reduce the coordinates
    of bodies instead; outputs: what is computed from the state; constants: parameters of drives, ground and forces;
    definitions: prescribed motions with names of their own; eliminated: what the equations need not contain.
    """

    scene: Scene
    kinds: tuple[BodyKind, ...]
    instances: tuple[BodyInstance, ...]
    order: tuple[str, ...]
    ground: Mapping[str, PointMotion]
    joints: tuple[JointInstance, ...]
    forces: tuple[ForceInstance, ...]
    dampings: tuple[ComponentDamping, ...]
    eliminated_joints: tuple[EliminatedJoint, ...]
    outputs: tuple[OutputInstance, ...]
    parameters: tuple[ParameterSymbol, ...]
    constants: tuple[ModelConstant, ...]
    definitions: tuple[Intermediate, ...]
    eliminated: tuple[Eliminated, ...]

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """The coordinates of all instances."""
        return tuple(c for instance in self.instances for c in instance.coordinates.coordinates)

    @property
    def rows(self) -> tuple[EquationOfMotion, ...]:
        """The equations of motion of all instances, one for each coordinate."""
        return tuple(row for instance in self.instances for row in instance.coordinates.rows)

    def instance(self, name: str) -> BodyInstance:
        """An instance by its name."""
        return next(instance for instance in self.instances if instance.name == name)

    def expanded(self) -> Equations:
        """The equations of motion without reference to kinds: each instance has rows of its own.

        Raises SpecError where a constraint has no coordinate that could meet it, or where two names meet.
        """
        return self._expanded

    @cached_property
    def _expanded(self) -> Equations:
        return _expanded(self)

    def __str__(self) -> str:
        lines = [f"mechanism {self.scene.name}"]
        for number, kind in enumerate(self.kinds):
            names = [instance.name for instance in self.instances if instance.kind == number]
            shapes = len(kind.motion.alpha)
            lines.append(f"  kind {number + 1} of body, {shapes} shapes: {', '.join(names)}")
        joints = (f"{j.joint.name} ({j.joint.kind}{', driven' if j.drive else ''})" for j in self.joints)
        lines.append(f"  constraints: {', '.join(joints) or 'none'}")
        lines.append(f"  forces: {', '.join(force.element.name for force in self.forces) or 'none'}")
        lines += [f"  {e.what}: {e.reason}" for e in self.eliminated]
        return "\n".join([*lines, "  the equations, one row for each coordinate: print(mechanism.expanded())"])


def _expanded(mechanism: Mechanism) -> Equations:
    instances, rows = _instances(mechanism), mechanism.rows
    points = {GROUND: mechanism.ground, **{name: instance.points for name, instance in instances.items()}}

    def at(marker: MarkerRef) -> PointMotion:
        return points[marker.body][marker.marker]

    joints = [
        constraints(j.joint, j.type, RelativeMotion(at(j.joint.first), at(j.joint.second)), j.drive, rows)
        for j in mechanism.joints
    ]
    conditions = tuple(c for _, of_joint in joints for c in of_joint)
    refuse_idle(conditions, mechanism.scene.redundant)
    forces = [f.type.generalised_force(f.element, tuple(map(at, f.markers)), f.values, rows) for f in mechanism.forces]
    in_order = [instances[name].definitions for name in mechanism.order]
    dampings = [damping_force(damping, instances) for damping in mechanism.dampings]
    definitions = tuple(
        chain(mechanism.definitions, *in_order, *(own for own, _ in joints), *(f.definitions for f in forces))
    )
    parts = SceneMechanics(
        scene=mechanism.scene,
        ground=mechanism.ground,
        instances=instances,
        joints=mechanism.joints,
        eliminated_joints=mechanism.eliminated_joints,
        forces=mechanism.forces,
        generalised=(*forces, *dampings),
        constraints=conditions,
    )
    return _gathered(mechanism, parts, definitions)


def _instances(mechanism: Mechanism) -> Instances:
    result, groups = {}, set()
    for instance in mechanism.instances:
        group = instance.component.group
        repeated = group in groups
        groups.add(group)
        result[instance.name] = instance_equations(instance, mechanism.kinds[instance.kind], repeated)
    return result


def damping_force(damping: ComponentDamping, instances: Instances) -> GeneralisedForce:
    """The damping forces B alphadot on the amplitudes of the components of a body, and their power."""
    rows = [row for name in damping.components for row in instances[name].rows[RIGID:]]
    forces: dict[str, list[sp.Expr]] = {}
    for (i, j), entry in damping.entries.items():
        first, second = rows[i - 1], rows[j - 1]
        forces.setdefault(first.name, []).append(entry * second.v)
        if i != j:
            forces.setdefault(second.name, []).append(entry * first.v)
    totals = {name: sp.Add(*force) for name, force in forces.items()}
    terms = tuple(Term(row, DAMPING_TERM.name, DAMPING_TERM.equation, total) for row, total in totals.items())
    power = sp.Add(*(totals[row.name] * row.v for row in rows if row.name in totals))
    return GeneralisedForce(terms, dissipation=-power)


MET = sp.Rational(1, 10**10)
"""A constraint that no coordinate takes part in is met if it is off by at most this (m or rad): numbers are rounded."""


def refuse_idle(
    conditions: tuple[Constraint, ...],
    redundant: Redundant,
    known: Sequence[tuple[sp.Symbol, sp.Expr]] = (),
) -> None:
    """Raise SpecError for the constraints that no coordinate takes part in; redundant ones may be accepted.

    known: symbols in their positions with their values, each in terms of those before it; coordinates may have any.
    """
    prescribed = (
        "no coordinate can meet it, since the motion of both bodies is prescribed; leave out a drive or a joint"
    )
    implied = "this constraint is redundant: other joints and drives meet it in every state; leave out one of them"
    problems = []
    for c in (c for c in conditions if not c.jacobian):
        position = c.position
        for symbol, value in reversed(known):
            position = position.xreplace({symbol: value})
        if position.is_number and abs(position) <= MET:
            if redundant == "error":
                problems.append(Problem(f"joints.{c.of}", f"{c.doc}: {implied}"))
            continue
        off = f"it is off by {float(abs(position)):.3g}, and " if position.is_number else ""
        problems.append(Problem(f"joints.{c.of}", f"{c.doc}: {off}{prescribed}"))
    if problems:
        raise SpecError(tuple(problems))


def _gathered(mechanism: Mechanism, parts: SceneMechanics, definitions: tuple[Intermediate, ...]) -> Equations:
    scene, instances, conditions, forces = parts.scene, parts.instances, parts.constraints, parts.generalised
    bodies, rows, coordinates = list(instances.values()), mechanism.rows, mechanism.coordinates
    inputs = input_symbols(scene)
    moving = moving_symbols(definitions, inputs)
    outputs, of_outputs = output_equations(mechanism.outputs, parts)
    own = (*(b.coefficients for b in bodies), *(damping.constants for damping in mechanism.dampings))
    coefficients = (*constants_of_scene(mechanism.parameters, mechanism.constants, own), *of_outputs)
    refuse_equal_names(rows, conditions, coefficients, definitions)

    def summed(of: Iterable[sp.Expr]) -> sp.Expr:
        """The sum of the expressions without explicit time dependence; a prescribed motion supplies energy."""
        return sp.Add(*(e for e in of if not e.free_symbols & moving))

    terms = (*chain.from_iterable(b.terms for b in bodies), *chain.from_iterable(f.terms for f in forces))
    of_bodies = [b for b in bodies if b.rows]
    kinetic, strain, weight = (summed(b.energies[k] for b in of_bodies) for k in range(3))
    number = {row.name: i for i, row in enumerate(rows)}
    return Equations(
        name=scene.name,
        doc=mechanism_doc(scene, coordinates, conditions),
        frame_doc=frame_doc(mechanism.instances, scene),
        coordinates=coordinates,
        rows=rows,
        rates=tuple(row.v for row in rows),
        parameters=mechanism.parameters,
        splines=splines(functions_of_time(mechanism.scene)),
        coefficients=coefficients,
        definitions=definitions,
        terms=terms,
        vanished=tuple(v for b in bodies for v in b.vanished),
        mass=mass_matrix(rows, terms),
        mass_zeros=tuple((number[i], number[j], why) for b in bodies for i, j, why in b.mass_zeros),
        kinetic_energy=kinetic,
        strain_energy=strain + summed(f.potential for f in forces),
        weight_energy=weight if scene.gravity else None,
        linear_momentum=tuple(summed(b.linear[k] for b in of_bodies) for k in range(2)),
        angular_momentum=(summed(b.angular[0] for b in of_bodies),),
        markers=tuple(m for m in markers_of_scene(bodies) if not depends(m.definitions, m.position, moving)),
        constraints=conditions,
        inputs=inputs,
        outputs=outputs,
        poses=tuple(pose(name, instance) for name, instance in instances.items()),
        eliminated=(*mechanism.eliminated, *carried(instances, moving)),
    )


def functions_of_time(scene: AnyScene) -> Iterator[TimeFunction]:
    """The functions of time that the equations contain: those that are written, and the integrals of speeds."""
    yield from (function for _, function in time_functions(scene))
    yield from map(drive_motion, scene.drives)


def carried(instances: Instances, moving: frozenset[sp.Symbol]) -> list[Eliminated]:
    """The bodies whose pose depends on a prescribed motion, which functions without the argument t cannot describe."""
    reason = "a drive carries it along, and these functions know no time"
    names = [name for name, instance in instances.items() if instance.rows and _of_time(instance, moving)]
    return [Eliminated(f"{name} in energy, momentum and markers", reason) for name in names]


def constants_of_scene(
    parameters: tuple[ParameterSymbol, ...],
    constants: tuple[ModelConstant, ...],
    of_bodies: Iterable[tuple[ModelConstant, ...]],
) -> tuple[ModelConstant, ...]:
    """The constants of a mechanism, each once, where each parameter is one symbol whatever its assumptions."""
    canonical = {p.symbol.name: p.symbol for p in parameters}
    result: dict[sp.Symbol, ModelConstant] = {}
    for c in chain(constants, *of_bodies):
        known = {s: canonical[s.name] for s in c.value.free_symbols if s.name in canonical}
        result.setdefault(c.symbol, replace(c, value=c.value.xreplace(known)))
    return tuple(result.values())


def pose(name: str, instance: InstanceEquations) -> Pose:
    """Position and rotation of the body frame."""
    if BODY_FRAME in instance.points:
        frame = instance.points[BODY_FRAME]
        return Pose(name, (frame.position[0], frame.position[1]), frame.rotation)
    c1, c2, phi = (c.q for c in instance.coordinates[:3])
    return Pose(name, (c1, c2), phi)


def refuse_equal_names(
    rows: tuple[EquationOfMotion, ...],
    conditions: tuple[Constraint, ...],
    coefficients: tuple[ModelConstant, ...],
    definitions: tuple[Intermediate, ...],
) -> None:
    """Raise SpecError if two composed names coincide, so that one of the two parts must be renamed."""
    names = [str(s) for row in rows for s in (row.name, row.v, row.a)]
    names += [c.name for c in conditions] + [str(c.symbol) for c in coefficients] + [str(d.symbol) for d in definitions]
    twice = sorted(name for name, count in Counter(names).items() if count > 1)
    if twice:
        text = f"two things of this scene would be called {', '.join(twice)} in the code; give one another name"
        raise SpecError((Problem("bodies", text),))


def moving_symbols(definitions: tuple[Intermediate, ...], inputs: tuple[InputSymbol, ...]) -> frozenset[sp.Symbol]:
    """The time, the inputs, and all symbols that depend on them."""
    moving = {t, *(given.symbol for given in inputs)}
    for d in definitions:
        if d.expr.free_symbols & moving:
            moving.add(d.symbol)
    return frozenset(moving)


def depends(definitions: tuple[Intermediate, ...], position: sp.ImmutableMatrix, moving: frozenset[sp.Symbol]) -> bool:
    """Whether a marker depends on the time, which functions of markers do not get as an argument."""
    every = (position.free_symbols, *(d.expr.free_symbols for d in definitions))
    return any(symbols & moving for symbols in every)


def markers_of_scene(bodies: Iterable[InstanceEquations]) -> Iterator[MarkerEquations]:
    """The markers of all bodies, with a column and a row for each coordinate of the scene."""
    bodies = tuple(bodies)
    own = [len(body.rows) for body in bodies]
    for k, body in enumerate(bodies):
        before, after = sum(own[:k]), sum(own[k + 1 :])
        for m in body.markers:
            size = m.jacobian.rows
            columns = sp.zeros(size, before), m.jacobian, sp.zeros(size, after)
            load = (*[sp.S.Zero] * before, *m.load, *[sp.S.Zero] * after)
            yield replace(m, jacobian=sp.ImmutableMatrix.hstack(*columns), load=load)


def _of_time(body: InstanceEquations, moving: frozenset[sp.Symbol]) -> bool:
    """Whether energy or momentum of a body depend on time explicitly, because a drive prescribes its support."""
    return any(e.free_symbols & moving for e in (*body.energies, *body.linear, *body.angular))
