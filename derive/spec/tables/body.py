"""The tables of a body in space: made of nodes, or with parameters for all its integrals."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Any

from pydantic import PlainValidator, WithJsonSchema

from derive.spec.model.body import BodyFrame, Damping, DisplacementOrder, NodalBody, SymbolicBody
from derive.spec.model.keys import KeyType, declared_keys, key
from derive.spec.model.mode_selection import ModeSelection
from derive.spec.model.node_data import NodeData
from derive.spec.model.node_markers import InterfaceMarker, NodeMarker
from derive.spec.model.simulation import SpatialStart
from derive.spec.model.spatial_bodies import NodeFrame
from derive.spec.parsing import choices
from derive.spec.parsing.values import WrongValueError
from derive.spec.tables.beam import DAMPING
from derive.spec.tables.declared_tables import TABLES, declare
from derive.spec.tables.shared import TomlTable, one_of
from derive.spec.tables.value_types import VALUE_TYPES

_POINT = (
    "a point frame needs the node it is at, and turns with those in `around`, or with its nearest neighbours: "
    '{ kind = "point", node = 12, around = [3, 4, 5] }'
)


def _check_frame(frame: BodyFrame) -> None:
    """Refuse a kind and nodes that do not go together."""
    if frame.kind == "point":
        if frame.node is None:
            raise WrongValueError(_POINT)
        if len({frame.node, *frame.around}) <= len(frame.around):
            raise WrongValueError("a node is named twice; `node` and those in `around` have to differ")
    elif frame.node is not None or frame.around:
        raise WrongValueError(f'the frame "{frame.kind}" is at no node; leave `node` and `around` out')


def _plain_frame(value: object) -> BodyFrame:
    kind = choices.body_frame_kind(value)
    if kind == "point":
        raise WrongValueError(_POINT)
    return BodyFrame(kind)


declare(
    BodyFrame,
    "BodyFrameTable",
    check=_check_frame,
    plain=Annotated[BodyFrame, PlainValidator(_plain_frame), WithJsonSchema({"enum": ["mean", "given"]})],
    doc="The kind of the floating frame of a body, and its nodes.",
)
declare(SpatialStart, "SpatialStartTable")
declare(ModeSelection, "ModeSelectionTable", plain=VALUE_TYPES[KeyType.MODE_COUNT])

_keys = {key.name: key for key in declared_keys(NodalBody)}
_first = tuple(
    _keys.pop(name)
    for name in ("nodes", "units", "modes", "component_modes", "interface", "frame", "orthonormal", "order")
)
_last = tuple(_keys.pop(name) for name in ("markers", "start"))
NODAL_KEYS = (*_first, *_keys.values(), *_last)
NODAL = declare(NodalBody, "NodalTable", keys=NODAL_KEYS, tables={**TABLES, Damping: DAMPING})
_integrals = key(
    KeyType.CHOICE,
    "Makes mass, shape integrals and stiffness run-time parameters.",
    name="integrals",
    required=True,
    choices=("symbolic",),
)
SYMBOLIC = declare(SymbolicBody, "SymbolicTable", keys=(_integrals, *declared_keys(SymbolicBody)))


def nodal_body(table: TomlTable, data: NodeData, **others: Any) -> NodalBody:
    """The body of the nodes whose data have been read; `others` are its name, its simulation and its plots."""
    given = {key.field: getattr(table, key.name) for key in NODAL_KEYS if key.name not in ("nodes", "units")}
    markers = interface_markers(given["interface"], given["markers"], data)
    return NodalBody(data=data, interface_markers=markers, **nodal_keys(given, data, {}), **others)


def nodal_keys(given: Mapping[str, Any], data: NodeData, others: Mapping[str, Any]) -> dict[str, Any]:
    """The fields of a body of nodes from the values of its keys, whose defaults depend on the data."""
    result = {**given, **others}
    if result["interface"] and result["component_modes"] is None:
        result["component_modes"] = "craig_bampton"
    given_modes = data.modes is not None and result["component_modes"] is None
    if given_modes and data.has_geometric_stiffness:
        second_order = result["order"] != 1
    else:
        second_order = result["order"] == 2 and data.gives_geometric_stiffness
    if result["orthonormal"] is None:
        result["orthonormal"] = result["frame"].kind == "mean" or not given_modes
    result["order"] = DisplacementOrder.TRUNCATED if second_order else DisplacementOrder.FIRST_ORDER
    result["damping"] = result["damping"] or Damping()
    return result


def interface_markers(
    names: tuple[str, ...], markers: Iterable[NodeMarker | NodeFrame], data: NodeData
) -> tuple[InterfaceMarker, ...]:
    """The markers of the interface, or sets of the file, with their nodes; `component_mode_faults` has checked them."""
    of_name = {marker.name: InterfaceMarker(marker.name, marker.nodes, marker.weights) for marker in markers}
    return tuple(of_name[name] if name in of_name else InterfaceMarker(name, node_set(data, name)) for name in names)


def node_set(data: NodeData, name: str) -> tuple[int, ...]:
    """The nodes of a set of the file."""
    return tuple(data.mesh.node_sets[name].tolist()) if data.mesh else ()


def kind_of_body(value: Any) -> str:
    """The kind of body that a table describes: a discriminator."""
    return "symbolic" if isinstance(value, Mapping) and "integrals" in value else "nodal"


BodyInput = one_of(kind_of_body, nodal=NODAL.model, symbolic=SYMBOLIC.value)
"""The type of a body in space: of nodes, which are read afterwards, its table; otherwise the body."""
