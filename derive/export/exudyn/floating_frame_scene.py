"""`--to exudyn-ffrf` of a scene in space: its bodies, joints, forces and springs as items of Exudyn, as data.

Finite-element bodies are those of `floating_frame.py`, whose nodes are all nodes of their markers.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from derive.enumerations import enumeration
from derive.errors import Problem, SpecError
from derive.export.exudyn.floating_frame_arguments import floating_frame_arguments
from derive.export.host_model import HostModel
from derive.mechanics.bodies.modal_body import ModalPoint
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.mechanics.multibody.space.rows import DISPLACEMENTS, ROTATIONS
from derive.mechanics.symbols import amplitude, owned
from derive.reduction.body import reduce
from derive.reduction.frame_points import modal_frames
from derive.runtime.interpreted_scene import InterpretedScene
from derive.simulation.configurations import quaternion_of, rotation_matrix
from derive.simulation.observables.motion import si_value
from derive.simulation.space.poses import SpatialPoses
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.spatial_beam import SpatialBeam, SpatialBody
from derive.spec.model.spatial_beam_parts import SectionFrame
from derive.spec.model.spatial_bodies import FlexibleBody, FrameMarker, NodeFrame, SpatialRigidBody
from derive.spec.model.spatial_forces import SpatialForce, SpatialTorque
from derive.spec.model.spatial_scene import SpatialJoint, SpatialScene
from derive.spec.model.time_function import TimeFunction, value_at

Plain = dict[str, Any]

CROSS = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""Axes in another order: that which is constrained of a universal joint, x . y = 0 in Exudyn, is z . x = 0 here."""
ROTATION_MASKS = ((), ("rx", "ry"), ("rx", "ry", "rz"))
"""The rotations that an ObjectJointGeneric removes as a joint of ours does: none, all but that about z, and all."""
OF_POINTS = ("spherical", "distance")
"""The joints that take markers without a rotation."""
ELSEWHERE = "export the scene with --to exudyn, or leave this out"


def scene_values(host: HostModel, scene: SpatialScene) -> Plain:
    """The items of Exudyn for a scene. Raises SpecError with all elements that Exudyn's own items do not have."""
    problems = list(_problems(scene))
    if problems:
        raise SpecError(tuple(problems))
    native = InterpretedScene(host.model)
    k = native.setup()
    q, v = (np.array([x.start for x in of], dtype=float) for of in (host.coordinates, host.velocities))
    poses = SpatialPoses(native, k, 0.0, q, 1.0)
    bodies: Plain = {}
    for body in scene.bodies:
        twist, drift = poses.twist(body.name)
        motion = twist @ v + drift
        values = {
            "position": _plain(poses.position(body.name)),
            "quaternion": _plain(quaternion_of(poses.rotation(body.name))),
            "velocity": _plain(motion[:3]),
            "angular_velocity": _plain(motion[3:]),
        }
        bodies[body.name] = values | (_rigid(body) if isinstance(body, SpatialRigidBody) else _flexible(body, host))
    return {
        "gravity": [si_value(x) for x in scene.gravity] if scene.gravity else [0.0, 0.0, 0.0],
        "bodies": bodies,
        "markers": {str(at): _marker(scene, at) for at in _markers(scene)},
        "joints": {joint.name: _joint(scene, joint) for joint in scene.joints},
        "springs": {
            s.name: [str(s.first), str(s.second), *(_number(s.values[key]) for key in ("stiffness", "damping", "rest"))]
            for s in scene.springs
        },
        "loads": {of.name: _load(of) for of in (*scene.forces, *scene.torques)},
    }


# ---- what there is no item for


