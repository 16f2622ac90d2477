"""The tables of bodies of a scene in space: their markers, initial values and loads, rigid and finite-element ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any

from pydantic import Field

from derive.spec.model.body import NodalBody
from derive.spec.model.instances import COUNT
from derive.spec.model.keys import KeyType, declared_keys
from derive.spec.model.node_data import NodeData
from derive.spec.model.simulation import AT_REST
from derive.spec.model.spatial_beam import OF_BEAM, OF_BEAM_IN_SPACE
from derive.spec.model.spatial_bodies import FlexibleBody, FrameMarker, NodalLoad, NodeFrame, SpatialRigidBody
from derive.spec.model.spatial_start import OF_BENT_BEAMS, SpatialInitialValues
from derive.spec.model.visuals import NO_SCALE, Visual
from derive.spec.parsing.values import WrongValueError
from derive.spec.tables.body import NODAL_KEYS, interface_markers, nodal_keys, node_set
from derive.spec.tables.declared_tables import TABLES, declare, keyed_model
from derive.spec.tables.inertia_tensor import check_tensor
from derive.spec.tables.shared import ElementName, by_name, one_of
from derive.spec.tables.spatial_beam import beam_in_space
from derive.spec.tables.value_types import COORDINATE_TRIPLE, VALUE_TYPES, markers_type, several_type

_of_body = tuple(key for key in declared_keys(SpatialInitialValues) if key.name not in OF_BENT_BEAMS)
declare(SpatialInitialValues, "SpatialInitialValuesTable", keys=_of_body)
FRAME = declare(
    FrameMarker, "FrameMarkerTable", plain=COORDINATE_TRIPLE, doc="A marker frame: its point and its rotation."
)


def _frame(name: str, at: Any) -> FrameMarker:
    return replace(at, name=name) if isinstance(at, FrameMarker) else FrameMarker(name, at)


VALUE_TYPES[KeyType.FRAMES] = markers_type(FRAME.value, "coordinates", _frame)


def _check_inertia(body: SpatialRigidBody) -> None:
    if body.inertia is not None:
        check_tensor(body.inertia)


def _node_frame(node: Any = None, nodes: Any = (), **given: Any) -> NodeFrame:
    """A marker of a finite-element body. Raises WrongValueError for what does not go together."""
    node_set = given.pop("set", None) or ""
    if (node is not None) + bool(nodes) + bool(node_set) != 1:
        text = "a marker is at a node, node = 17, or at a set of nodes, nodes = [17, 18, 30, 31]"
        raise WrongValueError(f'{text}, or set = "left" of the file')
    if node_set:
        if given.get("weights"):
            raise WrongValueError(
                "the faces of elements weigh the nodes of a set of the file; list nodes that have weights of their own"
            )
        return NodeFrame("", (), node_set=node_set, **given)
    if given.get("motion", "mean") == "rigid" and node is not None:
        raise WrongValueError('a single node has no rotation; a rigid set, motion = "rigid", needs nodes = [..]')
    own = (node,) if node is not None else tuple(nodes)
    if len(set(own)) < len(own):
        raise WrongValueError("a node is named twice in `nodes`; name each once, with a weight of its own")
    if given.get("weights") and len(given["weights"]) != len(own):
        raise WrongValueError(f"there are {len(own)} nodes and {len(given['weights'])} weights; give a weight for each")
    if node is None and len(own) < LEAST_NODES:
        single = own[0] if own else 17
        raise WrongValueError(
            f"a set of nodes needs three, not on a line, to have a rotation; or write node = {single}"
        )
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
    markers = tuple(_with_nodes(marker, data) for marker in table.markers)
    rigid = tuple(marker.nodes for marker in markers if marker.motion == "rigid")
    held = interface_markers(own["interface"], markers, data)
    loaded = {node for element in (*markers, *table.loads) for node in element.nodes}
    nodal = NodalBody(name=name, data=data, rigid_sets=rigid, interface_markers=held, **own)
    if nodal.computes_geometric_stiffness:
        nodal = replace(nodal, loaded_nodes=tuple(sorted(loaded)))
    return FlexibleBody(name, nodal, markers, table.start, table.loads)


def _with_nodes(marker: NodeFrame, data: NodeData) -> NodeFrame:
    """A marker with the nodes of its set, which `marker_set_faults` has checked."""
    return replace(marker, nodes=node_set(data, marker.node_set)) if marker.node_set else marker


MAX_VISUALS = 256
FORMS = ("mesh", "box", "cylinder", "sphere")
"""The keys of a visual of which one is given."""


def _check_visual(visual: Visual) -> None:
    forms = [name for name in FORMS if getattr(visual, name) is not None]
    if len(forms) != 1:
        given = f"and not {' and '.join(forms)}" if forms else "such as { box = [0.1, 0.2, 0.3] }"
        raise WrongValueError(f"a visual is one of {', '.join(FORMS)}, {given}")
    if not all(size > 0 for size in (*(visual.box or ()), *(visual.cylinder or ()))):
        raise WrongValueError(f"the sizes of a {forms[0]} are positive")
    if not all(visual.scale) or (visual.scale != NO_SCALE and visual.mesh is None):
        raise WrongValueError("`scale` has the factors of a mesh, which are not zero; boxes and the like have sizes")


VISUAL = declare(Visual, "VisualTable", check=_check_visual)
VALUE_TYPES[KeyType.VISUALS] = several_type(
    VISUAL.value, 0, MAX_VISUALS, "visuals", "tables is needed, such as [{ box = [0.1, 0.2, 0.3] }]"
)
SPATIAL_RIGID = declare(
    SpatialRigidBody, "SpatialRigidTable", keys=(*declared_keys(SpatialRigidBody), COUNT), check=_check_inertia
)


BEAM_IN_SPACE = beam_in_space()


def bodies_in_space() -> Any:
    """The type of the bodies of a scene in space by their names."""
    body = one_of(kind_of_spatial_body, rigid=SPATIAL_RIGID.value, flexible=FLEXIBLE_MODEL, beam=BEAM_IN_SPACE.value)
    bodies = by_name(body, "bodies", "[bodies.rod]", ElementName, minProperties=1)
    return Annotated[bodies, Field(description="Bodies of a scene in space by name: rigid, finite elements, or beams.")]


def kind_of_spatial_body(value: Any) -> str:
    """The kind of body that a table describes: a discriminator."""
    if not isinstance(value, Mapping):
        return "rigid"
    if "nodes" in value or "modes" in value:
        return "flexible"
    return "beam" if any(key in value for key in (*OF_BEAM, *OF_BEAM_IN_SPACE)) else "rigid"
