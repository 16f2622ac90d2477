"""Faults between the tables of a scene in space: unknown names, and what acts where it cannot."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from derive.errors import quoted
from derive.mechanics.multibody.space.marker_outputs import DEFLECTION, FRAME, OF_CHORD
from derive.mechanics.multibody.space.outputs import JOINT, SPATIAL_OUTPUTS
from derive.mechanics.multibody.space.rows import DISPLACEMENTS
from derive.spec.checks.body_checks import spatial_shape_faults
from derive.spec.checks.cross_references import (
    drive_faults,
    ground_faults,
    input_faults,
    marker_faults,
    no_bodies,
    plot_faults,
    section_faults,
    unknown_name,
)
from derive.spec.checks.initial_values import spatial_start_faults
from derive.spec.checks.lines import line_faults
from derive.spec.checks.name_clashes import name_faults
from derive.spec.checks.scene_data import Raw, SceneData, WrittenRef
from derive.spec.checks.scene_parameters import parameter_faults
from derive.spec.checks.spatial_joint_faults import (
    JOINT_LOADS,
    gear_faults,
    is_node,
    joint_faults,
    joint_load_faults,
    joint_start_faults,
    joint_type_of,
    no_rotation,
    removed_motions,
    undriven,
)
from derive.spec.model.keys import KeyType
from derive.spec.model.markers import GROUND
from derive.spec.model.scene import NAMED
from derive.spec.parsing.faults import Fault, KeyPath, did_you_mean, names_text


def spatial_scene_faults(data: Raw) -> list[Fault]:
    """All faults of a scene in space that concern more than a single key."""
    if faults := no_bodies(data):
        return faults
    view = SceneData(data)
    faults = [*ground_faults(view), *name_faults(view), *parameter_faults(view)]
    if view.complete:
        faults += [
            *marker_faults(view),
            *_shapes(view),
            *joint_faults(view),
            *drive_faults(view, undriven),
            *gear_faults(view),
            *_outputs(view),
            *_of_elements(view),
            *joint_load_faults(view),
            *_actions(view),
            *line_faults(view, _coincide),
            *plot_faults(view),
            *joint_start_faults(view),
            *_weightless(view),
        ]
        faults += input_faults(view)
    return faults


def _shapes(view: SceneData) -> Iterator[Fault]:
    """Faults of the shapes of beams."""
    for name, body in view.bodies.items():
        if "ansatz" in body or "length" in body:
            faults = spatial_shape_faults(("bodies", name), body)
            yield from faults or spatial_start_faults(view, name, body)


def _actions(view: SceneData) -> Iterator[Fault]:
    """Faults of loads and springs that have no effect, and of those on the rotation of a node, which is not known."""
    for ref in view.marker_refs():
        section, name = ref.path[0], str(ref.path[1])
        alone = section == "forces" or (section == "torques" and "against" not in view.tables["torques"][name])
        if alone and ref.marker.body == GROUND:
            text = f"a {NAMED[str(section)]} on the ground moves nothing; name a marker of a body"
            yield Fault(ref.path, text)
        if section == "outputs":
            yield from _marker_output(view, ref, view.tables["outputs"][name])
        if section == "torques" and is_node(view, ref.marker):
            yield Fault(ref.path, no_rotation(ref.marker, "a torque acts", "pair of forces"))
        if section == "springs" and is_node(view, ref.marker):
            kind = str(view.tables["springs"][name].get("kind", "linear"))
            if kind != "linear":
                yield Fault(ref.path, no_rotation(ref.marker, f"a {kind} spring acts", "linear spring"))


OF_ROTATION = ("rotation", "angular_velocity", "angular_acceleration")
"""The kinds of outputs that depend on the rotation of their marker."""


def _marker_output(view: SceneData, ref: WrittenRef, output: Raw) -> Iterator[Fault]:
    """Faults of an output of the rotation of a node, and of the deformation of what does not deform."""
    kind = str(output.get("kind"))
    turns = kind in OF_ROTATION or FRAME.name in ref.path[2:]
    if turns and is_node(view, ref.marker):
        yield Fault(ref.path, no_rotation(ref.marker, f"the output {kind} depends", "marker of another body"))
    rigid = ref.marker.body == GROUND or view.kind(ref.marker.body) == "rigid"
    if kind == DEFLECTION and rigid and OF_CHORD.name not in output:
        of = "the ground" if ref.marker.body == GROUND else "a rigid body"
        text = (
            f"the marker {ref.marker} is on {of}, which does not deform; name a marker of a finite-element body, or "
            "a `chord` between two markers from which the deflection is measured"
        )
        yield Fault(ref.path, text)


def _coincide(joint: Raw) -> bool:
    """Whether a joint keeps its markers at one place."""
    joint_type = joint_type_of(joint)
    return joint_type is not None and {*DISPLACEMENTS} <= {*removed_motions(joint_type, joint)}


SECTIONS: dict[object, str] = {KeyType.DRIVE: "drives", KeyType.SPRING: "springs"}
"""The sections of elements that outputs name."""


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
            elif (section := SECTIONS.get(key.type)) and value not in view.tables[section]:
                yield Fault(path, unknown_name(view, section, value))
            elif key.type is KeyType.JOINT_LOAD:
                loads = [of for section in JOINT_LOADS for of, load in view.tables[section].items() if "joint" in load]
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
            yield Fault(path, unknown_name(view, "joints", joint))
            continue
        joint_type = joint_type_of(joints[joint])
        if output_type.of_motion and joint_type and not joint_type.couples(removed_motions(joint_type, joints[joint])):
            text = (
                f"the {joints[joint].get('kind')} joint {joint} has no single rotation about z and no single "
                f"displacement along it, which the output {kind} shows; write an output of its markers instead"
            )
            yield Fault(path, text)


def _chosen(view: SceneData, key: str) -> object:
    """A value of the section `scene`; None if it is not given."""
    of_scene = view.data.get("scene")
    return of_scene.get(key) if isinstance(of_scene, Mapping) else None


def _weightless(view: SceneData) -> Iterator[Fault]:
    """Faults of bodies without mass or inertia whose motion no drive and no fixed joint can prescribe."""
    prescribed: set[str] = set()
    driven = {str(drive.get("joint")) for drive in view.tables["drives"].values()}
    unreadable = any(view.pair("joints", name) is None for name in view.tables["joints"])
    relative = _chosen(view, "coordinates") != "absolute"
    carried, carriers = set[str](), set[str]()
    for name, joint in view.tables["joints"].items():
        ends = {marker.body for marker in view.pair("joints", name) or ()}
        if name in driven or joint.get("kind") == "fixed":
            prescribed |= ends
        if relative:
            carriers |= carried & ends  # a body with two joints may carry mass, which the derivation finds out
            carried |= ends
    for name, body in view.bodies.items():
        missing = [key for key in ("mass", "inertia") if key not in body]
        without = name in prescribed or (name in carriers and len(missing) == 2)
        if view.kind(name) == "rigid" and missing and not without and not unreadable:
            examples = {"mass": "mass = 1.0", "inertia": "inertia = [0.01, 0.01, 0.01, 0, 0, 0]"}
            such = " and ".join(examples[key] for key in missing)
            needed = " and ".join(missing)
            text = f"no drive prescribes the motion of this body, so that it needs {needed}; write {such}"
            yield Fault(("bodies", name), text)
