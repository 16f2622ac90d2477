"""A mechanism: equations once for each kind of body, instances that refer to a kind, and their expansion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain

import sympy as sp

from derive.mechanics.equations import Equations
from derive.mechanics.generic_forces import DAMPING_TERM
from derive.mechanics.multibody.bodies.body_type import ComponentDamping
from derive.mechanics.multibody.bodies.rigid import BODY_FRAME
from derive.mechanics.multibody.constraints import constraints
from derive.mechanics.multibody.forces.force_type import GeneralisedForce
from derive.mechanics.multibody.gathering import (
    Gathered,
    Instances,
    InstancesOfKinds,
    equations_of_mechanism,
    refuse_idle,
)
from derive.mechanics.multibody.instances import InstanceEquations
from derive.mechanics.multibody.kinds import EliminatedJoint, ForceInstance, JointInstance
from derive.mechanics.multibody.mechanism_text import frame_doc, mechanism_doc
from derive.mechanics.multibody.outputs.output_type import OutputInstance
from derive.mechanics.multibody.point_motion import PointMotion, RelativeMotion
from derive.mechanics.multibody.ports import output_equations
from derive.mechanics.multibody.scene_mechanics import SceneMechanics
from derive.mechanics.terms import Pose, Term
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.scene import Scene

RIGID = 3
"""The coordinates of a free body in the plane that come before its amplitudes."""


@dataclass(frozen=True)
class Mechanism(InstancesOfKinds):
    """The kinds, instances, joints and forces of a scene. `expanded()` returns the equations of the whole mechanism.

    ground: the markers of the inertial frame; joints: those that are constraints, with their drives; forces: what acts
    on markers; dampings: what acts between the components of a body; eliminated_joints: those that reduce the
    coordinates of bodies instead; outputs: what is computed from the state.
    """

    scene: Scene
    ground: Mapping[str, PointMotion]
    joints: tuple[JointInstance, ...]
    forces: tuple[ForceInstance, ...]
    dampings: tuple[ComponentDamping, ...]
    eliminated_joints: tuple[EliminatedJoint, ...]
    outputs: tuple[OutputInstance, ...]

    def __str__(self) -> str:
        joints = [f"{j.joint.name} ({j.joint.kind}{', driven' if j.drive else ''})" for j in self.joints]
        return self.summary("mechanism", {"constraints": joints, "forces": [f.element.name for f in self.forces]})

    def _equations(self) -> Equations:
        instances, rows = self.equations_of_instances(), self.rows
        points = {GROUND: self.ground, **{name: instance.points for name, instance in instances.items()}}

        def at(marker: MarkerRef) -> PointMotion:
            return points[marker.body][marker.marker]

        joints = [
            constraints(j.joint, j.type, RelativeMotion(at(j.joint.first), at(j.joint.second)), j.drive, rows)
            for j in self.joints
        ]
        conditions = tuple(c for _, of_joint in joints for c in of_joint)
        refuse_idle(conditions, self.scene.redundant)
        forces = [f.type.generalised_force(f.element, tuple(map(at, f.markers)), f.values, rows) for f in self.forces]
        forces += [damping_force(damping, instances) for damping in self.dampings]
        parts = SceneMechanics(
            scene=self.scene,
            ground=self.ground,
            instances=instances,
            joints=self.joints,
            eliminated_joints=self.eliminated_joints,
            forces=self.forces,
            generalised=tuple(forces),
            constraints=conditions,
        )
        outputs, of_outputs = output_equations(self.outputs, parts)
        contributions = Gathered(
            doc=mechanism_doc(self.scene, self.coordinates, conditions),
            frame_doc=frame_doc(self.instances, self.scene),
            conditions=conditions,
            terms=tuple(term for force in forces for term in force.terms),
            potentials=tuple(force.potential for force in forces),
            definitions=tuple(chain(*(own for own, _ in joints), *(force.definitions for force in forces))),
            outputs=outputs,
            poses=tuple(pose(name, instance) for name, instance in instances.items()),
            coefficients=tuple(constant for damping in self.dampings for constant in damping.constants),
            of_outputs=of_outputs,
        )
        return equations_of_mechanism(self, instances, contributions)


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


def pose(name: str, instance: InstanceEquations) -> Pose:
    """Position and rotation of the body frame."""
    if BODY_FRAME in instance.points:
        frame = instance.points[BODY_FRAME]
        return Pose(name, (frame.position[0], frame.position[1]), frame.rotation)
    c1, c2, phi = (c.q for c in instance.coordinates[:3])
    return Pose(name, (c1, c2), phi)
