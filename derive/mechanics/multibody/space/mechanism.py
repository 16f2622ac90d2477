"""A mechanism in space: equations once for each kind of body, instances that refer to a kind, and their expansion."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import Any

import sympy as sp

from derive.mechanics.equations import Equations
from derive.mechanics.expansion import mass_matrix
from derive.mechanics.multibody.bodies.body_type import ComponentDamping
from derive.mechanics.multibody.bodies.rigid import BODY_FRAME
from derive.mechanics.multibody.instances import InstanceEquations, instance_equations
from derive.mechanics.multibody.joints.joint_type import PrescribedMotion
from derive.mechanics.multibody.kinds import BodyInstance, BodyKind
from derive.mechanics.multibody.mechanism import (
    carried,
    constants_of_scene,
    depends,
    functions_of_time,
    markers_of_scene,
    moving_symbols,
    refuse_equal_names,
    refuse_idle,
)
from derive.mechanics.multibody.mechanism_text import BETWEEN_BODIES, count_text
from derive.mechanics.multibody.ports import input_symbols
from derive.mechanics.multibody.space.constraints import row_values, spatial_constraints
from derive.mechanics.multibody.space.forces import MarkerLoad, loads_of
from derive.mechanics.multibody.space.frame_motion import FrameMotion
from derive.mechanics.multibody.space.joints import SpatialJointType
from derive.mechanics.multibody.space.outputs import SpatialParts, spatial_output_equations
from derive.mechanics.multibody.space.rows import RelativeFunction, derived
from derive.mechanics.terms import (
    Constraint,
    Coordinate,
    Eliminated,
    EquationOfMotion,
    Intermediate,
    ModelConstant,
    ParameterSymbol,
    SpatialPose,
)
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.scene_functions import splines
from derive.spec.model.spatial_scene import SpatialAction, SpatialJoint, SpatialScene


@dataclass(frozen=True)
class SpatialJointInstance:
    """A joint that is a constraint: its markers are on instances or on the ground."""

    joint: SpatialJoint
    type: SpatialJointType
    drive: PrescribedMotion | None

    @property
    def rows(self) -> tuple[RelativeFunction, ...]:
        """The rows that vanish, that of the drive behind those of the joint."""
        driven = self.type.driven if self.drive else None
        return (*self.type.rows(self.joint), *((driven.row,) if driven else ()))

    @property
    def multipliers(self) -> int:
        """The number of constraints, one for each row that the joint removes and one for its drive."""
        return len(self.rows)


@dataclass(frozen=True)
class SpatialEliminatedJoint:
    """A joint that has eliminated coordinates of the body it supports, and is no constraint.

    `own` is the marker on that body, `known` the other one, whose motion is known.
    """

    joint: SpatialJoint
    type: SpatialJointType
    drive: PrescribedMotion | None
    own: MarkerRef
    known: MarkerRef


@dataclass(frozen=True)
class SpatialActionInstance:
    """A force, a torque or a spring, with the values of its keys as expressions."""

    element: SpatialAction
    values: Mapping[str, Any]


@dataclass(frozen=True)
class SpatialMechanism:
    """The kinds, instances, joints and forces of a scene in space. `expanded()` returns the equations of all of them.

    The fields are those of a planar mechanism; `ground` are the marker frames of the inertial frame.
    """

    scene: SpatialScene
    kinds: tuple[BodyKind, ...]
    instances: tuple[BodyInstance, ...]
    order: tuple[str, ...]
    ground: Mapping[str, FrameMotion]
    joints: tuple[SpatialJointInstance, ...]
    eliminated_joints: tuple[SpatialEliminatedJoint, ...]
    forces: tuple[SpatialActionInstance, ...]
    parameters: tuple[ParameterSymbol, ...]
    constants: tuple[ModelConstant, ...]
    definitions: tuple[Intermediate, ...]
    eliminated: tuple[Eliminated, ...]

    @property
    def dampings(self) -> tuple[ComponentDamping, ...]:
        """Damping between components of a body: none, since no body in space has several."""
        return ()

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """The coordinates of all instances."""
        return tuple(c for instance in self.instances for c in instance.coordinates.coordinates)

    @property
    def rows(self) -> tuple[EquationOfMotion, ...]:
        """The equations of motion of all instances."""
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
        lines = [f"mechanism in space {self.scene.name}"]
        for number, kind in enumerate(self.kinds):
            names = [instance.name for instance in self.instances if instance.kind == number]
            lines.append(f"  kind {number + 1} of body, {len(kind.motion.alpha)} shapes: {', '.join(names)}")
        joints = (f"{j.joint.name} ({j.joint.kind}{', driven' if j.drive else ''})" for j in self.joints)
        lines.append(f"  constraints: {', '.join(joints) or 'none'}")
        lines += [f"  {e.what}: {e.reason}" for e in self.eliminated]
        return "\n".join([*lines, "  the equations, one row for each velocity: print(mechanism.expanded())"])


def _expanded(mechanism: SpatialMechanism) -> Equations:
    instances = _instances(mechanism)
    frames = {GROUND: mechanism.ground, **{name: instance.frames for name, instance in instances.items()}}
    scene, rows, coordinates = mechanism.scene, mechanism.rows, mechanism.coordinates

    def at(marker: MarkerRef) -> FrameMotion:
        return frames[marker.body][marker.marker]

    conditions = tuple(
        condition
        for j in mechanism.joints
        for condition in spatial_constraints(j.joint, j.type, at(j.joint.first), at(j.joint.second), j.drive, rows)
    )
    in_order = [instances[name].definitions for name in mechanism.order]
    known = [(c.q, sp.S.Zero) for c in coordinates]
    known += [(c.symbol, c.value) for c in chain(*(i.coefficients for i in instances.values()), mechanism.constants)]
    known += [(d.symbol, d.expr) for d in chain(mechanism.definitions, *in_order)]
    refuse_idle(conditions, scene.redundant, known)
    actions = tuple(loads_of(f.element, tuple(map(at, f.element.markers)), f.values) for f in mechanism.forces)
    definitions = tuple(chain(mechanism.definitions, *in_order, *(action.definitions for action in actions)))
    bodies, inputs = list(instances.values()), input_symbols(scene)
    moving = moving_symbols(definitions, inputs)
    coefficients = constants_of_scene(mechanism.parameters, mechanism.constants, (b.coefficients for b in bodies))
    refuse_equal_names(rows, conditions, coefficients, definitions)

    def summed(of: Iterable[sp.Expr]) -> sp.Expr:
        """The sum of the expressions without explicit time dependence; a prescribed motion supplies energy."""
        return sp.Add(*(e for e in of if not e.free_symbols & moving))

    terms = (*chain.from_iterable(b.terms for b in bodies), *chain.from_iterable(a.terms(at, rows) for a in actions))
    parts = SpatialParts(
        scene=scene,
        at=at,
        instances=instances,
        actions=actions,
        joint_loads=_joint_loads(mechanism, conditions, at),
        supports={j.joint.name: j.own for j in mechanism.eliminated_joints},
    )
    of_bodies = [b for b in bodies if b.rows]
    kinetic, strain, weight = (summed(b.energies[k] for b in of_bodies) for k in range(3))
    number = {row.name: i for i, row in enumerate(rows)}
    return Equations(
        name=scene.name,
        doc=_doc(scene, coordinates, rows, conditions),
        frame_doc=f"For several bodies {BETWEEN_BODIES}.",
        coordinates=coordinates,
        rows=rows,
        rates=tuple(rate for b in bodies for rate in b.rates),
        parameters=mechanism.parameters,
        splines=splines(functions_of_time(scene)),
        coefficients=coefficients,
        definitions=definitions,
        terms=terms,
        vanished=tuple(v for b in bodies for v in b.vanished),
        mass=mass_matrix(rows, terms),
        mass_zeros=tuple((number[i], number[j], why) for b in bodies for i, j, why in b.mass_zeros),
        kinetic_energy=kinetic,
        strain_energy=strain + summed(action.potential for action in actions),
        weight_energy=weight if scene.gravity else None,
        linear_momentum=tuple(summed(b.linear[k] for b in of_bodies) for k in range(3)),
        angular_momentum=tuple(summed(b.angular[k] for b in of_bodies) for k in range(3)),
        markers=tuple(m for m in markers_of_scene(bodies) if not depends(m.definitions, m.position, moving)),
        constraints=conditions,
        inputs=inputs,
        outputs=spatial_output_equations(scene.outputs, parts),
        poses=tuple(_pose(name, instance) for name, instance in instances.items()),
        eliminated=(*mechanism.eliminated, *carried(instances, moving)),
    )


def _joint_loads(
    mechanism: SpatialMechanism, conditions: tuple[Constraint, ...], at: Callable[[MarkerRef], FrameMotion]
) -> dict[str, tuple[MarkerLoad, ...]]:
    """The loads of each joint that is a constraint, with its drive, on both bodies, in terms of its multipliers."""
    result: dict[str, tuple[MarkerLoad, ...]] = {}
    for j in mechanism.joints:
        own = [c for c in conditions if c.of == j.joint.name]
        values = row_values(j.joint, at(j.joint.first), at(j.joint.second), j.drive)
        totals = [sp.zeros(3, 1) for _ in range(4)]
        for row, condition in zip(j.rows, own, strict=True):
            of = derived(row)
            factors = (of.f1, of.m1, of.f2, of.m2)
            totals = [t + f.xreplace(values) * condition.multiplier for t, f in zip(totals, factors, strict=True)]
        f1, m1, f2, m2 = totals
        result[j.joint.name] = (MarkerLoad(j.joint.first, f1, m1), MarkerLoad(j.joint.second, f2, m2))
    return result


def _instances(mechanism: SpatialMechanism) -> Mapping[str, InstanceEquations]:
    return {
        instance.name: instance_equations(instance, mechanism.kinds[instance.kind], False)
        for instance in mechanism.instances
    }


def _pose(name: str, instance: InstanceEquations) -> SpatialPose:
    """Position and rotation tensor of the body frame."""
    frame = instance.frames[BODY_FRAME]
    return SpatialPose(name, tuple(frame.position), tuple(frame.frame))


def _doc(
    scene: SpatialScene,
    coordinates: tuple[Coordinate, ...],
    rows: tuple[EquationOfMotion, ...],
    conditions: tuple[Constraint, ...],
) -> str:
    """A line that summarises what a mechanism consists of."""
    return (
        f"scene of {count_text(scene.bodies, 'bod', 'y in space', 'ies in space')}: "
        f"{count_text(coordinates, 'coordinate')}, {count_text(rows, 'velocit', 'y', 'ies')}, "
        f"{count_text(conditions, 'constraint')}, {count_text(rows[len(conditions) :], 'degree')} of freedom"
    )
