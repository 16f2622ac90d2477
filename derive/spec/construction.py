"""Specifications built in Python from typed values or mappings, with the keys, defaults and checks of a TOML file.

Every function raises SpecError with all faults; paths are those of a TOML file, without lines.
"""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from textwrap import fill
from typing import Any, TypeVar

from derive.spec.as_tables import as_table, named, specification_tables, without_none
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import (
    DEFAULT_ANSATZ,
    DEFAULT_BENDING_STIFFNESS,
    DEFAULT_LENGTH,
    DEFAULT_MASS,
    AttachedMass,
    AxialDeformation,
    BeamDamping,
    Frame,
    Polynomial,
    ShapeFamily,
)
from derive.spec.model.body import BodyFrame, Damping, Lowering, NodalBody, NodeData, SymbolicBody, SymbolicFrame
from derive.spec.model.forces import Bushing, CustomForce, Force, Spring, Torque
from derive.spec.model.instances import identifier
from derive.spec.model.keys import declared_keys
from derive.spec.model.markers import PointMarker
from derive.spec.model.plots import Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene import NAMED, Drive, Joint, Scene, SceneBody, SceneInput
from derive.spec.model.simulation import Simulation
from derive.spec.model.spatial_bodies import FrameMarker, SpatialBody
from derive.spec.model.spatial_forces import (
    SpatialForce,
    SpatialJointForce,
    SpatialJointTorque,
    SpatialSpring,
    SpatialTorque,
)
from derive.spec.model.spatial_scene import Gear, SpatialJoint, SpatialScene
from derive.spec.model.specification import Specification
from derive.spec.parsing.names import element_name_problem

Number = int | float | Fraction | str
Constant = Number | Mapping[str, object] | Parameter
Nodes = str | os.PathLike[str] | Mapping[str, Any] | NodeData
Table = Mapping[str, object]
Element = TypeVar("Element")
Named = Mapping[str, Element | Table] | Sequence[Element]
"""The type of elements with names: a mapping from names to tables or typed values, or a sequence of typed values."""

S = TypeVar("S", bound=Specification)
AnyOf = TypeVar("AnyOf", Scene, SpatialScene)
Body = TypeVar("Body", PlanarBeam, NodalBody, SymbolicBody)
Function = TypeVar("Function", bound=Callable[..., Specification])


def _documented(of: type) -> Callable[[Function], Function]:
    """A decorator that adds to the docstring of a function the descriptions of the keys that a type declares."""

    def documented(function: Function) -> Function:
        parameters = inspect.signature(function).parameters
        keys = (key for key in declared_keys(of) if key.name in parameters and key.description)
        lines = (fill(f"{key.name}: {key.description}", 100, subsequent_indent="    ") for key in keys)
        function.__doc__ = "\n".join((f"{inspect.getdoc(function)}\n", *lines))
        return function

    return documented


@_documented(PlanarBeam)
def planar_beam(
    name: str,
    *,
    ansatz: Sequence[str | Polynomial] | Mapping[str, object] | ShapeFamily = DEFAULT_ANSATZ,
    frame: str | Mapping[str, object] | Frame | None = None,
    mass: Constant = DEFAULT_MASS,
    length: Constant = DEFAULT_LENGTH,
    bending_stiffness: Constant = DEFAULT_BENDING_STIFFNESS,
    markers: Mapping[str, Number] | None = None,
    orthogonal: bool | None = None,
    ends: str | None = None,
    gravity: Sequence[Constant] | None = None,
    axial: Table | AxialDeformation | None = None,
    damping: Mapping[str, Constant] | BeamDamping | Damping | None = None,
    order: int = 1,
    terms: str | None = None,
    masses: Mapping[str, Table] | Sequence[AttachedMass] = (),
) -> PlanarBeam:
    """A uniform slender beam that moves in a plane.

    The beam of a body such as link[3] may have the name of the body; alone it is a model called link_3. Numbers may be
    texts, such as "1/3"; a float is the decimal that it is printed as. Polynomials are texts, such as "xi^2 - 1/3", or
    tuples of coefficients.
    """
    return _single(PlanarBeam, planar_beam, locals())


@_documented(NodalBody)
def nodal_body(
    name: str,
    nodes: Nodes,
    *,
    units: str | Mapping[str, str] | None = None,
    modes: int | None = None,
    frame: str | Mapping[str, object] | BodyFrame = "mean",
    orthonormal: bool | None = None,
    damping: Mapping[str, Number] | Damping | None = None,
    gravity: Sequence[Constant] | None = None,
    lowering: Lowering = "auto",
    markers: Mapping[str, int] | None = None,
    order: int | None = None,
) -> NodalBody:
    """A deformable body in space made of the nodes of a finite-element program.

    The nodes may also be a table of arrays with the names that they have in a .npz file, or NodeData, which are in SI
    units.
    """
    given = locals()
    if units is None and isinstance(nodes, NodeData):
        given["units"] = "SI"
    return _single(NodalBody, nodal_body, given)


@_documented(SymbolicBody)
def symbolic_body(
    name: str,
    modes: int,
    *,
    frame: SymbolicFrame = "mean",
    damping: bool = False,
    gravity: Sequence[Constant] | None = None,
    lowering: Lowering = "auto",
) -> SymbolicBody:
    """A deformable body in space whose mass, shape integrals and stiffness are run-time parameters."""
    return _single(SymbolicBody, symbolic_body, {**locals(), "integrals": "symbolic"})


