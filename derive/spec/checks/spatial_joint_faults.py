"""Faults of joints in a scene in space, and of what moves, couples and loads them: drives, gears, initial values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS, Freedom, SpatialJointType
from derive.mechanics.multibody.space.rows import DISPLACEMENTS, ROTATIONS
from derive.spec.checks.cross_references import JOINTS_ARE_WRITTEN, end_faults, unknown_name
from derive.spec.checks.scene_data import Raw, SceneData
from derive.spec.model.joints import JointInitialValues
from derive.spec.model.keys import declared_keys
from derive.spec.model.markers import MarkerRef
from derive.spec.model.scene import NAMED
from derive.spec.model.spatial_scene import SpatialJointInitialValues
from derive.spec.parsing.faults import Fault, KeyPath, names_text
from derive.spec.parsing.values import WrongValueError, number


def joint_type_of(joint: Raw) -> SpatialJointType | None:
    """The type of a joint, or None if its kind is unknown."""
    return SPATIAL_JOINTS.get(str(joint.get("kind")))


def joint_faults(view: SceneData) -> Iterator[Fault]:
    """Faults of the markers, the rotations and the distances of joints."""
    for name, joint in view.tables["joints"].items():
        markers = view.pair("joints", name)
        path: KeyPath = ("joints", name, "between")
        yield from end_faults(view, name)
        joint_type = joint_type_of(joint)
        if joint_type and markers is not None:
            yield from _without_rotation(view, path, joint_type, joint, markers)
        if joint_type and joint_type.keeps_distance and "distance" not in joint:
            text = "a joint that keeps a distance needs the key `distance`, such as distance = 0.3"
            yield Fault(("joints", name), text)
        if _are_exchanged(joint.get("limits")):
            yield Fault(("joints", name, "limits"), "the first limit is the smaller one; exchange the two")


def _are_exchanged(limits: object) -> bool:
    """Whether these are two numbers of which the first is the larger one."""
    try:
        lower, upper = map(number, limits) if isinstance(limits, (list, tuple)) else (0, 0)
    except (WrongValueError, ValueError):  # which the types of the keys report
        return False
    return lower > upper


def _without_rotation(
    view: SceneData, path: KeyPath, joint_type: SpatialJointType, joint: Raw, markers: tuple[MarkerRef, MarkerRef]
) -> Iterator[Fault]:
    """Faults of joints whose rotations or axes are those of a marker at a single node, which has none."""
    removed = {*removed_motions(joint_type, joint)}
    for i, marker in enumerate(markers):
        turns = removed & ROTATIONS.keys() or (
            i == 0 and removed & DISPLACEMENTS.keys() not in (set(), set(DISPLACEMENTS))
        )
        if turns and is_node(view, marker):
            yield Fault((*path, i), no_rotation(marker, f"a {joint.get('kind')} joint acts", "spherical joint"))


def is_node(view: SceneData, marker: MarkerRef) -> bool:
    """Whether a marker is a single node of a finite-element body, which has no rotation."""
    body = view.bodies.get(marker.body)
    at = body.get("markers") if isinstance(body, Mapping) else None
    value = at.get(marker.marker) if isinstance(at, Mapping) else None
    single = isinstance(value, int) or (isinstance(value, Mapping) and "node" in value)
    return view.kind(marker.body) == "flexible" and single


def no_rotation(marker: MarkerRef, acts: str, other: str) -> str:
    """The message on what acts on the rotation of a marker that has none."""
    return (
        f"the marker {marker} is a node, which has no rotation, and {acts} on the rotation of its markers; take a set "
        f"of nodes around it, {{ nodes = [..] }}, or a {other}"
    )


def undriven(name: str, joint: Raw) -> str:
    """Why no drive prescribes the motion of a joint; empty if one can."""
    joint_type = joint_type_of(joint)
    if not joint_type or joint_type.driven:
        return ""
    *others, last = (kind for kind, of in SPATIAL_JOINTS.items() if of.driven)
    kinds = f"{', a '.join(others)} or a {last}"
    return f"no drive can prescribe the motion of the {joint.get('kind')} joint {name}; drive a {kinds} one"


def gear_faults(view: SceneData) -> Iterator[Fault]:
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
                yield Fault((*path, i), unknown_name(view, "joints", joint, JOINTS_ARE_WRITTEN))
            elif (own := joint_type_of(joints[joint])) and not own.couples(removed_motions(own, joints[joint])):
                kinds = [kind for kind, of in SPATIAL_JOINTS.items() if of.removes and of.couples(of.removes)]
                text = (
                    f"the {joints[joint].get('kind')} joint {joint} has no single rotation about z and no single "
                    f"displacement along it, which a gear could couple; such joints are {', '.join(kinds)}"
                )
                yield Fault((*path, i), text)
        other = coupled.setdefault(frozenset(map(str, pair)), name)
        if other != name and pair[0] != pair[1]:
            yield Fault(path, f"the gear {other} couples these joints already; leave one of the gears out")


JOINT_LOADS = {"forces": (Freedom.DISPLACEMENT, "move along z"), "torques": (Freedom.ROTATION, "turn about z")}
"""The motions of joints in which forces and torques act, with their words."""


def joint_load_faults(view: SceneData) -> Iterator[Fault]:
    """Faults of forces and torques in joints that are not there, or whose bodies cannot move that way."""
    joints = view.tables["joints"]
    for section, (motion, moves) in JOINT_LOADS.items():
        for name, load in view.tables[section].items():
            joint, path = load.get("joint"), (section, name, "joint")
            if not isinstance(joint, str):
                continue
            if joint not in joints:
                yield Fault(path, unknown_name(view, "joints", joint))
                continue
            joint_type = joint_type_of(joints[joint])
            if joint_type and not joint_type.leaves(removed_motions(joint_type, joints[joint]), motion):
                kinds = [kind for kind, of in SPATIAL_JOINTS.items() if of.removes and of.leaves(of.removes, motion)]
                text = (
                    f"the bodies of the {joints[joint].get('kind')} joint {joint} cannot {moves} of its first marker "
                    f"alone; joints whose bodies can are {', '.join(kinds)}; or write a {NAMED[section]} at a marker"
                )
                yield Fault(path, text)


def removed_motions(joint_type: SpatialJointType, joint: Raw) -> tuple[str, ...]:
    """The relative motions that a joint removes, of a general joint those that can be read."""
    removes = joint.get("removes") if joint_type.removes is None else joint_type.removes
    return tuple(str(name) for name in removes) if isinstance(removes, (list, tuple)) else ()


def joint_start_faults(view: SceneData) -> Iterator[Fault]:
    """Faults of initial values of joints that have no such relative motion."""
    for name, joint in view.tables["joints"].items():
        yield from _start(("joints", name, "start"), joint, joint.get("start"), name, SpatialJointInitialValues)
    for name, drive in view.tables["drives"].items():
        of = view.tables["joints"].get(str(drive.get("joint")), {})
        yield from _start(
            ("drives", name, "start"), of, drive.get("start"), str(drive.get("joint")), JointInitialValues
        )


def _start(path: KeyPath, joint: Raw, start: object, name: str, of: type) -> Iterator[Fault]:
    joint_type = joint_type_of(joint)
    if not isinstance(start, Mapping) or joint_type is None:
        return
    motions = joint_type.starts(removed_motions(joint_type, joint))
    allowed = [key for motion in motions for key in (motion.key, motion.rate)]
    allowed += ["speed"] * (joint_type.driven is not None)
    for key in (key.name for key in declared_keys(of) if key.name != "guess"):
        if key in start and key not in allowed:
            own = f"it has {names_text(allowed)}" if allowed else "give initial values of its bodies instead"
            yield Fault((*path, key), f"the {joint.get('kind')} joint {name} has no {key}; {own}")
    for motion in motions:
        if "speed" in start and motion.rate in start:
            yield Fault((*path, "speed"), f"speed and {motion.rate} are the same here; leave one of them out")
