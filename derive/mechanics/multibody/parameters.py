"""The run-time parameters of a scene: every symbol that a body, a joint, a drive, a force or an output names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
from typing import TYPE_CHECKING, Any

from derive.mechanics import quantity
from derive.mechanics.multibody.bodies.body_type import Constant
from derive.mechanics.multibody.bodies.registry import BODIES
from derive.mechanics.multibody.forces.registry import elements
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.outputs.registry import output_type
from derive.mechanics.multibody.space.bodies import SPATIAL_BODIES
from derive.mechanics.multibody.space.outputs import spatial_output_type
from derive.mechanics.multibody.space.rigid import frame_constants
from derive.mechanics.multibody.space.springs import spring_type
from derive.spec.model.joints import CustomJoint
from derive.spec.model.keys import Key, KeyType, quantities
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene import NAMED, Scene
from derive.spec.model.scene_functions import function_parameters, time_functions
from derive.spec.model.spatial_forces import SpatialSpring
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

if TYPE_CHECKING:
    from derive.mechanics.terms import ParameterSymbol


def parameters(scene: Scene) -> tuple[ParameterSymbol, ...]:
    """The run-time parameters of a scene, each symbol once, in the order of the specification."""
    constants = [
        *_of_gravity(scene),
        *chain.from_iterable(BODIES[body.kind].constants(body) for body in scene.bodies),
    ]
    for point in scene.ground:
        constants.append(Constant(point.x, f"point {point.name} of the ground along e1"))
        constants.append(Constant(point.y, f"point {point.name} of the ground along e2"))
    for joint in scene.joints:
        if isinstance(joint, CustomJoint):
            constants += _constants("joint", joint.name, JOINTS[joint.kind].keys, joint.values)
    constants += [Constant(drive.constant_speed, f"speed of drive {drive.name}") for drive in scene.drives]
    for output in scene.outputs:
        constants += _constants("output", output.name, output_type(output.kind).keys, output.values)
    for force, force_type in elements(scene):
        specified = force_type.specified(force)
        constants += _constants(NAMED[force_type.section], force.name, force_type.keys, specified)
    constants += _of_functions(scene)
    return _symbols(constants)


def spatial_parameters(scene: SpatialScene) -> tuple[ParameterSymbol, ...]:
    """The run-time parameters of a scene in space, each symbol once, in the order of the specification."""
    constants = [
        *_of_gravity(scene),
        *chain.from_iterable(
            SPATIAL_BODIES[body.kind].constants(body) for body in scene.bodies if body.kind in SPATIAL_BODIES
        ),
        *frame_constants("the ground", scene.ground),
        *chain.from_iterable(
            _constants("spring", spring.name, spring_type(spring.kind).keys, spring.values) for spring in scene.springs
        ),
        *chain.from_iterable(_of_bushing(spring) for spring in scene.springs),
        *(Constant(j.pitch, f"pitch of joint {j.name}") for j in scene.joints if j.pitch is not None),
        *(Constant(drive.constant_speed, f"speed of drive {drive.name}") for drive in scene.drives),
        *(
            Constant(getattr(gear, key), f"{key} of gear {gear.name}")
            for gear in scene.gears
            for key in ("ratio", "offset")
        ),
        *chain.from_iterable(
            _constants("output", output.name, spatial_output_type(output.kind).keys, output.values)
            for output in scene.outputs
        ),
        *_of_functions(scene),
    ]
    return _symbols(constants)


def _of_bushing(spring: SpatialSpring) -> Iterator[Constant]:
    """The entries of the matrices of a bushing."""
    for key in spring_type(spring.kind).keys:
        if key.type is KeyType.BUSHING_MATRIX and key.name in spring.values:
            for row in spring.values[key.name]:  # type: ignore[attr-defined]  # of any key
                for entry in row if isinstance(row, tuple) else (row,):
                    yield Constant(entry, f"{key.name} of spring {spring.name}")


def _of_gravity(scene: AnyScene) -> Iterator[Constant]:
    for axis, component in enumerate(scene.gravity or (), 1):
        yield Constant(component, f"acceleration of free fall along the inertial e{axis}")


def _of_functions(scene: AnyScene) -> Iterator[Constant]:
    for (section, name, key), function in time_functions(scene):
        doc = f"{key} of {NAMED[section]} {name}"
        yield from (Constant(parameter, doc) for parameter in dict.fromkeys(function_parameters(function)))


def _symbols(constants: Iterable[Constant]) -> tuple[ParameterSymbol, ...]:
    """The parameters among constants, each symbol once."""
    result: dict[str, ParameterSymbol] = {}
    for constant in constants:
        if isinstance(constant.value, Parameter):
            known = result.get(constant.value.symbol)
            doc = f"{known.doc}; {constant.doc}" if known else constant.doc
            positive = constant.positive or bool(known and known.positive)
            result[constant.value.symbol] = quantity.parameter(constant.value, doc, positive)
    return tuple(result.values())


def _constants(noun: str, name: str, keys: tuple[Key, ...], values: Mapping[str, Any]) -> Iterator[Constant]:
    """The values of the keys of an element that may be run-time parameters."""
    for key in quantities(keys).values():
        if key.name in values:
            positive = key.type is KeyType.POSITIVE_QUANTITY
            yield Constant(values[key.name], f"{key.name} of {noun} {name}", positive)