def _problems(scene: SpatialScene) -> Iterator[Problem]:
    for body in scene.bodies:
        yield from _of_body(body)
    for joint in scene.joints:
        if _mask(joint) is None and joint.kind not in OF_POINTS:
            kinds = [kind for kind, of in SPATIAL_JOINTS.items() if of.removes and not of.is_screw]
            text = f"Exudyn has no joint that removes what this {joint.kind} joint removes; joints that it has are "
            yield Problem(f"joints.{joint.name}.kind", text + enumeration([*kinds, "distance"]))
    for section in ("drives", "gears"):
        for of in getattr(scene, section):
            text = f"{section} are written as no item of Exudyn; {ELSEWHERE}"
            yield Problem(f"{section}.{of.name}", text)
    for spring in scene.springs:
        if spring.kind != "linear":
            text = f"a {spring.kind} spring is written as no item of Exudyn; write a linear one, or {ELSEWHERE}"
            yield Problem(f"springs.{spring.name}.kind", text)
    for section in ("forces", "torques"):
        for load in getattr(scene, section):
            yield from _of_load(section, load)


def _is_cross(joint: SpatialJoint) -> bool:
    return SPATIAL_JOINTS[joint.kind].removed(joint) == (*DISPLACEMENTS, "ry")


def _mask(joint: SpatialJoint) -> list[int] | None:
    """The axes of an ObjectJointGeneric that a joint removes; None if there is no such item."""
    if SPATIAL_JOINTS[joint.kind].is_screw or joint.kind == "distance":
        return None
    if _is_cross(joint):
        return [1, 1, 1, 0, 0, 1]
    removed = SPATIAL_JOINTS[joint.kind].removed(joint)
    if tuple(name for name in removed if name in ROTATIONS) not in ROTATION_MASKS:
        return None
    return [int(name in removed) for name in (*DISPLACEMENTS, *ROTATIONS)]


def _of_body(body: SpatialBody) -> Iterator[Problem]:
    key = f"bodies.{body.name}"
    if isinstance(body, SpatialRigidBody):
        if body.mass is None or body.inertia is None:
            yield Problem(key, "a body of Exudyn needs mass and inertia, also where a drive prescribes its motion")
        return
    if isinstance(body, SpatialBeam):
        yield Problem(key, f"beams in space are written as no item of Exudyn; {ELSEWHERE}")
        return
    if body.body.second_order:
        yield Problem(f"{key}.order", "a floating-frame body of Exudyn has displacements of first order: order = 1")
    if not body.markers:
        yield Problem(key, "a floating-frame body of Exudyn has modes and nodes: give the body a marker at least")
    for load in body.loads:
        yield Problem(f"{key}.loads.{load.name}", f"loads on nodes are written as no item of Exudyn; {ELSEWHERE}")


def _of_load(section: str, load: Any) -> Iterator[Problem]:
    key, components = f"{section}.{load.name}", None
    if isinstance(load, SpatialForce):
        components = load.force
    if isinstance(load, SpatialTorque) and load.against is None:
        components = load.torque
    if components is None or load.frame != "inertial" or not all(_constant(f) for f in components):
        text = "a load of Exudyn is written of three numbers along the axes of the inertial frame, on one body"
        yield Problem(key, f"{text}; {ELSEWHERE}")


def _constant(function: TimeFunction) -> bool:
    try:
        return value_at(function, 0.0) == value_at(function, 1.0) and function.kind in ("number", "neg", "parameter")
    except (ArithmeticError, ValueError):
        return False


# ---- items


def _rigid(body: SpatialRigidBody) -> Plain:
    """Mass, centre of mass, and the six numbers of Exudyn of the inertia tensor about the origin of the frame."""
    assert body.mass is not None and body.inertia is not None
    mass, c = si_value(body.mass), np.array([si_value(x) for x in body.centre])
    xx, yy, zz, xy, xz, yz = (si_value(x) for x in body.inertia)
    J = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) + mass * (c @ c * np.eye(3) - np.outer(c, c))
    six = [J[0, 0], J[1, 1], J[2, 2], J[1, 2], J[0, 2], J[0, 1]]
    return {"rigid": {"mass": mass, "inertia": _plain(np.array(six)), "centerOfMass": _plain(c)}}


