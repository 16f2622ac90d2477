"""Faults between the tables of a scene: unknown names, and joints and drives that are impossible."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from derive.errors import quoted
from derive.mechanics.multibody.bodies.beam import WHOLE_BEAM
from derive.mechanics.multibody.joints.joint_type import JointType
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.joints.relative_rows import ALONG_E1, ALONG_E2
from derive.mechanics.multibody.outputs.registry import OUTPUTS
from derive.spec.checks.body_checks import shape_faults
from derive.spec.checks.initial_values import body_start_faults, joint_start_faults
from derive.spec.checks.lines import line_faults
from derive.spec.checks.name_clashes import column_faults, name_faults, piece_counts
from derive.spec.checks.scene_data import Raw, SceneData
from derive.spec.checks.scene_parameters import parameter_faults
from derive.spec.model.keys import KeyType
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.scene import NAMED
from derive.spec.parsing.faults import Fault, KeyPath, did_you_mean, names_text
from derive.spec.tables.scene_bodies import RIGID

JOINTS_ARE_WRITTEN = "write one, such as [joints.bearing]"
"""The advice where a scene has no joints and needs one."""


def scene_faults(data: Raw) -> list[Fault]:
    """All faults of a scene that concern more than a single key."""
    if faults := no_bodies(data):
        return faults
    view = SceneData(data)
    faults = [*ground_faults(view), *name_faults(view), *parameter_faults(view), *_shapes(view)]
    if view.complete:
        faults += [*marker_faults(view), *_joints(view), *drive_faults(view, _undriven), *_weightless(view)]
        faults += [*_actions(view), *plot_faults(view), *line_faults(view, _coincide)]
        faults += [*joint_start_faults(view)]
        faults += [*input_faults(view), *_outputs(view), *column_faults(view)]
    return faults


def no_bodies(data: Raw) -> list[Fault]:
    """The fault of a scene whose table of bodies is empty or missing."""
    bodies = data.get("bodies", {})
    missing = isinstance(bodies, Mapping) and not bodies
    return [Fault(("bodies",), "a scene needs bodies; write one, such as [bodies.rod]")] if missing else []


def unknown_name(view: SceneData, section: str, name: str, none: str = "") -> str:
    """The message that there is no element of this name in a section; none: what to do if there are no others."""
    others = view.names(section)
    known = f"the {section} are {names_text(others)}" if others else none or f"the scene has no {section}"
    return f"there is no {NAMED[section]} {quoted(name)}{did_you_mean(name, others, known)}"


def end_faults(view: SceneData, name: str) -> Iterator[Fault]:
    """Faults of a joint within one body, or within the ground."""
    if not (markers := view.pair("joints", name)):
        return
    first, second = (marker.body for marker in markers)
    path: KeyPath = ("joints", name, "between")
    if first == second == GROUND:
        yield Fault(path, "both markers are on the ground, which does not move; one of them must be on a body")
    elif first == second and first in view.names("bodies"):
        yield Fault(path, f"both markers are on the body {first}; a joint is between two bodies, or ground and body")


def drive_faults(view: SceneData, undriven: Callable[[str, Raw], str]) -> Iterator[Fault]:
    """Faults of drives of joints that are not there, or have another drive; undriven: why a joint has none, or ""."""
    driven: dict[str, str] = {}
    for name, drive in view.tables["drives"].items():
        joint, path = drive.get("joint"), ("drives", name, "joint")
        if not isinstance(joint, str):
            continue
        if joint not in view.names("joints"):
            yield Fault(path, unknown_name(view, "joints", joint, JOINTS_ARE_WRITTEN))
            continue
        if text := undriven(joint, view.tables["joints"].get(joint, {})):
            yield Fault(path, text)
        other = driven.setdefault(joint, name)
        if other != name:
            yield Fault(path, f"the joint {joint} is driven by {other} already; leave one of the drives out")


def ground_faults(view: SceneData) -> Iterator[Fault]:
    """Faults of bodies with the name of the inertial frame."""
    for name in view.names("bodies"):
        if name.lower() == GROUND:
            text = f"{quoted(name)} is the name of the inertial frame, whose markers are in [ground.markers]"
            yield Fault(("bodies", name), f"{text}; choose another name")


def marker_faults(view: SceneData) -> Iterator[Fault]:
    """Faults of references to markers that do not exist."""
    for path, marker in view.marker_refs():
        if marker.body != GROUND and marker.body not in view.names("bodies"):
            bodies = f"the bodies are {names_text(view.names('bodies'))}, and there is the ground"
            hint = did_you_mean(marker.body, (*view.names("bodies"), GROUND), bodies)
            yield Fault(path, f"there is no body {quoted(marker.body)}{hint}")
            continue
        markers = view.markers(marker.body)
        if markers is not None and marker.marker not in markers:
            yield Fault(path, _no_marker(view, marker, markers))


def _no_marker(view: SceneData, marker: MarkerRef, markers: list[str]) -> str:
    who = "the ground" if marker.body == GROUND else f"the body {marker.body}"
    text = f"{who} has no marker {quoted(marker.marker)}"
    if not markers:
        such = "-1" if view.is_beam(marker.body) else "[0, 0, 0]" if view.in_space else "[0, 0]"
        table = "[ground.markers]" if marker.body == GROUND else f"[bodies.{marker.body}.markers]"
        return f"{text}, and no others; write {table} with {marker.marker} = {such}"
    known_names = f"it has the marker{'s' * (len(markers) > 1)} {', '.join(markers)}"
    return text + did_you_mean(marker.marker, markers, known_names)


def _joints(view: SceneData) -> Iterator[Fault]:
    for name, joint in view.tables["joints"].items():
        faults = [*end_faults(view, name)]
        yield from faults
        joint_type, markers = _type(joint), view.pair("joints", name)
        if faults or not joint_type or not markers or not joint_type.rigid_first or not view.is_beam(markers[0].body):
            continue
        first, second = (marker.body for marker in markers)
        text = f"the line must belong to the ground or to a rigid body, and {first} is a beam"
        if view.is_beam(second):
            text += f", as {second} is; weld a rigid body to {first}, and let {second} slide on it"
        else:
            text += "; swap the two markers"
        yield Fault(("joints", name, "between"), text)


def _undriven(name: str, joint: Raw) -> str:
    """Why no drive prescribes the motion of a joint; empty if one can."""
    joint_type = _type(joint)
    if not joint_type or joint_type.driven:
        return ""
    why = "nothing moves in" if joint_type.freedom == 0 else "no drive can prescribe the motion of"
    kinds = " or a ".join(kind for kind, of in JOINTS.items() if of.driven)
    return f"{why} the {joint.get('kind')} joint {name}; drive a {kinds} one"


def _type(joint: Raw) -> JointType | None:
    """The type of a joint, or None if its kind is unknown."""
    return JOINTS.get(str(joint.get("kind")))


def _coincide(joint: Raw) -> bool:
    """Whether a joint keeps its markers at one place."""
    joint_type = _type(joint)
    return joint_type is not None and {ALONG_E1, ALONG_E2} <= {*joint_type.removes}


def _weightless(view: SceneData) -> Iterator[Fault]:
    """Faults of bodies without mass or inertia whose motion no drive can prescribe."""
    connected, prescribed = set(), set()
    driven = {str(drive.get("joint")) for drive in view.tables["drives"].values()}
    for name, joint in view.tables["joints"].items():
        bodies = {marker.body for marker in view.pair("joints", name) or ()}
        connected |= bodies
        # A weld may fix a body to another whose motion is prescribed, which the derivation checks.
        joint_type = _type(joint)
        if name in driven or (joint_type and joint_type.freedom == 0):
            prescribed |= bodies
    unreadable = any(view.pair("joints", name) is None for name in view.tables["joints"])
    for name, body in view.bodies.items():
        missing = [key for key in ("mass", "inertia") if key not in body]
        misspelt = any(key not in RIGID.model.model_fields for key in body)
        if view.kind(name) != "rigid" or not missing or name in prescribed or unreadable or misspelt:
            continue
        such = " and ".join(f"{key} = 1.0" for key in missing)
        if name in connected:
            text = f"no drive prescribes the motion of this body, so that it needs {' and '.join(missing)}"
        else:
            text = f"no joint holds this body, so that it needs {' and '.join(missing)}"
        yield Fault(("bodies", name), f"{text}; write {such}")


def _actions(view: SceneData) -> Iterator[Fault]:
    """Faults of forces, torques and springs that have no effect."""
    for kind in ("forces", "torques"):
        for name, table in view.tables[kind].items():
            at = table.get("at")
            if isinstance(at, str) and at.startswith(f"{GROUND}.") and "against" not in table:
                text = f"a {NAMED[kind]} on the ground moves nothing; name a marker of a body"
                yield Fault((kind, name, "at"), text)


def input_faults(view: SceneData) -> Iterator[Fault]:
    """Faults of inputs that are used but do not exist, or that exist but are not used."""
    known, used = view.tables["inputs"], set()
    for path, name in view.input_refs():
        used.add(name)
        if name not in known:
            yield Fault(path, unknown_name(view, "inputs", name, f"write one, such as [inputs.{name}]"))
    for name in known:
        if name not in used:
            text = f'no force, torque, load or drive uses it; write {{ input = "{name}" }} in place of a function of t'
            yield Fault(("inputs", name), f"{text}, or leave it out")


def _outputs(view: SceneData) -> Iterator[Fault]:
    """Faults of outputs that refer to joints, drives or springs that do not exist, or to sections of rigid bodies."""
    sections: dict[object, str] = {KeyType.JOINT: "joints", KeyType.DRIVE: "drives", KeyType.SPRING: "springs"}
    for name, table in view.tables["outputs"].items():
        output_type = OUTPUTS.get(str(table.get("kind")))
        for key in output_type.keys if output_type else ():
            section, value = sections.get(key.type), table.get(key.name)
            if key.type is KeyType.BEAM_MARKER:
                yield from section_faults(view, ("outputs", name, key.name), value)
            if section and isinstance(value, str) and value not in view.tables[section]:
                yield Fault(("outputs", name, key.name), unknown_name(view, section, value))


def section_faults(view: SceneData, path: KeyPath, marker: object) -> Iterator[Fault]:
    """A fault of a section, which a marker of a beam names, if it is on another body."""
    body = marker.partition(".")[0] if isinstance(marker, str) else ""
    if body in view.bodies and not view.is_beam(body):
        beams = [name for name in view.bodies if view.is_beam(name)]
        known = f"the beams are {names_text(beams)}" if beams else "the scene has no beam"
        yield Fault(path, f"the body {body} is no beam, and has no such sections; {known}")


def plot_faults(view: SceneData) -> Iterator[Fault]:
    """Faults of plots of drives and beams that are not there, and of beams that are not cut."""
    for name, plot in view.tables["plots"].items():
        over, cut = plot.get("over"), plot.get("cut")
        if isinstance(over, str) and over not in view.names("drives"):
            text = unknown_name(view, "drives", over, "leave `over` out, for a plot over the time")
            yield Fault(("plots", name, "over"), text)
        beams = [body for body in view.bodies if view.is_beam(body)]
        if isinstance(cut, str) and cut not in beams:
            known_names = f"the beams are {names_text(beams)}" if beams else "leave `cut` and `pieces` out"
            if cut in view.bodies:
                text = f"the body {cut} is no beam, and beams alone are cut into pieces; {known_names}"
            else:
                text = f"there is no body {quoted(cut)}{did_you_mean(cut, beams, known_names)}"
            yield Fault(("plots", name, "cut"), text)
        elif isinstance(cut, str) and max(piece_counts(view, cut, view.bodies[cut])) > 1:
            beam = view.bodies[cut]
            if "ends" in beam or isinstance(beam.get("ansatz"), Mapping):
                yield Fault(("plots", name, "cut"), WHOLE_BEAM)


def _shapes(view: SceneData) -> Iterator[Fault]:
    for name, body in view.bodies.items():
        if view.is_beam(name):
            faults = shape_faults(("bodies", name), body)
            yield from faults or body_start_faults(view, name, body)
