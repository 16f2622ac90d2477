"""A mechanism in space: equations once for each kind of body, instances that refer to a kind, and their expansion."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Any

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.multibody.bodies.rigid import BODY_FRAME
from derive.mechanics.multibody.component_damping import damping_force
from derive.mechanics.multibody.gathering import Gathered, InstancesOfKinds, equations_of_mechanism, refuse_idle
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.multibody.mechanism_text import BETWEEN_BODIES, count_text
from derive.mechanics.multibody.space.actions import loads_of
from derive.mechanics.multibody.space.constraints import row_values, spatial_constraints
from derive.mechanics.multibody.space.forces import MarkerLoad
from derive.mechanics.multibody.space.gears import GearInstance, gear_constraint, gear_loads
from derive.mechanics.multibody.space.joint_motion import (
    JointMotion,
    counted_rotation,
    drive_constraint,
    joint_motion,
)
from derive.mechanics.multibody.space.output_parts import SpatialParts
from derive.mechanics.multibody.space.outputs import spatial_output_equations
from derive.mechanics.multibody.space.rows import derived
from derive.mechanics.multibody.space.tree.recursions import TreeBody, tree_body, tree_equations
from derive.mechanics.terms import Constraint, EquationOfMotion, SpatialPose
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.spatial_forces import SpatialAction, SpatialSpring
from derive.spec.model.spatial_scene import SpatialScene

if TYPE_CHECKING:
    from derive.mechanics.equations import Equations
    from derive.mechanics.multibody.bodies.body_type import ComponentDamping
    from derive.mechanics.multibody.instances import InstanceEquations
    from derive.mechanics.multibody.space.forces import ActionLoads
    from derive.mechanics.multibody.space.frame_motion import FrameMotion
    from derive.mechanics.multibody.space.joints import SpatialEliminatedJoint, SpatialJointInstance


@dataclass(frozen=True)
class SpatialActionInstance:
    """A force, a torque or a spring, with the markers at which it acts and the values of its keys as expressions."""

    element: SpatialAction
    markers: tuple[MarkerRef, ...]
    values: Mapping[str, Any]


@dataclass(frozen=True, repr=False)
class SpatialMechanism(InstancesOfKinds):
    """The kinds, instances, joints and forces of a scene in space. `expanded()` returns the equations of all of them.

    The fields are those of a planar mechanism; `ground` are the marker frames of the inertial frame.
    """

    scene: SpatialScene
    ground: Mapping[str, FrameMotion]
    joints: tuple[SpatialJointInstance, ...]
    eliminated_joints: tuple[SpatialEliminatedJoint, ...]
    gears: tuple[GearInstance, ...]
    forces: tuple[SpatialActionInstance, ...]
    dampings: tuple[ComponentDamping, ...]

    def __str__(self) -> str:
        joints = (f"{j.joint.name} ({j.joint.kind}{', driven' if j.drive else ''})" for j in self.joints)
        gears = (f"{g.gear.name} (gear)" for g in self.gears)
        return self.summary("mechanism in space", {"constraints": [*joints, *gears]})

    @property
    def joints_by_name(self) -> Mapping[str, SpatialJointInstance | SpatialEliminatedJoint]:
        """All joints by their names, those that have eliminated coordinates as well."""
        joints: dict[str, SpatialJointInstance | SpatialEliminatedJoint] = {j.joint.name: j for j in self.joints}
        return joints | {j.joint.name: j for j in self.eliminated_joints}

    def joint_of(self, f: SpatialActionInstance) -> SpatialJointInstance | SpatialEliminatedJoint | None:
        """The joint between the markers of a spring, which may count its turns."""
        between = self.scene.joint_between(*f.markers) if isinstance(f.element, SpatialSpring) else None
        return None if between is None else self.joints_by_name[between.name]

    def loads(
        self, f: SpatialActionInstance, at: Callable[[MarkerRef], FrameMotion], rows: tuple[EquationOfMotion, ...]
    ) -> ActionLoads:
        """The loads of an action; at: the motions of its markers, rows: those of the bodies that these are on."""

        def motion(joint: str) -> JointMotion:
            return joint_motion(self.joints_by_name[joint], at, self.instances_by_name, rows)

        joint = self.joint_of(f)
        turns = None if joint is None else counted_rotation(joint, at, motion, f.markers[0])
        return loads_of(f.element, f.markers, tuple(map(at, f.markers)), f.values, turns)

    def pose(self, name: str, instance: InstanceEquations) -> SpatialPose:
        """Position and rotation tensor of the body frame."""
        frame = instance.frames[BODY_FRAME]
        return SpatialPose(name, tuple(frame.position), tuple(frame.frame))

    def doc(self, conditions: tuple[Constraint, ...]) -> str:
        """A line that summarises what the mechanism consists of."""
        return (
            f"scene of {count_text(self.scene.bodies, 'bod', 'y in space', 'ies in space')}: "
            f"{count_text(self.coordinates, 'coordinate')}, {count_text(self.rows, 'velocit', 'y', 'ies')}, "
            f"{count_text(conditions, 'constraint')}, {count_text(self.rows[len(conditions) :], 'degree')} of freedom"
        )

    def frame_doc(self, by_table: bool = False) -> str:
        """The description of the frames of the bodies, which is the same for all of them."""
        return f"For several bodies {BETWEEN_BODIES}."

    def _trees(self) -> tuple[TreeBody, ...]:
        """The bodies that have coordinates of joints between bodies that move."""
        return tuple(
            tree_body(name, of.component.group, carried, of.component.body.constants)
            for name in self.order
            for of in [self.instances_by_name[name]]
            if of.coordinates.is_carried and (carried := of.coordinates.carried)
        )

    def _gravity(self) -> sp.Matrix:
        """The acceleration of free fall (3, 1)."""
        gravity, _ = quantity.gravity(self.scene.gravity)
        return sp.Matrix([sp.S.Zero if g.zero else g.symbol for g in gravity] or [sp.S.Zero] * 3)

    def conditions(
        self, at: Callable[[MarkerRef], FrameMotion], rows: tuple[EquationOfMotion, ...]
    ) -> tuple[Constraint, ...]:
        """The constraints of joints, drives and gears; at: the motions of markers, rows: those with factors in G."""
        joints = self.joints_by_name

        def motion(joint: str) -> JointMotion:
            return joint_motion(joints[joint], at, self.instances_by_name, rows)

        of_joints = (
            condition
            for j in self.joints
            for condition in spatial_constraints(j.joint, j.rows, at(j.joint.first), at(j.joint.second), j.drive, rows)
        )
        of_drives = (
            drive_constraint(j, motion(j.joint.name), rows)
            for j in self.eliminated_joints
            if j.drive and j.keeps_coordinate
        )
        return (*of_joints, *of_drives, *(gear_constraint(gear, motion, rows) for gear in self.gears))

    def _equations(self) -> Equations:
        instances = self.equations_of_instances()
        frames = {GROUND: self.ground, **{name: instance.frames for name, instance in instances.items()}}
        scene, rows = self.scene, self.rows

        def at(marker: MarkerRef) -> FrameMotion:
            return frames[marker.body][marker.marker]

        joints = self.joints_by_name

        def motion(joint: str) -> JointMotion:
            return joint_motion(joints[joint], at, self.instances_by_name, rows)

        conditions = self.conditions(at, rows)
        in_order = [instances[name].definitions for name in self.order]
        known = [(c.q, sp.S.Zero) for c in self.coordinates]
        known += [(c.symbol, c.value) for c in chain(*(i.coefficients for i in instances.values()), self.constants)]
        known += [(d.symbol, d.expr) for d in chain(self.definitions, *in_order)]
        refuse_idle(conditions, scene.redundant, known)
        actions = tuple(self.loads(f, at, rows) for f in self.forces)
        damped = [damping_force(damping, instances) for damping in self.dampings]
        of_gears = [
            load
            for gear in self.gears
            for condition in conditions
            if condition.section == "gears" and condition.of == gear.gear.name
            for load in gear_loads(gear, condition.multiplier, motion)
        ]
        parts = SpatialParts(
            scene=scene,
            at=at,
            instances=instances,
            actions=actions,
            joint_loads={
                j.joint.name: joint_loads(j, (c.multiplier for c in conditions if _is_of(c, j)), at)
                for j in self.joints
            },
            supports={j.joint.name: j.own for j in self.eliminated_joints},
            joints=joints,
            drive_multipliers={c.shown: c.multiplier for c in conditions if c.shown in {d.name for d in scene.drives}},
            motion=motion,
            gear_loads=lambda body: (load for load in of_gears if load.marker.body == body),
            dissipations=tuple(force.dissipation for force in damped),
        )
        outputs, of_outputs = spatial_output_equations(scene.outputs, parts)
        bodies = self._trees()
        tree = tree_equations(bodies, self._gravity())
        contributions = Gathered(
            doc=self.doc(conditions),
            frame_doc=self.frame_doc(),
            conditions=conditions,
            terms=(
                *tree.terms,
                *(term for action in actions for term in action.terms(at, rows)),
                *(term for force in damped for term in force.terms),
            ),
            potentials=tuple(action.potential for action in actions),
            definitions=(*tree.definitions, *(d for action in actions for d in action.definitions)),
            outputs=outputs,
            poses=tuple(self.pose(name, instance) for name, instance in instances.items()),
            coefficients=tuple(constant for damping in self.dampings for constant in damping.constants),
            of_outputs=of_outputs,
            trees=bodies,
            mass_zeros=tree.mass_zeros,
        )
        return equations_of_mechanism(self, instances, contributions)


def _is_of(condition: Constraint, j: SpatialJointInstance) -> bool:
    return condition.section == "joints" and condition.of == j.joint.name


def joint_loads(
    j: SpatialJointInstance, multipliers: Iterable[sp.Expr], at: Callable[[MarkerRef], FrameMotion]
) -> tuple[MarkerLoad, MarkerLoad]:
    """The loads of a joint that is a constraint, with its drive, on both bodies, in terms of its multipliers."""
    values = row_values(j.joint, at(j.joint.first), at(j.joint.second), j.drive)
    totals = [sp.zeros(3, 1) for _ in range(4)]
    for row, multiplier in zip(j.rows, multipliers, strict=True):
        of = derived(row)
        factors = (of.f1, of.m1, of.f2, of.m2)
        totals = [t + f.xreplace(values) * multiplier for t, f in zip(totals, factors, strict=True)]
    f1, m1, f2, m2 = totals
    return MarkerLoad(j.joint.first, f1, m1), MarkerLoad(j.joint.second, f2, m2)


AnyMechanism = Mechanism | SpatialMechanism
"""A mechanism in the plane or in space."""
