"""The equations of a class of bodies: those of its first member with what it contributes to its joints.

Constraints are linear in the displacement and the rotation between the two markers of a joint, so that g, gdot and
gamma are sums of what each body contributes, and of the contribution of points whose motion is known.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import sympy as sp

from derive.lowering.instances.classes import BodyClass, Handle
from derive.mechanics.equations import Equations
from derive.mechanics.expansion import mass_matrix
from derive.mechanics.multibody.constraints import constraints
from derive.mechanics.multibody.instances import InstanceEquations, instance_equations
from derive.mechanics.multibody.kinds import JointInstance
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.multibody.point_motion import PointMotion, RelativeMotion, fixed_point
from derive.mechanics.terms import Constraint, Eliminated, Intermediate, Pose
from derive.spec.model.markers import GROUND

STILL = fixed_point(sp.Matrix([0, 0]))


@dataclass(frozen=True)
class ClassEquations:
    """The equations of the first member of a class.

    Its `constraints` are what it contributes to those of its joints, one joint after the other; `rows` are their
    numbers for each of its handles.
    """

    equations: Equations
    rows: tuple[tuple[int, ...], ...]
    own: InstanceEquations


def class_equations(mechanism: Mechanism, of: BodyClass) -> ClassEquations:
    """The equations of the first member of a class, in its symbols."""
    instance = of.first.instance
    own = instance_equations(instance, mechanism.kinds[instance.kind], False)
    definitions, conditions, rows = list(own.definitions), list[Constraint](), []
    for handle in of.first.handles:
        joint = mechanism.joints[handle.joint]
        defined, contributed = _contribution(joint, handle, own)
        definitions += defined
        rows.append(tuple(range(len(conditions), len(conditions) + len(contributed))))
        conditions += contributed
    number = {row.name: i for i, row in enumerate(own.rows)}
    equations = Equations(
        name=mechanism.scene.name,
        doc="",
        frame_doc="",
        coordinates=own.coordinates,
        rows=own.rows,
        rates=tuple(row.v for row in own.rows),
        parameters=(),
        coefficients=own.coefficients,
        definitions=tuple(definitions),
        terms=own.terms,
        vanished=own.vanished,
        mass=mass_matrix(own.rows, own.terms),
        mass_zeros=tuple((number[i], number[j], why) for i, j, why in own.mass_zeros),
        kinetic_energy=own.energies[0],
        strain_energy=own.energies[1],
        weight_energy=own.energies[2] if mechanism.scene.gravity else None,
        linear_momentum=own.linear,
        angular_momentum=own.angular,
        markers=own.markers,
        constraints=tuple(conditions),
        poses=(Pose(instance.name, (own.coordinates[0].q, own.coordinates[1].q), own.coordinates[2].q),),
        eliminated=(Eliminated(GROUND, "it does not move"),),
    )
    return ClassEquations(equations, tuple(rows), own)


def _contribution(
    joint: JointInstance, handle: Handle, own: InstanceEquations
) -> tuple[tuple[Intermediate, ...], tuple[Constraint, ...]]:
    """The definitions and the parts of the constraints of a joint that depend on one of its bodies."""
    point = own.points[handle.marker]
    relative = RelativeMotion(point, STILL) if handle.is_first else RelativeMotion(STILL, point)
    definitions, conditions = constraints(joint.joint, joint.type, relative, None, own.rows)
    offsets = known_constraints(joint, STILL, STILL)
    return definitions, tuple(
        replace(c, position=sp.expand(c.position - offset.position))
        for c, offset in zip(conditions, offsets, strict=True)
    )


def known_constraints(joint: JointInstance, first: PointMotion, second: PointMotion) -> tuple[Constraint, ...]:
    """The constraints of a joint between two points whose motion is known; a body with coordinates is at rest in 0."""
    _, conditions = constraints(joint.joint, joint.type, RelativeMotion(first, second), joint.drive, ())
    return conditions
