"""Faults between the tables of a scene in space: unknown names, and joints and drives that are impossible."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from derive.errors import quoted
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS, Freedom, SpatialJointType
from derive.mechanics.multibody.space.marker_outputs import ANGLE, DEFLECTION, FRAME, OF_CHORD
from derive.mechanics.multibody.space.outputs import JOINT, SPATIAL_OUTPUTS
from derive.mechanics.multibody.space.rows import DISPLACEMENTS, ROTATIONS
from derive.spec.checks.body_checks import spatial_shape_faults
from derive.spec.checks.cross_references import (
    ground_faults,
    input_faults,
    marker_faults,
    plot_faults,
    section_faults,
)
from derive.spec.checks.initial_values import spatial_start_faults
from derive.spec.checks.name_clashes import name_faults
from derive.spec.checks.scene_data import Raw, SceneData, WrittenRef
from derive.spec.checks.scene_parameters import parameter_faults
from derive.spec.model.keys import KeyType, declared_keys
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.scene import NAMED, JointInitialValues
from derive.spec.model.spatial_scene import SpatialJointInitialValues
from derive.spec.parsing.faults import Fault, KeyPath, did_you_mean, names_text


def spatial_scene_faults(data: Raw) -> list[Fault]:
    """All faults of a scene in space that concern more than a single key."""
    bodies = data.get("bodies", {})
    if isinstance(bodies, Mapping) and not bodies:
        return [Fault(("bodies",), "a scene needs bodies; write one, such as [bodies.rod]")]
    view = SceneData(data)
    faults = [*ground_faults(view), *name_faults(view), *parameter_faults(view)]
    if view.complete:
        faults += [
            *marker_faults(view),
            *_shapes(view),
            *_joints(view),
            *_drives(view),
            *_gears(view),
            *_outputs(view),
            *_of_elements(view),
            *_joint_loads(view),
            *_actions(view),
            *_lines(view),
            *plot_faults(view),
            *_starts(view),
            *_weightless(view),
        ]
        faults += input_faults(view)
    return faults


def _type(joint: Raw) -> SpatialJointType | None:
    """The type of a joint, or None if its kind is unknown."""
    return SPATIAL_JOINTS.get(str(joint.get("kind")))


def _shapes(view: SceneData) -> Iterator[Fault]:
    """Faults of the shapes of beams."""
    for name, body in view.bodies.items():
        if "ansatz" in body or "length" in body:
            faults = spatial_shape_faults(("bodies", name), body)
            yield from faults or spatial_start_faults(view, name, body)


def _joints(view: SceneData) -> Iterator[Fault]:
    for name, joint in view.tables["joints"].items():
        markers = view.pair("joints", name)
        path: KeyPath = ("joints", name, "between")
        if markers is not None:
            first, second = (marker.body for marker in markers)
            if first == second == GROUND:
                yield Fault(path, "both markers are on the ground, which does not move; one of them must be on a body")
            elif first == second and first in view.names_of_bodies:
                text = f"both markers are on the body {first}; a joint is between two bodies, or ground and body"
                yield Fault(path, text)
        joint_type = _type(joint)
        if joint_type and markers is not None:
            yield from _without_rotation(view, path, joint_type, joint, markers)
        if joint_type and joint_type.keeps_distance and "distance" not in joint:
            text = "a joint that keeps a distance needs the key `distance`, such as distance = 0.3"
            yield Fault(("joints", name), text)


def _without_rotation(
    view: SceneData, path: KeyPath, joint_type: SpatialJointType, joint: Raw, markers: tuple[MarkerRef, MarkerRef]
) -> Iterator[Fault]:
    """Faults of joints whose rotations or axes are those of a marker at a single node, which has none."""
    removed = {*_removed(joint_type, joint)}
    for i, marker in enumerate(markers):
        turns = removed & ROTATIONS.keys() or (
            i == 0 and removed & DISPLACEMENTS.keys() not in (set(), set(DISPLACEMENTS))
        )
        if turns and _is_node(view, marker):
            yield Fault((*path, i), _no_rotation(marker, f"a {joint.get('kind')} joint acts", "spherical joint"))


def _is_node(view: SceneData, marker: MarkerRef) -> bool:
    """Whether a marker is a single node of a finite-element body, which has no rotation."""
    body = view.bodies.get(marker.body)
    at = body.get("markers") if isinstance(body, Mapping) else None
    value = at.get(marker.marker) if isinstance(at, Mapping) else None
    single = isinstance(value, int) or (isinstance(value, Mapping) and "node" in value)
    return view.kind(marker.body) == "flexible" and single


def _no_rotation(marker: MarkerRef, acts: str, other: str) -> str:
    return (
        f"the marker {marker} is a node, which has no rotation, and {acts} on the rotation of its markers; take a set "
        f"of nodes around it, {{ nodes = [..] }}, or a {other}"
    )


def _actions(view: SceneData) -> Iterator[Fault]:
    """Faults of loads and springs that have no effect, and of those on the rotation of a node, which is not known."""
    for name in view.tables["springs"]:
        markers = view.pair("springs", name)
        if markers and markers[0] == markers[1]:
            yield Fault(("springs", name, "between"), "a spring is between two markers, and these are the same")
    for ref in view.marker_refs():
        section, name = ref.path[0], str(ref.path[1])
        alone = section == "forces" or (section == "torques" and "against" not in view.tables["torques"][name])
        if alone and ref.marker.body == GROUND:
            text = f"a {NAMED[str(section)]} on the ground moves nothing; name a marker of a body"
            yield Fault(ref.path, text)
        if section == "outputs":
            yield from _marker_output(view, ref, view.tables["outputs"][name])
        if section == "torques" and _is_node(view, ref.marker):
            yield Fault(ref.path, _no_rotation(ref.marker, "a torque acts", "pair of forces"))
        if section == "springs" and _is_node(view, ref.marker):
            kind = str(view.tables["springs"][name].get("kind", "linear"))
            if kind != "linear":
                yield Fault(ref.path, _no_rotation(ref.marker, f"a {kind} spring acts", "linear spring"))


OF_ROTATION = ("rotation", "angular_velocity", "angular_acceleration")
"""The kinds of outputs that depend on the rotation of their marker."""


def _marker_output(view: SceneData, ref: WrittenRef, output: Raw) -> Iterator[Fault]:
    """Faults of an output of the rotation of a node, and of the deformation of what does not deform."""
    kind = str(output.get("kind"))
    turns = kind in OF_ROTATION or FRAME.name in ref.path[2:]
    if turns and _is_node(view, ref.marker):
        yield Fault(ref.path, _no_rotation(ref.marker, f"the output {kind} depends", "marker of another body"))
    rigid = ref.marker.body == GROUND or view.kind(ref.marker.body) == "rigid"
    if kind == DEFLECTION and rigid and OF_CHORD.name not in output:
        of = "the ground" if ref.marker.body == GROUND else "a rigid body"
        text = (
            f"the marker {ref.marker} is on {of}, which does not deform; name a marker of a finite-element body, or "
            "a `chord` between two markers from which the deflection is measured"
        )
        yield Fault(ref.path, text)


def _lines(view: SceneData) -> Iterator[Fault]:
    """Faults of angles of lines without a length, whose direction would be that of rounding errors."""
    held: dict[frozenset[MarkerRef], str] = {}
    for name, joint in view.tables["joints"].items():
        joint_type, markers = _type(joint), view.pair("joints", name)
        if joint_type and markers and {*DISPLACEMENTS} <= {*_removed(joint_type, joint)}:
            held[frozenset(markers)] = name
    for name, output in view.tables["outputs"].items():
        line = view.pair("outputs", name) if output.get("kind") == ANGLE else None
        holding = held.get(frozenset(line)) if line else None
        if line and (holding or line[0] == line[1]):
            why = f"the joint {holding} holds both markers at one place" if holding else "both markers are the same"
            yield Fault(("outputs", name, "between"), f"{why}, so that no line leads from one to the other")


def _drives(view: SceneData) -> Iterator[Fault]:
    joints, driven = view.tables["joints"], dict[str, str]()
    for name, drive in view.tables["drives"].items():
        joint = drive.get("joint")
        if not isinstance(joint, str):
            continue
        path: KeyPath = ("drives", name, "joint")
        if joint not in joints:
            known = f"the joints are {names_text(joints)}" if joints else "write one, such as [joints.bearing]"
            yield Fault(path, f"there is no joint {quoted(joint)}{did_you_mean(joint, joints, known)}")
            continue
        joint_type, kind = _type(joints[joint]), joints[joint].get("kind")
        if joint_type and not joint_type.driven:
            *others, last = (kind for kind, of in SPATIAL_JOINTS.items() if of.driven)
            kinds = f"{', a '.join(others)} or a {last}"
            yield Fault(path, f"no drive can prescribe the motion of the {kind} joint {joint}; drive a {kinds} one")
        other = driven.setdefault(joint, name)
        if other != name:
            yield Fault(path, f"the joint {joint} is driven by {other} already; leave one of the drives out")


def _gears(view: SceneData) -> Iterator[Fault]:
    """Faults of gears between joints that are not there, are the same, or have no motion that a gear couples."""
    joints = view.tables["joints"]
    coupled: dict[frozenset[str], str] = {}
    for name, gear in view.tables["gears"].items():
        pair = gear.get("joints")
        if not isinstance(pair, (list, tuple)) or len(pair) != 2 or not all(isinstance(of, str) for of in pair):
            continue
        path: KeyPath = ("gears", name, "joints")
        if pair[0] == pair[1]:
            yield Fault(path, "a gear couples two joints, and these are the same")
        for i, joint in enumerate(map(str, pair)):
            if joint not in joints:
                known = f"the joints are {names_text(joints)}" if joints else "write one, such as [joints.bearing]"
                yield Fault((*path, i), f"there is no joint {quoted(joint)}{did_you_mean(joint, joints, known)}")
            elif (joint_type := _type(joints[joint])) and not joint_type.couples(_removed(joint_type, joints[joint])):
                kinds = [kind for kind, of in SPATIAL_JOINTS.items() if of.removes and of.couples(of.removes)]
                text = (
                    f"the {joints[joint].get('kind')} joint {joint} has no single rotation about z and no single "
                    f"displacement along it, which a gear could couple; such joints are {', '.join(kinds)}"
                )
                yield Fault((*path, i), text)
        other = coupled.setdefault(frozenset(map(str, pair)), name)
        if other != name and pair[0] != pair[1]:
            yield Fault(path, f"the gear {other} couples these joints already; leave one of the gears out")


_AXIAL = {"forces": (Freedom.DISPLACEMENT, "move along z"), "torques": (Freedom.ROTATION, "turn about z")}
"""The motions of joints in which forces and torques act, with their words."""


def _joint_loads(view: SceneData) -> Iterator[Fault]:
    """Faults of forces and torques in joints that are not there, or whose bodies cannot move that way."""
    joints = view.tables["joints"]
    for section, (motion, moves) in _AXIAL.items():
        for name, load in view.tables[section].items():
            joint, path = load.get("joint"), (section, name, "joint")
            if not isinstance(joint, str):
                continue
            if joint not in joints:
                yield Fault(path, _unknown(view, "joints", joint))
                continue
            joint_type = _type(joints[joint])
            if joint_type and not joint_type.leaves(_removed(joint_type, joints[joint]), motion):
                kinds = [kind for kind, of in SPATIAL_JOINTS.items() if of.removes and of.leaves(of.removes, motion)]
                text = (
                    f"the bodies of the {joints[joint].get('kind')} joint {joint} cannot {moves} of its first marker "
                    f"alone; joints whose bodies can are {', '.join(kinds)}; or write a {NAMED[section]} at a marker"
                )
                yield Fault(path, text)


def _unknown(view: SceneData, section: str, name: str) -> str:
    """The message that there is no element of this name in a section."""
    others = [*view.tables[section]]
    known = f"the {section} are {names_text(others)}" if others else f"the scene has no {section}"
    return f"there is no {NAMED[section]} {quoted(name)}{did_you_mean(name, others, known)}"


def _of_elements(view: SceneData) -> Iterator[Fault]:
    """Faults of outputs of drives, springs and loads in joints that are not there, and of sections of no beam."""
    for name, output in view.tables["outputs"].items():
        output_type = SPATIAL_OUTPUTS.get(str(output.get("kind")))
        for key in output_type.keys if output_type else ():
            value, path = output.get(key.name), ("outputs", name, key.name)
            if not isinstance(value, str):
                continue
            if key.type is KeyType.BEAM_MARKER:
                yield from section_faults(view, path, value)
            elif key.type is KeyType.DRIVE and value not in view.tables["drives"]:
                yield Fault(path, _unknown(view, "drives", value))
            elif key.type is KeyType.SPRING and value not in view.tables["springs"]:
                yield Fault(path, _unknown(view, "springs", value))
            elif key.type is KeyType.JOINT_LOAD:
                loads = [of for section in _AXIAL for of, load in view.tables[section].items() if "joint" in load]
                if value not in loads:
                    known = (
                        f"those are {names_text(loads)}" if loads else "the scene has none; they have the key `joint`"
                    )
                    text = f"there is no force and no torque in a joint called {quoted(value)}"
                    yield Fault(path, f"{text}{did_you_mean(value, loads, known)}")


def _outputs(view: SceneData) -> Iterator[Fault]:
    """Faults of outputs of joints that are not there, or that have no motion of their own."""
    joints = view.tables["joints"]
    for name, output in view.tables["outputs"].items():
        kind, joint = str(output.get("kind")), output.get("joint")
        output_type = SPATIAL_OUTPUTS.get(kind)
        if output_type is None or not isinstance(joint, str) or JOINT not in output_type.keys:
            continue
        path: KeyPath = ("outputs", name, "joint")
        if joint not in joints:
            known = f"the joints are {names_text(joints)}" if joints else "the scene has no joints"
            yield Fault(path, f"there is no joint {quoted(joint)}{did_you_mean(joint, joints, known)}")
            continue
        joint_type = _type(joints[joint])
        if output_type.of_motion and joint_type and not joint_type.couples(_removed(joint_type, joints[joint])):
            text = (
                f"the {joints[joint].get('kind')} joint {joint} has no single rotation about z and no single "
                f"displacement along it, which the output {kind} shows; write an output of its markers instead"
            )
            yield Fault(path, text)


def _removed(joint_type: SpatialJointType, joint: Raw) -> tuple[str, ...]:
    """The relative motions that a joint removes, of a general joint those that can be read."""
    removes = joint.get("removes") if joint_type.removes is None else joint_type.removes
    return tuple(str(name) for name in removes) if isinstance(removes, (list, tuple)) else ()


def _starts(view: SceneData) -> Iterator[Fault]:
    """Faults of initial values of joints that have no such relative motion."""
    for name, joint in view.tables["joints"].items():
        yield from _start(("joints", name, "start"), joint, joint.get("start"), name, SpatialJointInitialValues)
    for name, drive in view.tables["drives"].items():
        of = view.tables["joints"].get(str(drive.get("joint")), {})
        yield from _start(
            ("drives", name, "start"), of, drive.get("start"), str(drive.get("joint")), JointInitialValues
        )


def _start(path: KeyPath, joint: Raw, start: object, name: str, of: type) -> Iterator[Fault]:
    joint_type = _type(joint)
    if not isinstance(start, Mapping) or joint_type is None:
        return
    allowed = [key for motion in joint_type.starts(_removed(joint_type, joint)) for key in (motion.key, motion.rate)]
    allowed += ["speed"] * (joint_type.driven is not None)
    for key in (key.name for key in declared_keys(of) if key.name != "guess"):
        if key in start and key not in allowed:
            own = f"it has {names_text(allowed)}" if allowed else "give initial values of its bodies instead"
            yield Fault((*path, key), f"the {joint.get('kind')} joint {name} has no {key}; {own}")
    for motion in joint_type.starts(_removed(joint_type, joint)):
        if "speed" in start and motion.rate in start:
            yield Fault((*path, "speed"), f"speed and {motion.rate} are the same here; leave one of them out")


def _weightless(view: SceneData) -> Iterator[Fault]:
    """Faults of bodies without mass or inertia whose motion no drive and no fixed joint can prescribe."""
    prescribed: set[str] = set()
    driven = {str(drive.get("joint")) for drive in view.tables["drives"].values()}
    unreadable = any(view.pair("joints", name) is None for name in view.tables["joints"])
    for name, joint in view.tables["joints"].items():
        if name in driven or joint.get("kind") == "fixed":
            prescribed |= {marker.body for marker in view.pair("joints", name) or ()}
    for name, body in view.bodies.items():
        missing = [key for key in ("mass", "inertia") if key not in body]
        if view.kind(name) == "rigid" and missing and name not in prescribed and not unreadable:
            examples = {"mass": "mass = 1.0", "inertia": "inertia = [0.01, 0.01, 0.01, 0, 0, 0]"}
            such = " and ".join(examples[key] for key in missing)
            needed = " and ".join(missing)
            text = f"no drive prescribes the motion of this body, so that it needs {needed}; write {such}"
            yield Fault(("bodies", name), text)
