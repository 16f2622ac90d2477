"""A mechanism: equations once for each kind of body, instances that refer to a kind, and their expansion."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING

from derive.mechanics.multibody.bodies.rigid import BODY_FRAME
from derive.mechanics.multibody.component_damping import damping_force
from derive.mechanics.multibody.constraints import constraints
from derive.mechanics.multibody.gathering import (
    Gathered,
    InstancesOfKinds,
    equations_of_mechanism,
    refuse_idle,
)
from derive.mechanics.multibody.mechanism_text import frame_doc, mechanism_doc
from derive.mechanics.multibody.point_motion import PointMotion, RelativeMotion
from derive.mechanics.multibody.ports import output_equations
from derive.mechanics.multibody.scene_mechanics import SceneMechanics
from derive.mechanics.terms import Pose
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.scene import Scene

if TYPE_CHECKING:
    from derive.mechanics.equations import Equations
    from derive.mechanics.multibody.bodies.body_type import ComponentDamping
    from derive.mechanics.multibody.forces.force_type import GeneralisedForce
    from derive.mechanics.multibody.instances import InstanceEquations
    from derive.mechanics.multibody.kinds import EliminatedJoint, ForceInstance, JointInstance
    from derive.mechanics.multibody.outputs.output_type import OutputInstance
    from derive.mechanics.terms import Constraint, EquationOfMotion


@dataclass(frozen=True, repr=False)
class Mechanism(InstancesOfKinds):
    """The kinds, instances, joints and forces of a scene: the equations once for each kind of body.

    `expanded()` returns the equations of the whole mechanism.

    Attributes:
        scene: the scene that it describes.
        kinds: the kinds of bodies, with their equations.
        instances: the bodies, each of which refers to a kind by its number.
        order: the names of the bodies in the order of the coordinates.
        parameters: the symbols of run-time parameters with their defaults.
        constants: what depends on parameters alone.
        definitions: what bodies and joints share.
        eliminated: coordinates and constraints that are eliminated.
        ground: the markers of the inertial frame.
        joints: those that are constraints, with their drives.
        forces: what acts on markers.
        dampings: what acts between the components of a body.
        eliminated_joints: joints that reduce the coordinates of bodies instead.
        outputs: what is computed from the state.

    Examples:
        >>> import derive
        >>> pendulum = derive.scene(
        ...     "pendulum",
        ...     gravity=(0, -9.81),
        ...     ground={"pivot": (0, 0)},
        ...     bodies={"rod": {"mass": 1, "inertia": "1/12", "markers": {"top": (0, 0.5)}}},
        ...     joints={"hinge": {"kind": "revolute", "between": ["ground.pivot", "rod.top"]}},
        ... )
        >>> mechanism = derive.derive(pendulum)
        >>> mechanism.names, len(mechanism.joints), len(mechanism.eliminated_joints)
        (('rod',), 0, 1)
        >>> mechanism.expanded().row("rod_phi")
        rod_phiddot/3 + 981*sin(rod_phi)/200
    """

    scene: Scene
    ground: Mapping[str, PointMotion]
    joints: tuple[JointInstance, ...]
    forces: tuple[ForceInstance, ...]
    dampings: tuple[ComponentDamping, ...]
    eliminated_joints: tuple[EliminatedJoint, ...]
    outputs: tuple[OutputInstance, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the instances."""
        return tuple(instance.name for instance in self.instances)

    def __str__(self) -> str:
        joints = [f"{j.joint.name} ({j.joint.kind}{', driven' if j.drive else ''})" for j in self.joints]
        return self.summary("mechanism", {"constraints": joints, "forces": [f.element.name for f in self.forces]})

    def loads(
        self, f: ForceInstance, at: Callable[[MarkerRef], PointMotion], rows: tuple[EquationOfMotion, ...]
    ) -> GeneralisedForce:
        """The virtual work of a force.

        Arguments:
            f: one of `forces`.
            at: a function from its markers to their motions.
            rows: the rows of the bodies that these are on.

        Examples:
            >>> import derive
            >>> rod = {"mass": 1, "inertia": 1, "markers": {"tip": [0, 1]}}
            >>> push = {"at": "rod.tip", "components": [2, 0]}
            >>> mechanism = derive.derive(derive.scene("pushed", bodies={"rod": rod}, forces={"push": push}))
            >>> points = mechanism.equations_of_instances()["rod"].points
            >>> loads = mechanism.loads(mechanism.forces[0], lambda marker: points[marker.marker], mechanism.rows)
            >>> [(term.row, term.expr) for term in loads.terms]
            [('rod_c1', -2), ('rod_phi', 2*rod_tip_s_2)]
        """
        return f.type.generalised_force(f.element, tuple(map(at, f.markers)), f.values, rows)

    def pose(self, name: str, instance: InstanceEquations) -> Pose:
        """Position and rotation of the body frame.

        Arguments:
            name: the name of the instance of a body.
            instance: its equations.

        Examples:
            >>> import derive
            >>> mechanism = derive.derive(derive.scene("free", bodies={"rod": {"mass": 1, "inertia": 1}}))
            >>> mechanism.pose("rod", mechanism.equations_of_instances()["rod"]).rotation_angle
            rod_phi
        """
        if BODY_FRAME in instance.points:
            frame = instance.points[BODY_FRAME]
            return Pose(name, (frame.position[0], frame.position[1]), frame.rotation)
        c1, c2, phi = (c.q for c in instance.coordinates[:3])
        return Pose(name, (c1, c2), phi)

    def doc(self, conditions: tuple[Constraint, ...]) -> str:
        """A line that summarises what the mechanism consists of.

        Arguments:
            conditions: its constraints.

        Examples:
            >>> import derive
            >>> derive.derive(derive.scene("free", bodies={"rod": {"mass": 1, "inertia": 1}})).doc(())
            'scene of 1 planar body: 3 coordinates, 0 constraints, 3 degrees of freedom'
        """
        return mechanism_doc(self.scene, self.coordinates, conditions)

    def frame_doc(self, by_table: bool = False) -> str:
        """The description of the frames of the bodies.

        Arguments:
            by_table: whether all instances of a table have one.

        Examples:
            >>> import derive
            >>> free = derive.derive(derive.scene("free", bodies={"rod": {"mass": 1, "inertia": 1}}))
            >>> free.frame_doc().splitlines()[0]
            'For beams, c is the position of the centre of the undeformed beam.'
        """
        return frame_doc(self.instances, self.scene, by_table)

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
        forces = [self.loads(f, at, rows) for f in self.forces]
        parts = SceneMechanics(
            scene=self.scene,
            ground=self.ground,
            instances=instances,
            joints=self.joints,
            eliminated_joints=self.eliminated_joints,
            forces=self.forces,
            generalised=tuple(forces),
            dampings=self.dampings,
            constraints=conditions,
        )
        outputs, of_outputs = output_equations(self.outputs, parts)
        forces += [damping_force(damping, instances) for damping in self.dampings]
        contributions = Gathered(
            doc=self.doc(conditions),
            frame_doc=self.frame_doc(),
            conditions=conditions,
            terms=tuple(term for force in forces for term in force.terms),
            potentials=tuple(force.potential for force in forces),
            definitions=tuple(chain(*(own for own, _ in joints), *(force.definitions for force in forces))),
            outputs=outputs,
            poses=tuple(self.pose(name, instance) for name, instance in instances.items()),
            coefficients=tuple(constant for damping in self.dampings for constant in damping.constants),
            of_outputs=of_outputs,
        )
        return equations_of_mechanism(self, instances, contributions)
