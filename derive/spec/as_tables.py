"""Specifications built in Python as the tables that a TOML file would hold, so that both pass the same checks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict
from typing import Any, assert_never

from derive.errors import Problem, SpecError, quoted
from derive.mechanics.multibody.forces.registry import FORCES
from derive.spec.model.body import (
    AttachedMass,
    AxialDeformation,
    BeamDamping,
    BodyFrame,
    Damping,
    DisplacementOrder,
    Frame,
    Marker,
    NodalBody,
    NodeMarker,
    PlanarBeam,
    ShapeFamily,
    SymbolicBody,
)
from derive.spec.model.forces import Bushing, CustomForce, Force, Spring, Torque
from derive.spec.model.markers import MarkerRef, PointMarker
from derive.spec.model.plots import ColumnCurves, Plot, ReferenceCurve
from derive.spec.model.ports import SceneOutput
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene import (
    NAMED,
    BeamBody,
    CustomBody,
    CustomJoint,
    DistributedLoad,
    Drive,
    Joint,
    JointInitialValues,
    RigidBody,
    Scene,
    SceneInput,
    Specification,
)
from derive.spec.model.scene_functions import function_parameters, input_functions, time_functions
from derive.spec.model.simulation import InitialValues, Simulation, SpatialStart
from derive.spec.model.time_function import TimeFunction

Data = dict[str, object]


def specification_tables(spec: Specification) -> Data:
    """The tables of a whole specification."""
    if isinstance(spec, Scene):
        return scene_tables(spec)
    kind = "beam" if isinstance(spec, PlanarBeam) else "body"
    simulation, plots = (None, ()) if isinstance(spec, SymbolicBody) else (spec.simulation, spec.plots)
    drawn = named("plots", plots) or None
    return {"name": spec.name, kind: as_table(spec), **without_none(simulation=as_table(simulation), plots=drawn)}


def scene_tables(scene: Scene) -> Data:
    """The tables of a scene. Raises SpecError where two elements of one kind have the same name."""
    tables: Data = {"name": scene.name, "ground": {"markers": named("ground", scene.ground)}}
    if scene.gravity is not None or scene.start is not None:
        tables["scene"] = without_none(gravity=as_table(scene.gravity), start=scene.start)
    functions = (function for _, function in (*time_functions(scene), *input_functions(scene)))
    if parameters := {p.symbol: p for function in functions for p in function_parameters(function)}:
        tables["parameters"] = {name: _function_parameter(p) for name, p in parameters.items()}
    for kind in NAMED:
        if elements := getattr(scene, kind):
            tables[kind] = named(kind, elements)
    if scene.simulation is not None:
        tables["simulation"] = as_table(scene.simulation)
    return tables


_OTHERS = {"ground": ("ground.markers", "marker"), "masses": ("beam.masses", "attached mass")}
"""The tables with named elements besides those of a scene, with the noun for one element."""


def named(kind: str, elements: Any) -> Any:
    """Elements with names, given as a mapping or as a sequence of typed values, as one table.

    Anything else stays what it is, for the checks to refuse. Raises SpecError where two elements have the same name.
    """
    if not isinstance(elements, (list, tuple)) or not all(type(element) in _CONVERT for element in elements):
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
    if isinstance(value, TimeFunction):
        return {"input": value.name} if value.kind == "input" else value
    convert = _CONVERT.get(type(value))
    if convert is not None:
        return as_table(convert(value))
    if isinstance(value, Mapping):
        return {key: as_table(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return type(value)(as_table(item) for item in value)
    return value


def without_none(**keys: object) -> Data:
    """The entries whose value is not None."""
    return {key: value for key, value in keys.items() if value is not None}


def _markers(markers: Iterable[Marker | NodeMarker | PointMarker]) -> Data:
    return {marker.name: as_table(marker) for marker in markers}


def _beam(beam: PlanarBeam) -> Data:
    return without_none(
        ansatz=beam.ansatz,
        frame=beam.frame,
        orthogonal=beam.orthogonal,
        ends=beam.ends,
        mass=beam.mass,
        length=beam.length,
        bending_stiffness=beam.bending_stiffness,
        markers=_markers(beam.markers),
        gravity=beam.gravity,
        start=beam.start,
        axial=as_table(beam.axial),
        damping=as_table(beam.damping),
        masses={mass.name: mass for mass in beam.masses} or None,
        **_order(beam.order),
    )


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
    return without_none(
        nodes=body.data,
        units="SI",
        modes=body.modes,
        frame=body.frame,
        orthonormal=body.orthonormal,
        damping=as_table(body.damping),
        gravity=body.gravity,
        lowering=body.lowering,
        markers=_markers(body.markers),
        start=body.start,
        order=(2 if body.second_order else 1) if body.data.has_geometric_stiffness else None,
    )


def _spatial_start(start: SpatialStart) -> Data:
    keys = asdict(start)
    return {"rotation": keys.pop("quaternion"), **keys}


def _symbolic_body(body: SymbolicBody) -> Data:
    return without_none(
        integrals="symbolic",
        modes=body.modes,
        frame=body.frame,
        damping=body.damping,
        gravity=body.gravity,
        lowering=body.lowering,
    )


def _rigid_body(body: RigidBody) -> Data:
    return without_none(
        mass=body.mass,
        inertia=body.inertia,
        centre=body.centre,
        markers=_markers(body.markers),
        start=body.start,
        keep_coordinates=body.keep_coordinates,
    )


def _joint(joint: Joint) -> Data:
    default = Joint(joint.name, joint.kind, joint.first, joint.second)
    return without_none(
        kind=joint.kind,
        between=[joint.first, joint.second],
        angle=joint.angle if joint.angle != default.angle else None,
        axis=joint.axis if joint.axis != default.axis else None,
        start=joint.start,
        **(joint.values if isinstance(joint, CustomJoint) else {}),
    )


def _function_parameter(parameter: Parameter) -> Data:
    return without_none(default=parameter.default, unit=parameter.unit or None)


def _spring(spring: Spring | Bushing) -> Data:
    values = FORCES[spring.kind].specified(spring)
    given = {key: value for key, value in values.items() if key == "stiffness" or value}
    return {"kind": spring.kind, "between": [spring.first, spring.second], **given}


def _custom_force(force: CustomForce) -> Data:
    markers: Data
    match FORCES[force.kind].section:
        case "springs":
            markers = {"between": [*force.markers]}
        case _:
            markers = dict(zip(("at", "against"), force.markers, strict=False))
    return {"kind": force.kind, **markers, **force.values}


def _plot(plot: Plot) -> Data:
    quantity = plot.quantity
    keys: Data
    if isinstance(quantity, ColumnCurves):
        keys = {"x": quantity.x, "y": list(quantity.y)}
    else:
        keys = {"deflection": quantity.marker, "chord": [*quantity.chord], "divided_by": quantity.divided_by}
    return without_none(
        **keys,
        over=plot.over,
        cut=plot.cut,
        pieces=plot.pieces or None,
        reference=plot.reference,
    )


_CONVERT: Mapping[type, Callable[[Any], object]] = {
    Parameter: asdict,
    ShapeFamily: lambda family: {"kind": family.kind, "count": family.count},
    Frame: lambda frame: without_none(kind=frame.kind, at=frame.at),
    BodyFrame: lambda frame: without_none(kind=frame.kind, node=frame.node, around=frame.around or None),
    Damping: lambda damping: {key: value for key, value in asdict(damping).items() if value} or None,
    BeamDamping: lambda damping: {key: value for key, value in vars(damping).items() if value} or None,
    AxialDeformation: lambda axial: without_none(
        ansatz=axial.ansatz, stiffness=axial.stiffness, preload=axial.preload or None
    ),
    AttachedMass: lambda mass: without_none(at=mass.at, mass=mass.mass, inertia=mass.inertia or None),
    Marker: lambda marker: marker.at,
    NodeMarker: lambda marker: marker.node,
    PointMarker: lambda marker: [marker.x, marker.y],
    MarkerRef: str,
    PlanarBeam: _beam,
    NodalBody: _nodal_body,
    SymbolicBody: _symbolic_body,
    RigidBody: _rigid_body,
    BeamBody: lambda body: {
        **_beam(body.beam),
        "pieces": body.pieces,
        "start": body.start,
        **({"loads": {load.name: load for load in body.loads}} if body.loads else {}),
    },
    DistributedLoad: lambda load: {"force": load.force, "time": load.time, "frame": load.frame},
    CustomBody: lambda body: {**body.values, "markers": _markers(body.markers), "start": body.start},
    InitialValues: lambda start: without_none(**{**asdict(start), "guess": start.guess or None}),
    JointInitialValues: lambda start: without_none(**{**asdict(start), "guess": start.guess or None}),
    Joint: _joint,
    CustomJoint: _joint,
    Drive: lambda drive: without_none(
        joint=drive.joint, motion=drive.motion, speed=drive.speed, offset=drive.offset or None, start=drive.start
    ),
    Force: lambda force: without_none(
        at=force.at, components=force.components, frame=None if force.frame == "inertial" else force.frame
    ),
    Torque: lambda torque: without_none(at=torque.at, value=torque.value, against=torque.against),
    Spring: _spring,
    Bushing: _spring,
    CustomForce: _custom_force,
    SceneInput: lambda given: without_none(unit=given.unit or None, value=given.function),
    SceneOutput: lambda output: {"kind": output.kind, **output.values},
    Simulation: lambda simulation: without_none(**asdict(simulation)),
    SpatialStart: _spatial_start,
    Plot: _plot,
    ReferenceCurve: lambda curve: {"file": curve.file, "x": curve.x, "y": curve.y},
}
