"""`--to urdf`: a tree of rigid bodies as a robot description."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction

import numpy as np

from derive.artifacts import MARK, File
from derive.export.host_model import HostModel
from derive.export.interface import Interface
from derive.export.urdf.rigid_tree import KINDS, Branch, placement_in_link, rigid_tree
from derive.short_text import counted
from derive.simulation.configurations import rotation_matrix
from derive.simulation.observables.motion import si_value
from derive.simulation.space.marker_frames import own_frame
from derive.spec.model.instances import identifier
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.model.spatial_bodies import FrameMarker, SpatialRigidBody
from derive.spec.model.spatial_forces import SpatialSpring
from derive.spec.model.spatial_scene import Gear, SpatialJoint, SpatialScene
from derive.spec.model.spatial_start import NO_ROTATION
from derive.spec.model.specification import Specification
from derive.spec.model.visuals import Mesh, Visual
from derive.spec.parsing.names import free_name
from derive.urdf.robot import HERE, JointKind, Matrix, Placement, Vector
from derive.urdf.texts import number_text

UNLIMITED = 1e9
"""The limits of a joint that has none, where a URDF needs them, in SI units."""
WORLD = "world"
"""The link of the ground, if no body has this name."""


def urdf_files(host: HostModel) -> tuple[File, ...]:
    """The description of a scene. Raises SpecError where it is no tree of rigid bodies."""
    return (File(f"{host.name}.urdf", urdf_text(host.spec)),)


def urdf_text(scene: Specification) -> str:
    """The URDF of a scene: its ground is the link `world`; links lie at their joints, about whose z axes they move.

    Markers at which no joint acts are links without mass. Raises SpecError where the scene is no tree of rigid bodies.
    """
    branches = rigid_tree(scene)
    assert isinstance(scene, SpatialScene)
    by_name = {branch.body.name: branch for branch in branches}
    of_joints = {end for joint in scene.joints for end in (joint.first, joint.second)}
    robot = ET.Element("robot", name=scene.name)
    ground = free_name(WORLD, {identifier(body.name).lower() for body in scene.bodies})
    world = ET.SubElement(robot, "link", name=ground)
    for visual in scene.ground_visuals:
        _visual(world, HERE, visual)
    for marker in scene.ground:
        if MarkerRef(GROUND, marker.name) not in of_joints:
            _frame_link(robot, ground, identifier(GROUND, marker.name), _placement(marker))
    for branch in branches:
        _link(robot, branch)
        _joint(robot, scene, branch, by_name, ground)
        for marker in branch.body.markers:
            if MarkerRef(branch.body.name, marker.name) not in of_joints:
                name = identifier(branch.body.name, marker.name)
                _frame_link(robot, identifier(branch.body.name), name, placement_in_link(branch, _placement(marker)))
    ET.indent(robot)
    return f"<!-- {MARK} from {scene.name}. -->\n{ET.tostring(robot, encoding='unicode')}\n"


def _link(robot: ET.Element, branch: Branch) -> None:
    body = branch.body
    link = ET.SubElement(robot, "link", name=identifier(body.name))
    if body.mass is not None and body.inertia is not None:
        _inertial(link, branch, body.mass, body.inertia)
    for visual in body.visuals:
        _visual(link, placement_in_link(branch, HERE), visual)


def _inertial(link: ET.Element, branch: Branch, mass: Quantity, inertia: Sequence[Quantity]) -> None:
    """Mass, centre and tensor of a body in the frame of its link."""
    body, inertial = branch.body, ET.SubElement(link, "inertial")
    centre = placement_in_link(branch, Placement(np.array([si_value(x) for x in body.centre]), np.eye(3)))
    ET.SubElement(inertial, "origin", xyz=_numbers(centre.position), rpy="0 0 0")
    ET.SubElement(inertial, "mass", value=number_text(si_value(mass)))
    xx, yy, zz, xy, xz, yz = (si_value(entry) for entry in inertia)
    tensor = centre.rotation @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ centre.rotation.T
    entries = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    ET.SubElement(inertial, "inertia", {name: number_text(tensor[at]) for name, at in entries.items()})


def _visual(link: ET.Element, body: Placement, visual: Visual) -> None:
    """A shape for pictures on a body with a frame in its link; meshes have the names of the specification."""
    own = Placement(np.array(visual.at), rotation_matrix(np.array(visual.rotation)))
    at, shape = body.of(own), ET.SubElement(link, "visual")
    ET.SubElement(shape, "origin", xyz=_numbers(at.position), rpy=_numbers(roll_pitch_yaw(at.rotation)))
    geometry = ET.SubElement(shape, "geometry")
    if isinstance(visual.mesh, Mesh):
        ET.SubElement(geometry, "mesh", filename=visual.mesh.file, scale=_numbers(visual.scale))
    elif visual.box is not None:
        ET.SubElement(geometry, "box", size=_numbers(visual.box))
    elif visual.cylinder is not None:
        radius, length = map(number_text, visual.cylinder)
        ET.SubElement(geometry, "cylinder", radius=radius, length=length)
    elif visual.sphere is not None:
        ET.SubElement(geometry, "sphere", radius=number_text(visual.sphere))


def _joint(robot: ET.Element, scene: SpatialScene, branch: Branch, by_name: Mapping[str, Branch], ground: str) -> None:
    own = branch.joint
    kind = KINDS[own.kind] if own else JointKind.FLOATING
    name = identifier(own.name) if own else f"{identifier(branch.body.name)}_free"
    joint = ET.SubElement(robot, "joint", name=name, type=kind.value)
    at = _start(branch.body)
    if branch.on:
        markers = scene.ground if branch.carrier == GROUND else by_name[branch.carrier].body.markers
        at = _placement(next(m for m in markers if m.name == branch.on.marker))
        at = at if branch.carrier == GROUND else placement_in_link(by_name[branch.carrier], at)
    ET.SubElement(joint, "origin", xyz=_numbers(at.position), rpy=_numbers(roll_pitch_yaw(at.rotation)))
    ET.SubElement(joint, "parent", link=ground if branch.carrier == GROUND else identifier(branch.carrier))
    ET.SubElement(joint, "child", link=identifier(branch.body.name))
    if own is None or kind is JointKind.FIXED:
        return
    ET.SubElement(joint, "axis", xyz=f"0 0 {branch.sign}")
    if own.limits or kind is JointKind.PRISMATIC:  # which needs limits, where nothing limits it
        kind = JointKind.REVOLUTE if kind is JointKind.CONTINUOUS else kind
        joint.set("type", kind.value)
        lower, upper = map(number_text, own.limits or (-UNLIMITED, UNLIMITED))
        ET.SubElement(joint, "limit", lower=lower, upper=upper, effort=f"{UNLIMITED:g}", velocity=f"{UNLIMITED:g}")
    if damping := sum(map(_damping, _dampers(scene, own))):
        ET.SubElement(joint, "dynamics", damping=number_text(damping))
    if gear := _first_of(scene, own.name):
        leader, (ratio, offset) = identifier(gear.joints[0]), map(si_value, (gear.ratio, gear.offset))
        ET.SubElement(joint, "mimic", joint=leader, multiplier=number_text(ratio), offset=number_text(offset))


def _first_of(scene: SpatialScene, joint: str) -> Gear | None:
    """The gear by which a joint follows another one: the first of several."""
    return next((gear for gear in scene.gears if gear.joints[1] == joint), None)


def _frame_link(robot: ET.Element, parent: str, name: str, at: Placement) -> None:
    """A marker as a link without mass."""
    ET.SubElement(robot, "link", name=name)
    joint = ET.SubElement(robot, "joint", name=f"{name}_fixed", type="fixed")
    ET.SubElement(joint, "origin", xyz=_numbers(at.position), rpy=_numbers(roll_pitch_yaw(at.rotation)))
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=name)


def _start(body: SpatialRigidBody) -> Placement:
    """Where a free body begins its motion."""
    position, rotation = body.start.position or (0.0, 0.0, 0.0), body.start.rotation or NO_ROTATION
    return Placement(np.array(position), rotation_matrix(np.array(rotation)))


def _placement(marker: FrameMarker) -> Placement:
    frame = own_frame(marker)
    return Placement(frame.position, frame.axes)


def roll_pitch_yaw(rotation: Matrix) -> tuple[float, float, float]:
    """The rotations about the fixed axes x, y and z in turn that make a rotation matrix."""
    pitch = math.atan2(-rotation[2, 0], math.hypot(rotation[0, 0], rotation[1, 0]))
    roll = math.atan2(rotation[2, 1], rotation[2, 2])
    y = rotation[:, 1] * math.cos(roll) - rotation[:, 2] * math.sin(roll)  # the y axis without the roll
    return roll, pitch, math.atan2(-y[0], y[1])  # exact also where roll and yaw turn about one line


def _dampers(scene: SpatialScene, joint: SpatialJoint) -> Iterator[SpatialSpring]:
    """The dampers without stiffness between the markers of a joint that its bodies turn about."""
    if KINDS.get(joint.kind) is JointKind.CONTINUOUS:
        ends = {joint.first, joint.second}
        of_joint = (spring for spring in scene.springs if {spring.first, spring.second} == ends)
        yield from (spring for spring in of_joint if spring.kind == "rotational" and spring.values["stiffness"] == 0)


def _damping(spring: SpatialSpring) -> float:
    damping = spring.values.get("damping", 0)
    assert isinstance(damping, (Parameter, Fraction, int))
    return float(damping.default if isinstance(damping, Parameter) else damping)


def _numbers(values: Iterable[float] | Vector) -> str:
    return " ".join(number_text(float(x)) for x in values)


def _notes(host: HostModel) -> tuple[str, ...]:
    """Lines on all that the description leaves out."""
    scene = host.spec
    if not isinstance(scene, SpatialScene):
        return ()
    dampers = {spring.name for joint in scene.joints for spring in _dampers(scene, joint)}
    lost = {
        "force": len(scene.forces),
        "torque": len(scene.torques),
        "spring": len(scene.springs) - len(dampers),
        "gear": sum(_first_of(scene, gear.joints[1]) is not gear for gear in scene.gears),
        "input": len(scene.inputs),
        "output": len(scene.outputs),
    }
    left = [counted(number, what) for what, number in lost.items() if number]
    texts = ["initial values and gravity, which a URDF does not have", *([", ".join(left)] if left else [])]
    rigid = (body.visuals for body in scene.bodies if isinstance(body, SpatialRigidBody))
    if any(isinstance(visual.mesh, Mesh) for visuals in (*rigid, scene.ground_visuals) for visual in visuals):
        texts.append("the files of meshes, whose paths are those of the specification")
    if host.parameters:
        names = ", ".join(f"{p.name} = {p.start:g}" for p in host.parameters if p.start is not None)
        return (f"left out: {'; '.join(texts)}", f"parameters have their defaults: {names}")
    return (f"left out: {'; '.join(texts)}",)


URDF = Interface(
    "robot description of a tree of rigid bodies",
    urdf_files,
    "read {folder}/{name}.urdf with Pinocchio, MuJoCo, ROS or another program for robots",
    notes=_notes,
)
