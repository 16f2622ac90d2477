"""The assembly of a mechanism in space from a scene: bodies in minimal coordinates, joints, drives and forces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from derive.algebra import sp
from derive.errors import Problem, SpecError
from derive.mechanics.motion.rotations import matrix_of
from derive.mechanics.multibody.assembly import SceneAssembly
from derive.mechanics.multibody.parameters import spatial_parameters
from derive.mechanics.multibody.space.actions import keys_of, specified
from derive.mechanics.multibody.space.bodies import SPATIAL_BODIES
from derive.mechanics.multibody.space.constraints import lead
from derive.mechanics.multibody.space.coordinates import free_spatial_coordinates
from derive.mechanics.multibody.space.flexible import Flexible, ReducedBody
from derive.mechanics.multibody.space.frame_motion import FrameMotion, fixed_axes, fixed_frame
from derive.mechanics.multibody.space.gears import GearInstance
from derive.mechanics.multibody.space.joint_elimination import (
    SpatialSupport,
    joint_coordinates,
    minimal_spatial_coordinates,
    reason_text,
)
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS, SpatialEliminatedJoint, SpatialJointInstance
from derive.mechanics.multibody.space.mechanism import SpatialActionInstance, SpatialMechanism
from derive.mechanics.multibody.space.tree.coordinates import (
    DerivedWhenNeeded,
    behind_moving_marker,
    own_coordinates,
    root_of_tree,
)
from derive.mechanics.multibody.space.tree.plan import PlannedLink, trees
from derive.mechanics.symbols import element
from derive.mechanics.terms import Eliminated
from derive.spec.model.beam_pieces import in_pieces
from derive.spec.model.keys import declared_keys
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.spatial_forces import SpatialTorque
from derive.spec.model.spatial_scene import Gear, SpatialJoint, SpatialScene

if TYPE_CHECKING:
    from derive.mechanics.multibody.bodies.body_type import BodyType, Component
    from derive.mechanics.multibody.coordinates import CoordinateMap
    from derive.mechanics.multibody.kinds import BodyInstance
    from derive.mechanics.multibody.space.joint_coordinate import JointCoordinate

_PITCH = next(key for key in declared_keys(SpatialJoint) if key.name == "pitch")


def spatial_mechanism(scene: SpatialScene, reduced: Mapping[str, ReducedBody], looped: bool) -> SpatialMechanism:
    """The mechanism of a scene in space, with equations once for each kind of body.

    reduced: the finite-element bodies as numbers, by their names; looped: see `Flexible`.

    Raises SpecError with what does not go together, UnknownNameError for a body or joint that no registry knows.
    """
    result: SpatialMechanism = _SpatialAssembly(in_pieces(scene), reduced, looped).mechanism()
    return result


class _SpatialAssembly(SceneAssembly):
    """The state of joint elimination of a scene in space."""

    def __init__(self, scene: SpatialScene, reduced: Mapping[str, ReducedBody], looped: bool) -> None:
        self.reduced, self.looped = reduced, looped
        self.links = trees(scene)
        self.of_trees = {link.body for link in self.links}
        super().__init__(scene)

    def _eliminate(self) -> None:
        super()._eliminate()  # prescribed motions first, on which trees hang
        self._eliminate_trees()

    def _eliminate_trees(self) -> None:
        """Give the bodies of trees the coordinates of their joints."""
        joints = {joint.name: joint for joint in self.joints}
        self._refuse_massless(self.links)
        for link in self.links:
            body = self.bodies[link.body]
            if link.joint is None:
                (component,) = self.type_of(body).components(body, self.gravity)
                coordinates = root_of_tree(body.name, component.body.motion)
            else:
                joint = joints[link.joint.name]
                about = self.type_of(body).about(body, self._ends(body, joint)[0].marker, self.gravity)
                assert about is not None, "rigid bodies have their origin where a joint wants it"
                component = about
                coordinates = self._behind(body, joint, component)
                eliminated = self._eliminated_joint(body, joint)
                self.eliminated_joints[joint.name] = replace(eliminated, keeps_coordinate=True)
                self.eliminated.append(Eliminated(body.name, coordinates.reason))
            self._add(component, coordinates)

    def _refuse_massless(self, links: tuple[PlannedLink, ...]) -> None:
        """Raise SpecError for bodies without mass in trees that carry none with mass, and for roots without mass."""
        heavy: set[str] = set()
        problems = []
        for link in reversed(links):
            body = self.bodies[link.body]
            missing = self.type_of(body).missing(body)
            if missing and (link.joint is None or link.body not in heavy or len(missing) == 1):
                needs = f"it needs {' and '.join(missing)}"
                if link.joint is None:
                    text = f"{body.name} has coordinates of its own, and {needs}"
                else:
                    text = (
                        f"{body.name} moves and carries no mass, so that joint {link.joint.name} is singular; {needs}"
                    )
                problems.append(Problem(f"bodies.{body.name}", text))
            if link.joint and (link.body in heavy or not missing):
                heavy.add(self._ends(body, link.joint)[1].body)
        if problems:
            raise SpecError(tuple(reversed(problems)))

    def _behind(self, body: Any, joint: SpatialJoint, component: Component) -> CoordinateMap:
        """The coordinates that a joint of a tree leaves a body."""
        own, other = self._ends(body, joint)
        known = fixed_frame(sp.zeros(3, 1), fixed_axes())  # which motions are left does not depend on it
        support = replace(self._support(body, joint, component, own, other, known), drive=None)
        coordinates, ball = self._left(joint, support)
        kept, rows = own_coordinates(body.name, support.motion, coordinates, ball)
        reason = reason_text(joint, support, coordinates, ball)
        return DerivedWhenNeeded(kept, rows, reason, lambda: self._tree_motions[body.name])

    def _left(self, joint: SpatialJoint, support: SpatialSupport) -> tuple[list[JointCoordinate], bool]:
        """The relative motions that a joint of a tree leaves, and whether it leaves all rotations."""
        joint_type = SPATIAL_JOINTS[joint.kind]
        free = joint_type.free(joint)
        assert free is not None, "trees consist of other joints"
        return joint_coordinates(joint_type, free, support)

    @cached_property
    def _tree_motions(self) -> Mapping[str, CoordinateMap]:
        """The motions of all bodies of trees that joints carry."""
        frames: dict[str, Mapping[str, FrameMotion]] = {}
        result: dict[str, CoordinateMap] = {}
        joints = {joint.name: joint for joint in self.joints}
        for link in self.links:
            instance = self.instances[link.body]
            if link.joint is not None:
                result[link.body] = self._motion_behind(joints[link.joint.name], instance, result, frames)
                instance = replace(instance, coordinates=result[link.body])
            frames[link.body] = self._motions(instance)
        return result

    def _motion_behind(
        self,
        joint: SpatialJoint,
        instance: BodyInstance,
        before: Mapping[str, CoordinateMap],
        frames: Mapping[str, Mapping[str, FrameMotion]],
    ) -> CoordinateMap:
        """The motion of a body behind a joint; before, frames: the motions of the bodies before it."""
        body = self.bodies[instance.name]
        own, other = self._ends(body, joint)
        known = (frames.get(other.body) or self.known[other.body])[other.marker]
        support = replace(self._support(body, joint, instance.component, own, other, known), drive=None)
        coordinates, ball = self._left(joint, support)
        of = before.get(other.body) or (self.instances[other.body].coordinates if other.body in frames else None)
        carried = of.carried if of else None
        return behind_moving_marker(
            body.name,
            support.motion,
            other.body if carried else "",
            support.known,
            carried.rows if carried else (),
            support.own_axes,
            coordinates,
            ball,
            instance.coordinates.reason,
        )

    def _mechanism(self, ordered: tuple[BodyInstance, ...]) -> SpatialMechanism:
        return SpatialMechanism(
            scene=self.scene,
            kinds=tuple(self.kinds.kinds),
            instances=ordered,
            order=tuple(self.instances),
            ground=self.known[GROUND],
            joints=tuple(
                SpatialJointInstance(joint, SPATIAL_JOINTS[joint.kind], self.drives.get(joint.name))
                for joint in self.joints
                if joint.name not in self.eliminated_joints
            ),
            eliminated_joints=tuple(self.eliminated_joints.values()),
            gears=self._gears(),
            forces=self._actions(),
            dampings=tuple(filter(None, (self.type_of(body).damping(body) for body in self.scene.bodies))),
            parameters=spatial_parameters(self.scene),
            constants=tuple(self.constants),
            definitions=tuple(self.definitions),
            eliminated=tuple(self.eliminated),
        )

    def _gears(self) -> tuple[GearInstance, ...]:
        """The gears with the values of their keys."""
        keys = {key.name: key for key in declared_keys(Gear)}
        result = []
        for gear in self.scene.gears:
            ratio, offset = (
                self._value("gears", gear.name, keys[name], getattr(gear, name)) for name in ("ratio", "offset")
            )
            result.append(GearInstance(gear, ratio, offset))
        return tuple(result)

    def _actions(self) -> tuple[SpatialActionInstance, ...]:
        """The forces, torques and springs, with the loads of bodies, and the values of their keys."""
        actions = [(section, of) for section in ("forces", "torques", "springs") for of in getattr(self.scene, section)]
        of_bodies: list[Any] = [load for body in self.scene.bodies for load in self.type_of(body).forces(body)]
        actions += (("torques" if isinstance(load, SpatialTorque) else "forces", load) for load in of_bodies)
        result = []
        for section, action in actions:
            given = specified(action)
            keys = (key for key in keys_of(action) if key.name in given)
            values = {key.name: self._value(section, action.name, key, given[key.name]) for key in keys}
            result.append(SpatialActionInstance(action, self.scene.markers_of(action), values))
        return tuple(result)

    def type_of(self, body: Any) -> BodyType[Any]:
        """The type of a body."""
        if body.name not in self.reduced:
            return SPATIAL_BODIES[body.kind]
        return Flexible(self.reduced[body.name], self.looped)

    def _eliminated_joint(self, body: Any, joint: Any) -> SpatialEliminatedJoint:
        own, known = self._ends(body, joint)
        return SpatialEliminatedJoint(joint, SPATIAL_JOINTS[joint.kind], self.drives.get(joint.name), own, known)

    def _minimal(
        self, body: Any, joint: Any, component: Component, own: MarkerRef, other: MarkerRef
    ) -> CoordinateMap | None:
        if joint.closes_loop or body.name in self.of_trees:
            return None
        support = self._support(body, joint, component, own, other, self.known[other.body][other.marker])
        return minimal_spatial_coordinates(SPATIAL_JOINTS[joint.kind], joint, support)

    def _support(
        self,
        body: Any,
        joint: SpatialJoint,
        component: Component,
        own: MarkerRef,
        other: MarkerRef,
        known: FrameMotion,
    ) -> SpatialSupport:
        """A body with the marker that a joint connects it to; known: the motion of this one."""
        return SpatialSupport(
            body=body.name,
            motion=component.body.motion,
            own_axes=component.sections[own.marker].axes,
            known=known,
            attached_to="the ground" if other.body == GROUND else other.body,
            sign=1 if own == joint.second else -1,
            drive=self.drives.get(joint.name),
            lead=lead(joint),
        )

    def _free(self, component: Component) -> CoordinateMap:
        return free_spatial_coordinates(component.name, component.body.motion)

    def _with_constants(self, joint: Any) -> Any:
        """A joint with its pitch as an expression, if it has one."""
        if joint.pitch is None:
            return joint
        return replace(joint, pitch=self._value("joints", joint.name, _PITCH, joint.pitch))

    def _ground(self) -> Mapping[str, FrameMotion]:
        doc = "point of the ground along e"
        frames = {}
        for m in self.scene.ground:
            position = [
                self._constant(element(GROUND, m.name, k), x, f"{doc}{k}", "m") for k, x in enumerate(m.position, 1)
            ]
            frames[m.name] = fixed_frame(sp.Matrix(position), matrix_of(m.rotation))
        return frames