def _flexible(body: FlexibleBody | SpatialBeam, host: HostModel) -> Plain:
    """The arguments of a floating-frame body whose nodes are those of its markers, and its amplitudes."""
    assert isinstance(body, FlexibleBody), "beams are refused"
    modal, points = reduce(body.body), tuple(point for own in _points(body).values() for point in own)
    start = {x.name: x.start for x in (*host.coordinates, *host.velocities)}
    names = [str(owned(amplitude(i), body.name)) for i in range(1, modal.modes + 1)]
    arguments = floating_frame_arguments(replace(modal, points=points))
    return {
        "flexible": {name: _plain(array) for name, array in arguments.items()},
        "amplitudes": [start[name] for name in names],
        "amplitude_rates": [start[f"{name}dot"] for name in names],
    }


def _points(body: FlexibleBody) -> dict[str, list[ModalPoint]]:
    """The points that stand for each marker: itself, or six around a set of nodes, which move with its frame."""
    arm = float(np.abs(body.body.data.positions).max()) / 10
    around = [sign * arm * axis for axis in np.eye(3) for sign in (1, -1)]
    result = {}
    for marker, frame in zip(body.markers, modal_frames(body), strict=True):
        at = frame.point
        result[marker.name] = [at]
        if marker.has_rotation:
            moved = ((at.position + r, at.shapes + np.cross(frame.twists, r)) for r in around)
            result[marker.name] = [ModalPoint(at.name, "", position, shapes) for position, shapes in moved]
    return result


def _markers(scene: SpatialScene) -> list[MarkerRef]:
    """The markers that items need."""
    joints = [m for joint in scene.joints for m in (joint.first, joint.second)]
    springs = [m for spring in scene.springs for m in (spring.first, spring.second)]
    return list(dict.fromkeys([*joints, *springs, *(_at(load) for load in (*scene.forces, *scene.torques))]))


def _found(scene: SpatialScene, at: MarkerRef) -> tuple[SpatialBody | None, FrameMarker | NodeFrame | SectionFrame]:
    if at.body == GROUND:
        return None, next(m for m in scene.ground if m.name == at.marker)
    body = next(b for b in scene.bodies if b.name == at.body)
    return body, next(m for m in body.markers if m.name == at.marker)


def _marker(scene: SpatialScene, at: MarkerRef) -> Plain:
    """A point of a rigid body or of the ground, or points of a flexible body, which turn if they are several."""
    body, marker = _found(scene, at)
    if isinstance(marker, NodeFrame):
        assert isinstance(body, FlexibleBody)
        points = _points(body)
        first = sum(len(points[m.name]) for m in body.markers[: body.markers.index(marker)])
        count = len(points[marker.name])
        return {"body": at.body, "nodes": [*range(first, first + count)], "weights": [1 / count] * count}
    assert isinstance(marker, FrameMarker)
    return {"body": at.body, "point": [si_value(x) for x in marker.position]}


def _joint(scene: SpatialScene, joint: SpatialJoint) -> Plain:
    result: Plain = {"kind": joint.kind, "markers": [str(joint.first), str(joint.second)]}
    if joint.distance is not None:
        return result | {"distance": float(joint.distance)}
    if joint.kind in OF_POINTS:
        return result
    order = CROSS if _is_cross(joint) else np.eye(3)
    axes = [_plain(_axes(_found(scene, at)[1]) @ order) for at in (joint.first, joint.second)]
    return result | {"axes": _mask(joint), "rotations": axes}


def _axes(marker: FrameMarker | NodeFrame | SectionFrame) -> Any:
    quaternion = np.array(marker.rotation, dtype=float)
    return rotation_matrix(quaternion / np.linalg.norm(quaternion))


def _at(load: Any) -> MarkerRef:
    at: MarkerRef = load.at if isinstance(load, SpatialForce) else load.on
    return at


def _load(load: Any) -> Plain:
    components = load.force if isinstance(load, SpatialForce) else load.torque
    return {"marker": str(_at(load)), "kind": load.kind, "vector": [value_at(f, 0.0) for f in components]}


def _number(value: Any) -> float:
    return float(si_value(value))


def _plain(array: Any) -> Any:
    """Nested lists of numbers, or a number."""
    return (np.asarray(array, dtype=float) + 0.0).tolist()
