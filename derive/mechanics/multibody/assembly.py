"""The assembly of a mechanism from a scene: bodies in minimal coordinates, joints, drives and forces at markers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from heapq import heappop, heappush
from itertools import chain
from typing import TYPE_CHECKING, Any

from derive.algebra import sp
from derive.errors import Problem, SpecError
from derive.mechanics import quantity
from derive.mechanics.fixed_symbols import t
from derive.mechanics.multibody.bodies.registry import BODIES
from derive.mechanics.multibody.coordinates import CoordinateMap, free_coordinates
from derive.mechanics.multibody.forces.force_type import define
from derive.mechanics.multibody.forces.registry import FORCES, elements
from derive.mechanics.multibody.instances import point_motions
from derive.mechanics.multibody.joints.joint_elimination import minimal_coordinates
from derive.mechanics.multibody.joints.joint_type import PrescribedMotion, Support
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.kinds import (
    BodyInstance,
    BodyKinds,
    EliminatedJoint,
    ForceInstance,
    JointInstance,
)
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.multibody.outputs.output_type import OutputInstance
from derive.mechanics.multibody.outputs.registry import output_type
from derive.mechanics.multibody.parameters import parameters
from derive.mechanics.multibody.point_motion import Derivatives, fixed_point
from derive.mechanics.prescribed_motion import drive_motion
from derive.mechanics.quantity import finite_function, time_derivatives
from derive.mechanics.symbols import DOTS, element
from derive.mechanics.terms import Eliminated, Intermediate, ModelConstant
from derive.mechanics.time_functions import TimeOperation
from derive.spec.model.joints import CustomJoint, Drive
from derive.spec.model.keys import Key, KeyType
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.planar_bodies import SceneBody
from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.model.scene import NAMED, Scene
from derive.spec.model.scene_functions import function_parameters
from derive.spec.model.time_function import TimeFunction

if TYPE_CHECKING:
    from derive.mechanics.multibody.bodies.body_type import BodyType, Component
    from derive.mechanics.typed_symbol import Symbol


def mechanism(scene: Scene) -> Mechanism:
    """The mechanism of a scene, with equations once for each kind of body.

    Raises SpecError with what does not go together, UnknownNameError for a body, joint or force that no registry knows.
    """
    result: Mechanism = SceneAssembly(scene).mechanism()
    return result


def body_type(body: SceneBody) -> BodyType[Any]:
    """The type of a body."""
    return BODIES[body.kind]


class SceneAssembly:
    """The state of joint elimination: a scene whose bodies receive their coordinates in turn.

    The methods that name planar types have others in space, see `space.assembly`.
    """

    def __init__(self, scene: Any) -> None:
        self.scene = scene
        self.bodies = {body.name: body for body in scene.bodies}
        self.constants: list[ModelConstant] = []
        self.gravity, _ = quantity.gravity(scene.gravity)
        joints = [*scene.joints, *chain.from_iterable(self.type_of(b).joints(b) for b in scene.bodies)]
        self.joints = [replace(j, first=self._located(j.first), second=self._located(j.second)) for j in joints]
        self.joints = [self._with_constants(joint) for joint in self.joints]
        self.definitions: list[Intermediate] = []
        self.drives = {d.joint: PrescribedMotion(d.name, self._motion(d)) for d in scene.drives}
        self.known: dict[str, Mapping[str, Any]] = {GROUND: self._ground()}
        self.kinds = BodyKinds()
        self.instances: dict[str, BodyInstance] = {}
        self.eliminated = [Eliminated(GROUND, "it does not move and has no coordinates")]
        self.eliminated_joints: dict[str, Any] = {}

    def mechanism(self) -> Any:
        """Assign coordinates to all bodies; joints that eliminate none become constraints."""
        self._eliminate()
        components = {b.name: self._components(b) for b in self.scene.bodies}
        ordered = [self.instances[name] for names in components.values() for name in names]
        if not any(instance.moves for instance in ordered):
            raise SpecError((Problem("drives", "all motion is prescribed; nothing is left to be computed"),))
        return self._mechanism(tuple(ordered))

    def _mechanism(self, ordered: tuple[BodyInstance, ...]) -> Any:
        """The mechanism of these instances."""
        joints = tuple(
            JointInstance(joint, JOINTS[joint.kind], self.drives.get(joint.name))
            for joint in self.joints
            if joint.name not in self.eliminated_joints
        )
        forces = self._forces()
        return Mechanism(
            scene=self.scene,
            kinds=tuple(self.kinds.kinds),
            instances=ordered,
            order=tuple(self.instances),
            ground=self.known[GROUND],
            joints=joints,
            forces=forces,
            dampings=tuple(filter(None, (body_type(b).damping(b) for b in self.scene.bodies))),
            eliminated_joints=tuple(self.eliminated_joints.values()),
            outputs=self._outputs(),
            parameters=parameters(self.scene),
            constants=tuple(self.constants),
            definitions=tuple(self.definitions),
            eliminated=tuple(self.eliminated),
        )

    def type_of(self, body: Any) -> BodyType[Any]:
        """The type of a body."""
        return body_type(body)

    # ---- bodies ----

    def _eliminate(self) -> None:
        """Eliminate coordinates of bodies that joints connect to known motions, as long as there are any.

        The first body of the specification that a joint supports is next, and of its joints the first.
        """
        by_other_end = self._by_other_end()
        ready = list(by_other_end[GROUND])
        while ready:
            number, of_joint = heappop(ready)
            body, joint = self.scene.bodies[number], self.joints[of_joint]
            if body.name in self.instances or (step := self._supported(body, joint)) is None:
                continue
            component, coordinates = step
            self.eliminated_joints[joint.name] = self._eliminated_joint(body, joint)
            self.eliminated.append(Eliminated(body.name, coordinates.reason))
            if coordinates.rows:
                self._complete(body)
            self._add(component, coordinates)
            if body.name in self.known:
                for pair in by_other_end[body.name]:
                    heappush(ready, pair)

    def _eliminated_joint(self, body: Any, joint: Any) -> Any:
        """A joint that has eliminated coordinates of a body."""
        own, known = self._ends(body, joint)
        return EliminatedJoint(joint, JOINTS[joint.kind], self.drives.get(joint.name), own, known)

    def _by_other_end(self) -> dict[str, list[tuple[int, int]]]:
        """The numbers of bodies and of their joints, in order, by the body or the ground at the other end."""
        numbers = {body.name: number for number, body in enumerate(self.scene.bodies)}
        result: dict[str, list[tuple[int, int]]] = {name: [] for name in (GROUND, *numbers)}
        for of_joint, joint in enumerate(self.joints):
            ends = joint.first.body, joint.second.body
            for own, other in (ends, ends[::-1]):
                if own in numbers and other in result:
                    result[other].append((numbers[own], of_joint))
        return {name: sorted(pairs) for name, pairs in result.items()}

    def _supported(self, body: Any, joint: Any) -> tuple[Component, CoordinateMap] | None:
        """The reduction of a body by a joint to a marker whose motion is known; None if it eliminates nothing."""
        own, other = self._ends(body, joint)
        if joint.name in self.eliminated_joints:
            return None
        component = self.type_of(body).about(body, own.marker, self.gravity)
        if component is None:
            return None
        coordinates = self._minimal(body, joint, component, own, other)
        return None if coordinates is None else (component, coordinates)

    def _minimal(
        self, body: Any, joint: Any, component: Component, own: MarkerRef, other: MarkerRef
    ) -> CoordinateMap | None:
        """The coordinates of a rigid body behind the known marker `other`; None if the joint eliminates none."""
        support = Support(
            body=body.name,
            motion=component.body.motion,
            marker=self.known[other.body][other.marker],
            attached_to="the ground" if other.body == GROUND else other.body,
            sign=1 if own == joint.second else -1,
            drive=self.drives.get(joint.name),
        )
        return minimal_coordinates(JOINTS[joint.kind], joint, support)

    def _ends(self, body: Any, joint: Any) -> tuple[MarkerRef, MarkerRef]:
        """The marker of a joint on a body, and the other one."""
        is_second = joint.second.body == body.name
        return (joint.second, joint.first) if is_second else (joint.first, joint.second)

    def _complete(self, body: Any) -> None:
        """Raise SpecError if a body that moves has no mass or inertia."""
        if missing := self.type_of(body).missing(body):
            text = f"{body.name} has coordinates of its own and needs {' and '.join(missing)}"
            if getattr(body, "keep_coordinates", False):
                text += "; give them, or leave keep_coordinates out if a drive prescribes its motion"
            raise SpecError((Problem(f"bodies.{body.name}", text),))

    def _components(self, body: Any) -> list[str]:
        """The names of the components of a body; all coordinates are assigned unless a joint has eliminated some."""
        if body.name in self.instances:
            return [body.name]
        self._complete(body)
        components = self.type_of(body).components(body, self.gravity)
        for component in components:
            self._add(component, self._free(component))
        return [component.name for component in components]

    def _free(self, component: Component) -> CoordinateMap:
        """All coordinates of a component."""
        return free_coordinates(component.name, component.body.motion)

    def _add(self, component: Component, coordinates: CoordinateMap) -> None:
        complete = bool(self.scene.outputs)
        instance = BodyInstance(component, self.kinds.number(component.body), coordinates, complete)
        self.instances[component.name] = instance
        if not instance.moves:
            self.known[component.name] = self._motions(instance)

    def _motions(self, instance: BodyInstance) -> Mapping[str, Any]:
        """The motions of the markers of an instance."""
        return point_motions(instance, self.kinds.kinds[instance.kind])

    # ---- joints, drives and forces ----

    def _forces(self) -> tuple[ForceInstance, ...]:
        result = []
        of_bodies = (force for body in self.scene.bodies for force in body_type(body).forces(body))
        for force, force_type in chain(elements(self.scene), ((force, FORCES[force.kind]) for force in of_bodies)):
            section, specified = force_type.section, force_type.specified(force)
            given = (key for key in force_type.keys if key.name in specified)
            values = {key.name: self._value(section, force.name, key, specified[key.name]) for key in given}
            markers = tuple(map(self._located, force.markers))
            result.append(ForceInstance(force, force_type, markers, values))
        return tuple(result)

    def _value(self, section: str, name: str, key: Key, value: Any) -> Any:
        """The value of a key of an element as an expression of the derivation."""
        match key.type:
            case KeyType.FLOAT | KeyType.POSITIVE_FLOAT | KeyType.NUMBER | KeyType.POSITIVE | KeyType.NOT_NEGATIVE:
                return sp.Rational(value)
            case KeyType.DIRECTION:
                return sp.Matrix([sp.Rational(component) for component in value])
            case (
                KeyType.POSITIVE_QUANTITY | KeyType.NOT_NEGATIVE_QUANTITY | KeyType.QUANTITY | KeyType.NONZERO_QUANTITY
            ):
                doc = f"{key.name} of {NAMED[section]} {name}"
                return self._constant(element(name, key.name), value, doc, key.unit)
            case KeyType.FUNCTION:
                return self._function(value, f"{section}.{name}.{key.name}")
            case KeyType.BUSHING_MATRIX:
                return self._bushing_matrix(name, key.name, value)
            case KeyType.FUNCTION_PAIR | KeyType.FUNCTION_TRIPLE:
                return sp.Matrix([self._function(of, f"{section}.{name}.{key.name}") for of in value])
            case KeyType.MARKER | KeyType.BEAM_MARKER:
                return self._located(value)
            case KeyType.MARKER_PAIR:
                return tuple(map(self._located, value))
            case KeyType.JOINT | KeyType.DRIVE | KeyType.SPRING | KeyType.BEAM | KeyType.CHOICE | KeyType.TRUTH:
                return value
            case _:
                raise TypeError(f"{name}: an element of a registered kind has no key `{key.name}` of type {key.type}")

    def _bushing_matrix(self, name: str, key: str, value: tuple[Any, ...]) -> sp.Matrix:
        """The symmetric matrix of a bushing, diagonal if it has six numbers; parameters become constants."""
        result = sp.zeros(len(value), len(value))
        for i, row in enumerate(value):
            entries = [(i, row)] if not isinstance(row, tuple) else list(enumerate(row))[i:]
            for j, of in entries:
                components = (i + 1,) if not isinstance(row, tuple) else (i + 1, j + 1)
                symbol = element(name, key, *components)
                result[i, j] = result[j, i] = self._constant(symbol, of, f"{key} of spring {name}", "")
        return result

    def _outputs(self) -> tuple[OutputInstance, ...]:
        result = []
        for output in self.scene.outputs:
            its_type = output_type(output.kind)
            given = (key for key in its_type.keys if key.name in output.values)
            values = {key.name: self._value("outputs", output.name, key, output.values[key.name]) for key in given}
            result.append(OutputInstance(output.name, its_type, values))
        return tuple(result)

    def _with_constants(self, joint: Any) -> Any:
        """A joint of a custom kind with the values of its keys as expressions; parameters become constants."""
        if not isinstance(joint, CustomJoint):
            return joint
        given = (key for key in JOINTS[joint.kind].keys if key.name in joint.values)
        values = {key.name: self._value("joints", joint.name, key, joint.values[key.name]) for key in given}
        return replace(joint, values=values)

    def _located(self, marker: MarkerRef) -> MarkerRef:
        """The marker of a component for a marker of a body; markers of components or the ground are unchanged."""
        body = self.bodies.get(marker.body)
        if body is None or marker.marker not in {m.name for m in body.markers}:
            return marker
        return self.type_of(body).located(body, marker.marker)

    def _ground(self) -> Mapping[str, Any]:
        doc = "point of the ground along e"
        positions = {
            p.name: [
                self._constant(element(GROUND, p.name, k), x, f"{doc}{k}", "m") for k, x in enumerate((p.x, p.y), 1)
            ]
            for p in self.scene.ground
        }
        return {name: fixed_point(sp.Matrix(position)) for name, position in positions.items()}

    def _motion(self, drive: Drive) -> Derivatives:
        """The motion of a drive with two derivatives, as named definitions if they contain a TimeOperation."""
        match drive.speed:
            case None:
                derivatives = time_derivatives(self._function(drive_motion(drive), f"drives.{drive.name}.motion"))
            case TimeFunction():
                path = f"drives.{drive.name}.speed"
                speed, acceleration, _ = time_derivatives(self._function(drive.speed, path))
                derivatives = self._function(drive_motion(drive), path), speed, acceleration
            case constant:
                value = self._constant(element(drive.name, "speed"), constant, f"speed of drive {drive.name}", "")
                return time_derivatives(value * t + sp.Rational(drive.offset))
        return self._named(drive.name, derivatives) if any(of.has(TimeOperation) for of in derivatives) else derivatives

    def _named(self, drive: str, derivatives: Derivatives) -> Derivatives:
        docs = ("motion", "speed", "acceleration")
        symbols = (element(drive, f"motion{dots}") for dots in DOTS)
        named = [
            define(symbol, value, f"{doc} that drive {drive} prescribes", self.definitions)
            for symbol, value, doc in zip(symbols, derivatives, docs, strict=True)
        ]
        return named[0], named[1], named[2]

    def _function(self, of: TimeFunction, path: str) -> sp.Expr:
        """A function of t; its parameters become constants."""
        for parameter in function_parameters(of):
            doc = f"parameter {parameter.symbol} of functions of time"
            self._constant(quantity.function_constant(parameter), parameter, doc, "")
        return finite_function(of, path)

    def _constant(self, symbol: Symbol, value: Quantity, doc: str, unit: str) -> sp.Expr:
        """Return a number as it is, and a parameter as the symbol of a constant of the model."""
        if not isinstance(value, Parameter):
            return sp.Rational(value)
        self.constants.append(ModelConstant(symbol, quantity.value(value, False), "", doc, unit or value.unit))
        return symbol
