"""The tables of a scene in space: bodies, marker frames, joints, and the scene itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Annotated, Any

from pydantic import Field

from derive.mechanics.multibody.space.forces import SPATIAL_BUSHINGS, SPATIAL_SPRINGS
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.mechanics.multibody.space.outputs import SPATIAL_OUTPUTS
from derive.spec.files.reference_curves import Rows
from derive.spec.model.body import NodalBody, NodeData
from derive.spec.model.instances import COUNT
from derive.spec.model.keys import KeyType, declared_keys
from derive.spec.model.plots import Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene import NAMED, Drive
from derive.spec.model.simulation import AT_REST
from derive.spec.model.spatial_scene import (
    FlexibleBody,
    FrameMarker,
    Gear,
    NodalLoad,
    NodeFrame,
    SpatialForce,
    SpatialInitialValues,
    SpatialJoint,
    SpatialJointForce,
    SpatialJointInitialValues,
    SpatialJointTorque,
    SpatialRigidBody,
    SpatialScene,
    SpatialSpring,
    SpatialTorque,
)
from derive.spec.parsing.values import WrongValueError
from derive.spec.tables.body import NODAL_KEYS, nodal_keys
from derive.spec.tables.declared_tables import TABLES, DeclaredTable, declare, key_field, keyed_model
from derive.spec.tables.registered_tables import registered_table
from derive.spec.tables.shared import ElementName, TomlTable, by_name, one_of
from derive.spec.tables.simulation import PLOT, SIMULATION
from derive.spec.tables.specification import OTHER_SECTIONS, SCENE, SpecificationKeys, plots
from derive.spec.tables.value_types import COORDINATE_TRIPLE, VALUE_TYPES, markers_type

declare(SpatialInitialValues, "SpatialInitialValuesTable")
declare(SpatialJointInitialValues, "SpatialJointStartTable")
FRAME = declare(
    FrameMarker, "FrameMarkerTable", plain=COORDINATE_TRIPLE, doc="A marker frame: its point and its rotation."
)


def _frame(name: str, at: Any) -> FrameMarker:
    return replace(at, name=name) if isinstance(at, FrameMarker) else FrameMarker(name, at)


VALUE_TYPES[KeyType.FRAMES] = markers_type(FRAME.value, "coordinates", _frame)


def _check_inertia(body: SpatialRigidBody) -> None:
    """Refuse a tensor of inertia that no distribution of mass has, if its entries are numbers."""
    if body.inertia is None or any(isinstance(entry, Parameter) for entry in body.inertia):
        return
    xx, yy, zz, xy, xz, yz = (float(entry) for entry in body.inertia if not isinstance(entry, Parameter))
    a, b, c = principal_moments(xx, yy, zz, xy, xz, yz)
    text = f"no body has this tensor of inertia: its principal moments are {a:.6g}, {b:.6g}, {c:.6g} kg m^2"
    size = max(abs(a), abs(b), abs(c))
    if a < -ROUNDING * size or size == 0.0:
        raise WrongValueError(f"{text}, and they are positive")
    if c > (a + b) * (1 + ROUNDING):
        raise WrongValueError(f"{text}, and the largest is at most the sum of the other two")


ROUNDING = 1e-9
"""The part of the principal moments by which they may violate an inequality, since entries are rounded."""


def principal_moments(xx: float, yy: float, zz: float, xy: float, xz: float, yz: float) -> tuple[float, float, float]:
    """The eigenvalues of a symmetric tensor, from the least to the largest, by Jacobi rotations."""
    import numpy as np  # not for specifications that have no tensors

    moments = np.linalg.eigvalsh(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
    return float(moments[0]), float(moments[1]), float(moments[2])


def _node_frame(node: Any = None, nodes: Any = (), **given: Any) -> NodeFrame:
    """A marker of a finite-element body. Raises WrongValueError for what does not go together."""
    if (node is None) == (not nodes):
        raise WrongValueError("a marker is at a node, node = 17, or at a set of nodes, nodes = [17, 18, 30, 31]")
    if given.get("motion", "mean") == "rigid" and node is not None:
        raise WrongValueError('a single node has no rotation; a rigid set, motion = "rigid", needs nodes = [..]')
    own = (node,) if node is not None else tuple(nodes)
    if len(set(own)) < len(own):
        raise WrongValueError("a node is named twice in `nodes`; name each once, with a weight of its own")
    if given.get("weights") and len(given["weights"]) != len(own):
        raise WrongValueError(f"there are {len(own)} nodes and {len(given['weights'])} weights; give a weight for each")
    if node is None and len(own) < LEAST_NODES:
        raise WrongValueError("a set of nodes needs three, not on a line, to have a rotation; or write node = 17")
    return NodeFrame("", own, **given)


LEAST_NODES = 3
NODE_FRAME = declare(
    NodeFrame,
    "NodeFrameTable",
    make=lambda **given: _node_frame(**{key: value for key, value in given.items() if key != "name"}),
    plain=VALUE_TYPES[KeyType.COUNT],
    doc="A marker at a node or at a set of nodes.",
)


def _named_node_frame(name: str, at: Any) -> NodeFrame:
    return replace(at, name=name) if isinstance(at, NodeFrame) else NodeFrame(name, (at,))


VALUE_TYPES[KeyType.NODE_FRAMES] = markers_type(NODE_FRAME.value, "nodes", _named_node_frame)


OR_A_FILE = 'or file = "forces.csv" with the columns node, x, y, z, or a .npz file, in place of both'


def _nodal_load(**given: Any) -> NodalLoad:
    """A load on nodes. Raises WrongValueError for what does not go together."""
    nodes, forces = given["nodes"], given["forces"]
    if not nodes:
        raise WrongValueError(f"a load acts on nodes; write their numbers, such as nodes = [3, 4], {OR_A_FILE}")
    if not forces:
        raise WrongValueError(f"a load has forces at its nodes; write forces = [[0, 0, -5]], {OR_A_FILE}")
    if len(set(nodes)) < len(nodes):
        raise WrongValueError("a node is named twice in `nodes`; name each once, with the sum of its forces")
    if len(forces) not in (1, len(nodes)):
        text = "give a force for each node, or a single one for all of them"
        raise WrongValueError(f"there are {len(nodes)} nodes and {len(forces)} forces; {text}")
    if not any(component for force in forces for component in force):
        raise WrongValueError("all forces of the load are zero; leave it out")
    return NodalLoad("", **{**given, "forces": tuple(forces) * (len(nodes) // len(forces))})


declare(
    NodalLoad,
    "NodalLoadTable",
    make=lambda **given: _nodal_load(**{key: value for key, value in given.items() if key != "name"}),
)
NOT_IN_SCENES = ("gravity", "markers", "start", "lowering")
"""The keys of a body of nodes alone that a body in a scene does not have."""
_OF_NODES = tuple(key for key in NODAL_KEYS if key.name not in NOT_IN_SCENES)
FLEXIBLE_MODEL = keyed_model(
    "FlexibleTable",
    "A finite-element body in a scene in space.",
    (*_OF_NODES, *declared_keys(FlexibleBody), COUNT),
    tables=TABLES,
)


def flexible_body(name: str, table: Any, data: NodeData) -> FlexibleBody:
    """The finite-element body that a table describes, with its data."""
    given = {key.field: getattr(table, key.name, None) for key in NODAL_KEYS if key.name not in ("nodes", "units")}
    own = nodal_keys(given, data, {"gravity": None, "markers": (), "start": AT_REST, "lowering": "auto"})
    rigid = tuple(marker.nodes for marker in table.markers if marker.motion == "rigid")
    return FlexibleBody(
        name, NodalBody(name=name, data=data, rigid_sets=rigid, **own), table.markers, table.start, table.loads
    )


SPATIAL_RIGID = declare(
    SpatialRigidBody, "SpatialRigidTable", keys=(*declared_keys(SpatialRigidBody), COUNT), check=_check_inertia
)

OF_KIND = ("removes", "distance", "pitch")
"""The fields of a joint in space that are keys of some kinds alone."""


def spatial_joint_table() -> DeclaredTable:
    """The table of a joint in space, with the kinds and keys of all joints that are registered now."""
    keys = tuple(key for key in declared_keys(SpatialJoint) if key.field not in OF_KIND)
    types = (*SPATIAL_JOINTS.items(),)
    return registered_table("SpatialJointTable", SpatialJoint.__doc__ or "", "joint", types, (*keys, COUNT), _joint)


def _joint(kind: str, own: Mapping[str, Any], given: dict[str, Any]) -> SpatialJoint:
    first, second = own["first"]
    return SpatialJoint("", kind, first, second, start=own["start"], **given)


declare(Gear, "GearTable", keys=(*declared_keys(Gear), COUNT))


def _at_marker_or_in_joint(at_marker: type, in_joint: type) -> DeclaredTable:
    """The table of a load at a marker, or of one in a joint, which has the key `joint`."""
    own, of_joint = (
        declare(of, f"{of.__name__}Table", keys=(*declared_keys(of), COUNT)) for of in (at_marker, in_joint)
    )
    return DeclaredTable(own.model, one_of(_kind_of_load, marker=own.value, joint=of_joint.value))


def _kind_of_load(value: Any) -> str:
    return "joint" if isinstance(value, Mapping) and "joint" in value else "marker"


SPATIAL_FORCE = _at_marker_or_in_joint(SpatialForce, SpatialJointForce)
SPATIAL_TORQUE = _at_marker_or_in_joint(SpatialTorque, SpatialJointTorque)


def spatial_spring_table() -> DeclaredTable:
    """The table of a spring in space, with the kinds that are registered now, or of a bushing."""
    keys = tuple(key for key in declared_keys(SpatialSpring) if key.type is KeyType.MARKER_PAIR)
    doc = SpatialSpring.__doc__ or ""
    springs = (*SPATIAL_SPRINGS.items(),)
    own = registered_table("SpatialSpringTable", doc, "spring", springs, (*keys, COUNT), _spring, "linear")
    bushings = (*SPATIAL_BUSHINGS.items(),)
    bushing = registered_table("SpatialBushingTable", doc, "bushing", bushings, (*keys, COUNT), _spring)
    return DeclaredTable(own.model, one_of(_kind_of_spring, spring=own.value, bushing=bushing.value))


def _kind_of_spring(value: Any) -> str:
    return "bushing" if isinstance(value, Mapping) and value.get("kind") in SPATIAL_BUSHINGS else "spring"


def _spring(kind: str, own: Mapping[str, Any], given: dict[str, Any]) -> SpatialSpring:
    first, second = own["first"]
    return SpatialSpring("", kind, first, second, given)


def spatial_output_table() -> DeclaredTable:
    """The table of an output in space, with the kinds that are registered now."""
    kinds = (*SPATIAL_OUTPUTS.items(),)
    return registered_table("SpatialOutputTable", SceneOutput.__doc__ or "", "output", kinds, (COUNT,), _output)


def _output(kind: str, own: Mapping[str, Any], given: dict[str, Any]) -> SceneOutput:
    return SceneOutput("", kind, given)


_OF_SCENE = {key.field: key for key in declared_keys(SpatialScene)}
SPATIAL_GROUND_TABLE = keyed_model(
    "SpatialGroundTable", "The inertial frame, which does not move.", (replace(_OF_SCENE["ground"], name="markers"),)
)
SPATIAL_SCENE_TABLE = keyed_model(
    "SpatialSceneTable",
    "Gravity, initial state, lowering and redundant joints of a scene in space.",
    tuple(_OF_SCENE[name] for name in ("gravity", "start", "lowering", "redundant")),
)


def spatial_specification_table() -> type[TomlTable]:
    """The table of a whole specification of a scene in space, with the joints that are registered now."""
    return _spatial_specification_table(
        (
            (SpatialJoint, spatial_joint_table()),
            (SpatialForce, SPATIAL_FORCE),
            (SpatialTorque, SPATIAL_TORQUE),
            (SpatialSpring, spatial_spring_table()),
            (SceneOutput, spatial_output_table()),
            (Plot, PLOT),
        )
    )


@cache
def _spatial_specification_table(elements: tuple[tuple[type, DeclaredTable], ...]) -> type[TomlTable]:
    tables = {**TABLES, **dict(elements)}

    def section(name: str) -> Any:
        match name:
            case "ground":
                return SPATIAL_GROUND_TABLE | None, None
            case "scene":
                return SPATIAL_SCENE_TABLE | None, None
            case "bodies":
                return _bodies() | None, None
            case "simulation":
                return SIMULATION.value | None, None
            case _ if name in OTHER_SECTIONS:
                return OTHER_SECTIONS[name], {}
            case _:
                return key_field(_OF_SCENE[name], False, tables)

    of_scene = (*SCENE, "gears", "simulation", "plots")
    names = (name for name in of_scene if name in _OF_SCENE or name in _WRITTEN)
    sections: dict[str, Any] = {name: section(name) for name in names}
    doc = "A specification for Tisserand: a scene of bodies in space."
    return keyed_model("SpatialSpecificationTable", doc, (), SpecificationKeys, others=sections)


_WRITTEN = ("ground", "scene", "bodies", "simulation", *OTHER_SECTIONS)


def _bodies() -> Any:
    body = one_of(kind_of_spatial_body, rigid=SPATIAL_RIGID.value, flexible=FLEXIBLE_MODEL)
    bodies = by_name(body, "bodies", "[bodies.rod]", ElementName, minProperties=1)
    return Annotated[bodies, Field(description="Bodies of a scene in space by name: rigid, or finite elements.")]


def kind_of_spatial_body(value: Any) -> str:
    """The kind of body that a table describes: a discriminator."""
    return "flexible" if isinstance(value, Mapping) and ("nodes" in value or "modes" in value) else "rigid"


def spatial_scene(table: Any, references: Mapping[str, Rows], nodes: Mapping[str, NodeData]) -> SpatialScene:
    """The scene in space that a table describes.

    references: the numbers of plots with a reference. nodes: the data of finite-element bodies by their names.
    """
    sections: dict[str, Any] = {section: getattr(table, section, ()) for section in NAMED}
    sections["bodies"] = tuple(
        flexible_body(name, body, nodes[name]) if name in nodes else replace(body, name=name)
        for name, body in table.bodies.items()
    )
    sections["drives"] = tuple(with_spatial_speed_unit(drive, table.joints) for drive in table.drives)
    sections["plots"] = plots(table, references)
    chosen = {} if table.scene is None else {key: getattr(table.scene, key) for key in CHOSEN}
    return SpatialScene(
        name=table.name,
        ground=() if table.ground is None else table.ground.markers,
        simulation=table.simulation,
        **{"gravity": None, **chosen},
        **sections,
    )


CHOSEN = ("gravity", "start", "lowering", "redundant")
"""The keys of the section `scene`."""


def with_spatial_speed_unit(drive: Drive, joints: tuple[SpatialJoint, ...]) -> Drive:
    """The drive with the unit of its speed, where that is a parameter without a unit."""
    if not isinstance(drive.speed, Parameter) or drive.speed.unit:
        return drive
    (kind,) = (joint.kind for joint in joints if joint.name == drive.joint)
    driven = SPATIAL_JOINTS[kind].driven
    return replace(drive, speed=replace(drive.speed, unit=f"{driven.unit}/s" if driven else ""))