def _single(of: type[Body], function: Callable[..., Body], given: Mapping[str, Any]) -> Body:
    """The specification of a single body from the arguments of a function, of which None are not given by default."""
    parameters = inspect.signature(function).parameters
    keys: Table = {
        key: table
        for key, value in given.items()
        if key != "name" and not (value is None and key in parameters and parameters[key].default is None)
        if (table := named(key, value) if key == "masses" else as_table(value)) != {} or isinstance(value, Mapping)
    }
    name = given["name"]
    valid = isinstance(name, str) and not element_name_problem(name)
    result = _validate({"name": identifier(name) if valid else name, of.section: keys})
    assert isinstance(result, of)
    return result


def scene(
    name: str | Table,
    *,
    ground: Mapping[str, Sequence[Constant]] | Sequence[PointMarker] = (),
    gravity: Sequence[Constant] | None = None,
    start: str | None = None,
    lowering: str | None = None,
    redundant: str | None = None,
    bodies: Named[SceneBody] = (),
    joints: Named[Joint] = (),
    drives: Named[Drive] = (),
    forces: Named[Force | CustomForce] = (),
    torques: Named[Torque | CustomForce] = (),
    springs: Named[Spring | Bushing | CustomForce] = (),
    inputs: Named[SceneInput] = (),
    outputs: Named[SceneOutput] = (),
    parameters: Mapping[str, Table] | None = None,
    tables: Mapping[str, Table] | None = None,
    simulation: Simulation | Table | None = None,
    plots: Named[Plot] = (),
) -> Scene:
    """A mechanism: planar bodies with joints, drives, forces and gravity.

    name: the name of the model; or, alone, the tables of a whole TOML file as one mapping. ground: the markers of the
    inertial frame. bodies and the others: mappings from names to the tables of a TOML file or to typed values such as
    RigidBody and Joint, or sequences of typed values. gravity: two components, m/s^2. start: "equilibrium", or None for
    the initial values of bodies and joints. lowering: "flat", "instances" or, by default, "auto". redundant: "auto",
    "resolve" or "error", see the key. parameters, tables: what functions of time call by name. Files are relative to
    the working directory.
    """
    return _scene(Scene, locals())


def _scene(of: type[AnyOf], given: Mapping[str, Any]) -> AnyOf:
    """A scene of a type from the arguments of a function. Raises TypeError where its tables specify another type."""
    if isinstance(given["name"], Mapping):
        data = {key: named(key, table) if key in NAMED else table for key, table in given["name"].items()}
    else:
        markers = named("ground", given["ground"])
        of_scene = without_none(**{key: given[key] for key in ("gravity", "start", "lowering", "redundant")})
        data = {
            "name": given["name"],
            **({"ground": {"markers": markers}} if markers else {}),
            **({"scene": of_scene} if of_scene else {}),
            "bodies": named("bodies", given["bodies"]),
            **{kind: table for kind in NAMED if kind in given and (table := named(kind, given[kind]))},
            **without_none(**{key: given[key] for key in ("parameters", "tables", "simulation")}),
        }
    result = _validate(data)
    if not isinstance(result, of):
        raise TypeError(f"these tables specify a {type(result).__name__}, not a {of.__name__}")
    return result


def spatial_scene(
    name: str | Table,
    *,
    ground: Named[FrameMarker] | Mapping[str, Sequence[Constant]] = (),
    gravity: Sequence[Constant] | None = None,
    start: str | None = None,
    lowering: str | None = None,
    redundant: str | None = None,
    bodies: Named[SpatialBody] = (),
    joints: Named[SpatialJoint] = (),
    drives: Named[Drive] = (),
    gears: Named[Gear] = (),
    forces: Named[SpatialForce | SpatialJointForce] = (),
    torques: Named[SpatialTorque | SpatialJointTorque] = (),
    springs: Named[SpatialSpring] = (),
    inputs: Named[SceneInput] = (),
    outputs: Named[SceneOutput] = (),
    parameters: Mapping[str, Table] | None = None,
    tables: Mapping[str, Table] | None = None,
    simulation: Simulation | Table | None = None,
    plots: Named[Plot] = (),
) -> SpatialScene:
    """A mechanism in space: rigid and finite-element bodies with joints, gears, drives, forces and gravity.

    The arguments are those of `scene` with three components in place of two: markers are frames, which are coordinates,
    or tables with the keys `at` and `rotation`; gears are ratios of the motions of two joints. That a scene is in space
    is seen from its vectors and its finite-element bodies; TypeError is raised where they are in the plane.
    """
    return _scene(SpatialScene, locals())


def validated(spec: S) -> S:
    """A specification built of dataclasses, checked as a TOML file is; numbers and texts become exact values.

    The dataclasses themselves check nothing, so that `Scene(...)` built by hand goes through this function first.
    """
    return validated_tables(spec, specification_tables(spec))


def validated_tables(spec: S, tables: Table) -> S:
    """A specification of the same type as `spec` from its tables, in which values may have been replaced.

    Numbers of reference curves are those of `spec`, whose files are not read again. Plots may show columns that there
    are with the replaced values alone: a simulation looks for them.
    """
    curves = {plot.name: plot.reference.rows for plot in spec.plots if plot.reference}
    result = _validate(tables, curves, columns=False)
    assert isinstance(result, type(spec))
    return result


def _validate(
    data: Mapping[str, object], curves: Mapping[str, tuple[tuple[float, float], ...]] = {}, columns: bool = True
) -> Specification:
    # pydantic is imported only when there is something to check.
    from derive.spec.checks.validation import validate

    return validate(as_table(data), curves=curves, columns=columns)
