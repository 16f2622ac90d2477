"""All that a scene in space can have, from the registries and the declared keys, and what a scene has.

A feature is a tuple of words: a table and its key, a key and its choice, a kind, or a combination that has code of its
own. What the registries or the specification gain is a feature at once, which random scenes and the oracle then need.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from written_scene import Table

from derive.mechanics.multibody.space.bodies import SPATIAL_BODIES
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.mechanics.multibody.space.springs import SPATIAL_BUSHINGS, SPATIAL_SPRINGS, SpatialSpringType
from derive.spec.model.beam_parts import AxialDeformation, BeamDamping, Frame, ShapeFamily
from derive.spec.model.body import BodyFrame, Damping, NodalBody
from derive.spec.model.joints import Drive
from derive.spec.model.keys import QUANTITIES, Key, KeyType, declared_keys
from derive.spec.model.scene import SceneInput
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_beam_parts import (
    LateralDeflection,
    SectionFrame,
    SpatialAttachedMass,
    SpatialDistributedLoad,
    TorsionalDeformation,
)
from derive.spec.model.spatial_bodies import FlexibleBody, FrameMarker, NodalLoad, NodeFrame, SpatialRigidBody
from derive.spec.model.spatial_forces import SpatialForce, SpatialJointForce, SpatialJointTorque, SpatialTorque
from derive.spec.model.spatial_scene import Gear, SpatialJoint, SpatialScene
from derive.spec.parsing.time_expression import FUNCTIONS, WHOLE
from derive.spec.tables.sections import FUNCTION_SECTIONS, OF_SCENE
from derive.spec.tables.spatial_bodies import NOT_IN_SCENES

Feature = tuple[str, ...]

TABLES: Mapping[str, type] = {
    "rigid body": SpatialRigidBody,
    "flexible body": FlexibleBody,
    "beam": SpatialBeam,
    "lateral": LateralDeflection,
    "torsion": TorsionalDeformation,
    "axial": AxialDeformation,
    "shapes": ShapeFamily,
    "frame of a beam": Frame,
    "damping of a beam": BeamDamping,
    "section": SectionFrame,
    "mass on a beam": SpatialAttachedMass,
    "load on a beam": SpatialDistributedLoad,
    "marker": FrameMarker,
    "marker at nodes": NodeFrame,
    "frame": BodyFrame,
    "damping": Damping,
    "nodal load": NodalLoad,
    "joint": SpatialJoint,
    "drive": Drive,
    "gear": Gear,
    "force": SpatialForce,
    "torque": SpatialTorque,
    "joint force": SpatialJointForce,
    "joint torque": SpatialJointTorque,
    "input": SceneInput,
    "scene": SpatialScene,
}
"""The frozen types whose keys a table may have."""
PARAMETERS = (
    *QUANTITIES,
    KeyType.COORDINATE_TRIPLE,
    KeyType.COORDINATES,
    KeyType.INERTIA_TENSOR,
    KeyType.ACCELERATION,
    KeyType.BUSHING_MATRIX,
    KeyType.SPEED,
)
"""The types of values that may be, or contain, run-time parameters."""
OF_TIME = (KeyType.FUNCTION, KeyType.FUNCTION_TRIPLE, KeyType.SPEED)
FUNCTION_FORMS = (*(name for name in FUNCTIONS if name not in WHOLE), "table", "parameter", "pi", "power", "quotient")
NOT_IN_EQUATIONS: Mapping[Feature, str] = {
    **{
        (table, "start"): "initial values"
        for table in ("rigid body", "flexible body", "beam", "joint", "drive", "scene")
    },
    ("scene", "plots"): "shows results",
    ("flexible body", "stress"): "shows results",
    ("marker at nodes", "set"): "the nodes that it names: test_node_meshes.py",
    ("joint", "limits"): "noted where a run passes them",
    **{(table, "visuals"): "shows results" for table in ("rigid body", "scene")},
    ("joint", "closes_loop"): "the choice of coordinates: test_trees.py",
    **{
        ("scene", "coordinates", *choice): "both are compared in test_trees.py"
        for choice in ((), ("auto",), ("relative",), ("absolute",))
    },
    ("scene", "outputs"): "compared with differences in test_space_marker_outputs.py and others",
    **{("scene", "start", choice): "initial values" for choice in ("equilibrium", "steady")},
    **{
        ("scene", "lowering", *choice): "a choice of code, not of equations"
        for choice in ((), ("auto",), ("flat",), ("instances",))
    },
    ("scene", "redundant", "auto"): "the default",
    ("scene", "redundant", "error"): "refuses scenes",
    ("flexible body", "units"): "the units of files, in test_nodal_loads.py",
    **{
        ("flexible body", *key): "other modes: tests/reduction/test_component_modes.py"
        for key in (
            ("interface",),
            ("component_modes",),
            *(("component_modes", kind) for kind in ("free", "craig_bampton", "attachment")),
        )
    },
    **{
        ("beam", "terms", *choice): "compared with points in test_full_second_order.py; truncated ones are the default"
        for choice in ((), ("truncated",), ("full",))
    },
    ("nodal load", "file"): "written in place of lists, in test_nodal_loads.py",
    ("input", "unit"): "a text",
    ("beam", "pieces"): "a row of beams: tests/space/test_spatial_beam_pieces.py",
    ("load on a beam", "torque"): "tests/space/test_spatial_beam_loads.py",
}
"""Features that do not change the equations of motion, or that other tests compare, each with the reason."""


def spring_types() -> Iterator[tuple[str, SpatialSpringType]]:
    yield from SPATIAL_SPRINGS.items()
    yield from SPATIAL_BUSHINGS.items()


def keys_of_tables() -> Iterator[tuple[str, Key]]:
    """The tables of a scene with their keys, those of kinds of springs included."""
    for table, of in TABLES.items():
        yield from ((table, key) for key in declared_keys(of))
    own = (key for key in declared_keys(NodalBody) if key.name not in NOT_IN_SCENES)
    yield from (("flexible body", key) for key in own)
    for kind, of_kind in spring_types():
        yield from ((f"{kind} spring", key) for key in of_kind.keys)


def possible() -> set[Feature]:
    """All features of scenes in space that may change the equations of motion."""
    result: set[Feature] = {("section", name) for name in FUNCTION_SECTIONS} | {("scene", name) for name in OF_SCENE}
    for table, key in keys_of_tables():
        result.add((table, key.name))
        result |= {(table, key.name, choice) for choice in key.choices if table in TABLES}
        result |= {(table, key.name, "parameter")} if key.type in PARAMETERS else set()
        result |= {(table, key.name, form) for form in ("function", "input") if key.type in OF_TIME}
    result -= {("drive", "speed", "input"), ("input", "value", "input")}  # refused
    result |= {(body, "order", order) for body in ("flexible body", "beam") for order in "12"}
    result |= {("function", name) for name in FUNCTION_FORMS}
    result |= {("body", kind) for kind in SPATIAL_BODIES} | {("body", "flexible")}
    for kind, of in SPATIAL_JOINTS.items():
        result.add(("joint", "kind", kind))
        result |= {(end, "of a rigid body at the ground", kind) for end in ("first", "second")}
        result.add(("rigid body that keeps coordinates", kind))
        result |= {(body, "joint", kind) for body in ("flexible body", "beam")}
        if of.driven:
            result |= {("drive", kind, where) for where in ("at the ground", "of bodies", "in a gear")}
    result |= {("joint at a node", kind) for kind in ("spherical", "distance", "point_on_line", "general")}
    result |= {(f"{kind} spring", "between") for kind, _ in spring_types()}
    result |= {("bushing", key, form) for key in ("stiffness", "damping") for form in ("six", "matrix")}
    for at in ("rigid body", "section", "node", "mean set", "rigid set"):
        result |= {(section, frame, at) for section in ("force", "torque") for frame in ("inertial", "body")}
    result -= {("torque", frame, "node") for frame in ("inertial", "body")}  # refused: a node has no rotation
    result |= {("carried body", "neighbour", kind) for kind in ("rigid", "flexible", "beam")} | {
        ("carried body", "no mass")
    }
    result |= {("joint", "twice"), ("rotational spring", "in a joint"), ("bushing spring", "in a joint")}
    return result - {*NOT_IN_EQUATIONS}


def features(scene: Table) -> set[Feature]:
    """The features of a scene."""
    return {*_of_tables(scene), *_of_bodies(scene), *_of_joints(scene), *_of_loads(scene)}


def _of_tables(scene: Table) -> Iterator[Feature]:
    for table, of in tables_of(scene):
        for key, value in of.items():
            yield (table, key)
            yield from ((table, key, form) for form in _forms(value))
            if isinstance(value, (str, int)):
                yield (table, key, str(value))
    for name in FUNCTION_SECTIONS:
        if name in scene:
            yield ("section", name)
    for text in _texts(scene):
        yield from (("function", name) for name in _functions(text, scene))


def tables_of(scene: Table) -> Iterator[tuple[str, Table]]:
    """The tables of a scene with the words for them."""
    every = {**scene.get("scene", {}), **{name: scene[name] for name in scene if name not in ("scene", "name")}}
    yield "scene", every
    yield from (("marker", _marker(of, "at")) for of in scene.get("ground", {}).get("markers", {}).values())
    for body in scene["bodies"].values():
        flexible, beam = "nodes" in body, "length" in body
        yield "beam" if beam else "flexible body" if flexible else "rigid body", body
        for of in body.get("markers", {}).values():
            word = "section" if beam else "marker"
            yield ("marker at nodes", _marker(of, "node")) if flexible else (word, _marker(of, "at"))
        if beam:
            yield from _parts_of(body)
        yield from (("load on a beam" if beam else "nodal load", of) for of in body.get("loads", {}).values())
        if flexible:
            frame = body.get("frame", "mean")
            yield "frame", frame if isinstance(frame, Mapping) else {"kind": frame}
            yield "damping", body.get("damping", {})
    for section in ("joints", "drives", "gears", "inputs"):
        yield from ((section[:-1], of) for of in scene.get(section, {}).values())
    for section in ("forces", "torques"):
        for of in scene.get(section, {}).values():
            yield ("joint " if "joint" in of else "") + section[:-1], of
    yield from ((f"{of.get('kind', 'linear')} spring", of) for of in scene.get("springs", {}).values())


def _parts_of(beam: Table) -> Iterator[tuple[str, Table]]:
    """The tables in the table of a beam."""
    yield from ((name, beam[name]) for name in ("lateral", "torsion", "axial") if name in beam)
    if "frame" in beam:
        yield "frame of a beam", _marker(beam["frame"], "kind")
    if isinstance(beam.get("ansatz"), Mapping):
        yield "shapes", beam["ansatz"]
    yield "damping of a beam", beam.get("damping", {})
    yield from (("mass on a beam", of) for of in beam.get("masses", {}).values())


def _marker(of: Any, plain: str) -> Table:
    return of if isinstance(of, Mapping) else {plain: of}


def _forms(value: Any) -> set[str]:
    """Whether a value has parameters, functions of time, or inputs in it."""
    if isinstance(value, Mapping):
        return {"parameter"} & {"parameter" for key in value if key == "symbol"} | {"input"} & {*value}
    if isinstance(value, list):
        return set().union(*map(_forms, value))
    return {"function"} if isinstance(value, str) and "t" in value else set()


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, Mapping):
        for of in value.values():
            yield from _texts(of)
    elif isinstance(value, list):
        for of in value:
            yield from _texts(of)
    elif isinstance(value, str):
        yield value


def _functions(text: str, scene: Table) -> Iterator[str]:
    """The functions in a text, if it is one of time."""
    try:
        nodes = [*ast.walk(ast.parse(text.strip().replace("^", "**"), mode="eval"))]
    except SyntaxError:
        return
    for node in nodes:
        match node:
            case ast.Call(func=ast.Name(id=name)):
                yield "table" if name in scene.get("tables", {}) else name
            case ast.Name(id=name) if name in scene.get("parameters", {}):
                yield "parameter"
            case ast.Name(id="pi"):
                yield "pi"
            case ast.BinOp(op=ast.Pow(), left=ast.Name()):
                yield "power"
            case ast.BinOp(op=ast.Div(), right=ast.BinOp()):
                yield "quotient"


def _of_bodies(scene: Table) -> Iterator[Feature]:
    carried = {*_carried(scene)}
    for name, body in scene["bodies"].items():
        yield ("body", _kind(body))
        if name in carried and "mass" not in body:
            yield ("carried body", "no mass")
    for joint in scene.get("joints", {}).values():
        bodies = [end.split(".")[0] for end in joint["between"]]
        for own, other in (bodies, bodies[::-1]):
            if other in carried and own not in carried and own != "ground":
                yield ("carried body", "neighbour", _kind(scene["bodies"][own]))


def _kind(body: Table) -> str:
    return "flexible" if "nodes" in body else "beam" if "length" in body else "rigid"


def _carried(scene: Table) -> Iterator[str]:
    """The bodies whose motion a drive at the ground prescribes."""
    for drive in scene.get("drives", {}).values():
        for end in scene["joints"][drive["joint"]]["between"]:
            name = end.split(".")[0]
            others = {e.split(".")[0] for e in scene["joints"][drive["joint"]]["between"]} - {name}
            body = scene["bodies"].get(name, {})
            if others == {"ground"} and "nodes" not in body and not body.get("keep_coordinates"):
                yield name


def _of_joints(scene: Table) -> Iterator[Feature]:
    bodies = scene["bodies"]
    driven = {drive["joint"] for drive in scene.get("drives", {}).values()}
    geared = {joint for gear in scene.get("gears", {}).values() for joint in gear["joints"]}
    seen: list[Sequence[str]] = []
    for name, joint in scene.get("joints", {}).items():
        kind, ends = joint["kind"], [end.split(".")[0] for end in joint["between"]]
        if joint["between"] in seen:
            yield ("joint", "twice")
        seen.append(joint["between"])
        for i, own in enumerate(ends):
            body, grounded = bodies.get(own, {}), ends[1 - i] == "ground"
            if _kind(body) != "rigid":
                yield ("beam" if "length" in body else "flexible body", "joint", kind)
            elif body and body.get("keep_coordinates"):
                yield ("rigid body that keeps coordinates", kind)
            elif body and grounded:
                yield (("first", "second")[i], "of a rigid body at the ground", kind)
            if _place(scene, joint["between"][i]) == "node":
                yield ("joint at a node", kind)
        if name in driven:
            yield ("drive", kind, "at the ground" if "ground" in ends else "of bodies")
            if name in geared:
                yield ("drive", kind, "in a gear")


def _of_loads(scene: Table) -> Iterator[Feature]:
    for section, key in (("forces", "at"), ("torques", "on")):
        for of in scene.get(section, {}).values():
            if key in of:
                yield (section[:-1], of.get("frame", "inertial"), _place(scene, of[key]))
    joined = [{*joint["between"]} for joint in scene.get("joints", {}).values()]
    for spring in scene.get("springs", {}).values():
        kind = spring.get("kind", "linear")
        if {*spring["between"]} in joined:
            yield (f"{kind} spring", "in a joint")
        if kind == "bushing":
            for name in ("stiffness", "damping"):
                rows = spring.get(name, [])
                yield ("bushing", name, "matrix" if rows and isinstance(rows[0], list) else "six")


def _place(scene: Table, marker: str) -> str:
    """The body of a marker, or the nodes of it."""
    body, _, name = marker.partition(".")
    kind = "ground" if body == "ground" else _kind(scene["bodies"][body])
    if kind != "flexible":
        return {"ground": kind, "beam": "section", "rigid": "rigid body"}[kind]
    of = scene["bodies"][body]["markers"][name]
    if not isinstance(of, Mapping) or "node" in of:
        return "node"
    return f"{of.get('motion', 'mean')} set"
