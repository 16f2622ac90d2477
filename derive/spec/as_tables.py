"""Specifications built in Python as the tables that a TOML file would hold, so that both pass the same checks.

The keys of a frozen type are those that it declares; the types whose tables are otherwise are in `_SPECIAL`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from typing import Any, assert_never

from derive.errors import Problem, SpecError, quoted
from derive.mechanics.multibody.forces.registry import FORCES
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import Marker
from derive.spec.model.body import DisplacementOrder, NodalBody, SymbolicBody
from derive.spec.model.forces import Bushing, CustomForce, Spring
from derive.spec.model.joints import CustomJoint, Joint
from derive.spec.model.keys import Key, KeyType, declared_keys, has_name
from derive.spec.model.markers import MarkerRef, PointMarker
from derive.spec.model.node_data import NodeData
from derive.spec.model.node_markers import NodeMarker
from derive.spec.model.planar_bodies import BeamBody, CustomBody
from derive.spec.model.plots import Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene import NAMED, Scene
from derive.spec.model.scene_functions import function_parameters, input_functions, time_functions
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_beam_parts import SectionFrame
from derive.spec.model.spatial_bodies import FlexibleBody, FrameMarker, NodeFrame
from derive.spec.model.spatial_forces import SpatialSpring
from derive.spec.model.spatial_scene import SpatialJoint, SpatialScene
from derive.spec.model.spatial_start import NO_ROTATION
from derive.spec.model.specification import AnyScene, Specification
from derive.spec.model.time_function import TimeFunction
from derive.spec.model.visuals import Mesh

Data = dict[str, Any]


def specification_tables(spec: Specification) -> Data:
    """The tables of a whole specification."""
    if isinstance(spec, (Scene, SpatialScene)):
        return scene_tables(spec)
    others = without_none(simulation=as_table(spec.simulation), plots=named("plots", spec.plots) or None)
    return {"name": spec.name, spec.section: as_table(spec), **others}


CHOSEN = ("lowering", "redundant", "coordinates")
"""The keys of the section `scene` that are written where they are not the default."""


def scene_tables(scene: AnyScene) -> Data:
    """The tables of a scene. Raises SpecError where two elements of one kind have the same name."""
    ground: Data = {"markers": named("ground", scene.ground)}
    if isinstance(scene, SpatialScene) and scene.ground_visuals:
        ground["visuals"] = as_table(scene.ground_visuals)
    tables: Data = {"name": scene.name, "ground": ground}
    of_type: type = type(scene)
    keys = [of for of in declared_keys(of_type) if of.field in CHOSEN]
    chosen = {of.field: value for of in keys if (value := getattr(scene, of.field)) != of.default}
    if of_scene := without_none(gravity=as_table(scene.gravity), start=scene.start, **chosen):
        tables["scene"] = of_scene
    functions = (function for _, function in (*time_functions(scene), *input_functions(scene)))
    if parameters := {p.symbol: p for function in functions for p in function_parameters(function)}:
        tables["parameters"] = {
            name: without_none(default=p.default, unit=p.unit or None) for name, p in parameters.items()
        }
    for kind in NAMED:
        if elements := getattr(scene, kind, ()):
            tables[kind] = named(kind, elements)
    if scene.simulation is not None:
        tables["simulation"] = as_table(scene.simulation)
    return tables


_OTHERS = {
    "ground": ("ground.markers", "marker"),
    "masses": ("beam.masses", "attached mass"),
    "markers": ("markers", "marker of the body"),
    "loads": ("loads", "load of the body"),
}
"""The tables with named elements besides those of a scene, with the noun for one element."""


def named(kind: str, elements: Any) -> Any:
    """Elements with names, given as a mapping or as a sequence of typed values, as one table.

    Anything else stays what it is, for the checks to refuse. Raises SpecError where two elements have the same name.
    """
    if not isinstance(elements, (list, tuple)) or not all(has_name(type(element)) for element in elements):
        return as_table(elements)
    tables: Data = {}
    for element in elements:
        if element.name in tables:
            path, what = _OTHERS[kind] if kind in _OTHERS else (kind, NAMED[kind])
            text = f"{quoted(element.name)} is taken by another {what}"
            raise SpecError((Problem(f"{path}.{element.name}", f"{text}; names must differ in more than case"),))
        tables[element.name] = as_table(element)
    return tables


def as_table(value: Any) -> Any:
    """A value in the form that a table has; tables and sequences are converted with all their elements."""
    if (special := _SPECIAL.get(type(value))) is not None:
        return special(value)
    if isinstance(value, Mapping):
        return {key: as_table(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return type(value)(as_table(item) for item in value)
    return _declared(value) if _declares_keys(type(value)) else value


def _declares_keys(of: type) -> bool:
    return is_dataclass(of) and bool(declared_keys(of))


def without_none(**keys: object) -> Data:
    """The entries whose value is not None."""
    return {key: value for key, value in keys.items() if value is not None}


def _declared(of: Any) -> Data:
    """The table of the keys that a frozen type declares, without those that have no value."""
    defaults = {field.name: field.default for field in fields(of)}
    of_type: type = type(of)
    keys = (key for key in declared_keys(of_type) if key.field in defaults)
    return without_none(**{key.name: _written(key, of, defaults[key.field]) for key in keys})


def _written(key: Key, of: Any, default: object) -> Any:
    """The value of a key in a table; None if there is none, and for zeros and the like that the key has by default."""
    value = getattr(of, key.field)
    if key.type is KeyType.MARKER_PAIR:
        return [*as_table(value if isinstance(value, tuple) else (of.first, of.second))]
    if key.has_names and isinstance(value, (list, tuple)):
        return named(key.name, value)
    if value == default and (not value or key.type is KeyType.DIRECTION):
        return None
    table = as_table(value)
    return None if table == {} and key.default is None else table


def _beam(beam: PlanarBeam) -> Data:
    return {**_declared(beam), "orthogonal": beam.orthogonal, "order": 1, **_order(beam.order)}


def _frame_marker(marker: FrameMarker) -> Any:
    at = [*as_table(marker.position)]
    return at if marker.rotation == NO_ROTATION else {"at": at, "rotation": [*marker.rotation]}


def _section_frame(marker: SectionFrame) -> Any:
    at = as_table(marker.at)
    return at if marker.rotation == NO_ROTATION else {"at": at, "rotation": [*marker.rotation]}


def _order(order: DisplacementOrder) -> Data:
    match order:
        case DisplacementOrder.FIRST_ORDER:
            return {}
        case DisplacementOrder.TRUNCATED:
            return {"order": 2, "terms": "truncated"}
        case DisplacementOrder.FULL:
            return {"order": 2, "terms": "full"}
        case _ as never:
            assert_never(never)


def _nodal_body(body: NodalBody) -> Data:
    table = {"units": "SI", **_declared(body)}
    stated = body.second_order or body.data.has_geometric_stiffness
    order = (2 if body.second_order else 1) if stated else None
    return without_none(**{**table, "order": order})


def _flexible_body(body: FlexibleBody) -> Data:
    """The table of a finite-element body in a scene: that of its nodes without what bodies alone have."""
    alone = ("gravity", "markers", "start", "lowering")
    table = {key: value for key, value in _nodal_body(body.body).items() if key not in alone}
    return {**table, **_declared(body)}


def _node_frame(marker: NodeFrame) -> Data:
    own: Data = {"nodes": [*marker.nodes]} if marker.has_rotation else {"node": marker.nodes[0]}
    if marker.motion != "mean":
        own["motion"] = marker.motion
    if marker.weights:
        own["weights"] = [*marker.weights]
    return own if marker.rotation == NO_ROTATION else {**own, "rotation": [*marker.rotation]}


def _of_kind(element: Joint | SpatialJoint | Spring | Bushing) -> Data:
    values = element.values if isinstance(element, CustomJoint) else {}
    return {"kind": element.kind, **_declared(element), **as_table(values)}


def _custom_force(force: CustomForce) -> Data:
    markers: Data
    match FORCES[force.kind].section:
        case "springs":
            markers = {"between": [*force.markers]}
        case _:
            markers = dict(zip(("at", "against"), force.markers, strict=False))
    return {"kind": force.kind, **as_table({**markers, **force.values})}


_SPECIAL: Mapping[type, Callable[[Any], Any]] = {
    Parameter: lambda of: without_none(symbol=of.symbol, unit=of.unit or None, default=of.default),
    TimeFunction: lambda function: {"input": function.name} if function.kind == "input" else function,
    NodeData: lambda data: data,
    Mesh: lambda mesh: mesh,
    Marker: lambda marker: as_table(marker.at),
    NodeMarker: lambda marker: marker.node,
    PointMarker: lambda marker: [as_table(marker.x), as_table(marker.y)],
    MarkerRef: str,
    PlanarBeam: _beam,
    NodalBody: _nodal_body,
    SymbolicBody: lambda body: {"integrals": "symbolic", **_declared(body)},
    BeamBody: lambda body: {**_beam(body.beam), **_declared(body)},
    CustomBody: lambda body: {**as_table(body.values), **_declared(body)},
    FrameMarker: _frame_marker,
    FlexibleBody: _flexible_body,
    NodeFrame: _node_frame,
    SectionFrame: _section_frame,
    SpatialBeam: lambda beam: {**_declared(beam), "orthogonal": beam.orthogonal, "order": 1, **_order(beam.order)},
    SpatialJoint: _of_kind,
    SpatialSpring: lambda s: {"kind": s.kind, "between": [str(s.first), str(s.second)], **as_table(s.values)},
    Joint: _of_kind,
    CustomJoint: _of_kind,
    Spring: _of_kind,
    Bushing: _of_kind,
    CustomForce: _custom_force,
    SceneOutput: lambda output: {"kind": output.kind, **as_table(output.values)},
    Plot: lambda plot: {**_declared(plot.quantity), **_declared(plot)},
}
"""The functions from values to tables for the types whose keys are not those that they declare."""
