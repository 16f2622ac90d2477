"""Specifications built in Python from typed values or mappings, with the keys, defaults and checks of a TOML file.

Every function raises SpecError with all faults; paths are those of a TOML file, without lines.
"""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
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
from derive.spec.model.body import BodyFrame, ComponentModes, Damping, Lowering, NodalBody, SymbolicBody, SymbolicFrame
from derive.spec.model.documentation import key_entries, with_entries
from derive.spec.model.forces import Bushing, CustomForce, Force, Spring, Torque
from derive.spec.model.instances import identifier
from derive.spec.model.joints import Drive, Joint
from derive.spec.model.keys import declared_keys
from derive.spec.model.markers import PointMarker
from derive.spec.model.mode_selection import ModeSelection
from derive.spec.model.node_data import NodeData
from derive.spec.model.planar_bodies import SceneBody
from derive.spec.model.plots import Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene import NAMED, Scene, SceneInput
from derive.spec.model.simulation import Simulation
from derive.spec.model.spatial_beam import SpatialBody
from derive.spec.model.spatial_bodies import FrameMarker
from derive.spec.model.spatial_forces import (
    SpatialForce,
    SpatialJointForce,
    SpatialJointTorque,
    SpatialSpring,
    SpatialTorque,
)
from derive.spec.model.spatial_scene import Gear, SpatialJoint, SpatialScene
from derive.spec.model.specification import Specification, check_specification
from derive.spec.model.visuals import Visual
from derive.spec.parsing.names import element_name_problem
from derive.spec.tables.sections import OF_SCENE

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
    """A decorator that adds to the arguments in the docstring of a function the keys that a type declares."""

    def documented(function: Function) -> Function:
        parameters = inspect.signature(function).parameters
        keys = (key for key in declared_keys(of) if key.name in parameters and key.description)
        function.__doc__ = with_entries(inspect.getdoc(function) or "", "Arguments", key_entries(keys))
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

    Arguments:
        name: the name of the model, which is the prefix of its C.

    Raises:
        SpecError: with all faults of the arguments.

    Examples:
        >>> import derive
        >>> beam = derive.planar_beam("beam", frame="point", mass=2, length="3/2", markers={"tip": 1})
        >>> beam.length, beam.frame.kind
        (Fraction(3, 2), 'point')
        >>> stiff = derive.planar_beam("stiff", mass=1, length=1, bending_stiffness=100)
        >>> derive.modes(stiff).frequencies[3:].round(1)  # Hz, of its two shapes
        array([ 42.7, 145.9])
    """
    return _single(PlanarBeam, planar_beam, locals())


@_documented(NodalBody)
def nodal_body(
    name: str,
    nodes: Nodes,
    *,
    units: str | Mapping[str, str] | None = None,
    modes: int | ModeSelection | Mapping[str, float] | None = None,
    component_modes: ComponentModes | None = None,
    interface: Sequence[str] | None = None,
    frame: str | Mapping[str, object] | BodyFrame = "mean",
    orthonormal: bool | None = None,
    damping: Mapping[str, Number] | Damping | None = None,
    gravity: Sequence[Constant] | None = None,
    lowering: Lowering = "auto",
    markers: Mapping[str, int] | None = None,
    order: int | None = None,
    stress: bool = False,
) -> NodalBody:
    """A deformable body in space made of the nodes of a finite-element program.

    The nodes may also be a table of arrays or lists with the names that they have in a .npz file, or NodeData, which
    are in SI units.

    Arguments:
        name: the name of the model, which is the prefix of its C.

    Raises:
        SpecError: with all faults of the arguments and of the arrays.

    Examples:
        >>> import derive
        >>> import numpy as np
        >>> corners = [[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]]
        >>> breathing = [np.array(corners) / 8**0.5]
        >>> nodes = {"positions": corners, "mass": np.eye(4), "modes": breathing, "modal_stiffness": [[100]]}
        >>> square = derive.nodal_body("square", nodes, units="SI")
        >>> derive.modes(square).frequencies[-1:].round(3)  # 10 rad/s in Hz
        array([1.592])
    """
    given = locals()
    if units is None and isinstance(nodes, NodeData):
        given["units"] = "SI"
    if isinstance(nodes, Mapping):
        given["nodes"] = {key: _array(rows) for key, rows in nodes.items()}
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
    """A deformable body in space whose mass, shape integrals and stiffness are run-time parameters.

    `parameters` gives the values of these with which the model represents a particular body.

    Arguments:
        name: the name of the model, which is the prefix of its C.

    Raises:
        SpecError: with all faults of the arguments.

    Examples:
        >>> import derive
        >>> model = derive.lower(derive.derive(derive.symbolic_body("any_body", modes=1)))
        >>> [parameter.name for parameter in model.parameters][:4]
        ['m', 'C3_11_', 'C3_12_', 'C3_13_']
    """
    return _single(SymbolicBody, symbolic_body, {**locals(), "integrals": "symbolic"})


def _array(rows: Any) -> Any:
    """Nested lists as an array; anything else, such as the name of a file or ragged rows, as it is."""
    if isinstance(rows, (list, tuple)):
        import numpy as np  # beams do without

        with suppress(ValueError):
            return np.array(rows)
    return rows


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

    Bodies and other parts with names are mappings from names to the tables of a TOML file or to typed values such as
    RigidBody and Joint, or sequences of typed values. Files are relative to the working directory.

    Arguments:
        name: the name of the model; or, alone, the tables of a whole TOML file as one mapping.
        ground: the markers of the inertial frame, two coordinates each, m.
        gravity: two components, m/s^2.
        start: "equilibrium", "steady", or None for the initial values of bodies and joints.
        lowering: "flat", "instances" or, by default, "auto".
        redundant: "auto", "resolve" or "error", the treatment of redundant joints.
        bodies: rigid bodies and beams, such as {"rod": {"length": 1, "frame": "mean"}}.
        joints: such as {"hinge": {"kind": "revolute", "between": ["ground.pivot", "rod.left"]}}.
        drives: prescribed motions of joints.
        forces: forces at markers.
        torques: torques at markers.
        springs: springs, dampers and bushings between markers.
        inputs: run-time inputs, which forces, torques and drives refer to.
        outputs: quantities that are computed from the state.
        parameters: run-time parameters that functions of time call by name.
        tables: tables of values that functions of time call by name.
        simulation: duration, output and tolerance of a simulation.
        plots: plots of a simulation.

    Raises:
        SpecError: with all faults of the arguments.
        TypeError: if the tables specify a single body, or a scene in space.

    Examples:
        >>> import derive
        >>> pendulum = derive.scene(
        ...     "pendulum",
        ...     gravity=(0, -9.81),
        ...     ground={"pivot": (0, 0)},
        ...     bodies={"rod": {"mass": 1, "inertia": "1/12", "markers": {"top": (0, 0.5)}}},
        ...     joints={"hinge": {"kind": "revolute", "between": ["ground.pivot", "rod.top"]}},
        ... )
        >>> pendulum.bodies[0].inertia, pendulum.joints[0].kind
        (Fraction(1, 12), 'revolute')
    """
    return _scene(Scene, locals())


def _scene(of: type[AnyOf], given: Mapping[str, Any]) -> AnyOf:
    """A scene of a type from the arguments of a function. Raises TypeError where its tables specify another type."""
    if isinstance(given["name"], Mapping):
        data = {key: named(key, table) if key in NAMED else table for key, table in given["name"].items()}
    else:
        visuals = as_table(tuple(given.get("ground_visuals", ())))
        ground = {
            **({"markers": markers} if (markers := named("ground", given["ground"])) else {}),
            **({"visuals": visuals} if visuals else {}),
        }
        of_scene = without_none(**{key: given[key] for key in OF_SCENE if key in given})
        data = {
            "name": given["name"],
            **({"ground": ground} if ground else {}),
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
    ground_visuals: Sequence[Visual | Table] = (),
    gravity: Sequence[Constant] | None = None,
    start: str | None = None,
    lowering: str | None = None,
    redundant: str | None = None,
    coordinates: str | None = None,
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

    Bodies and other parts with names are mappings as those of `scene`, with three components in place of two. That a
    scene is in space is seen from its vectors and its finite-element bodies.

    Arguments:
        name: the name of the model; or, alone, the tables of a whole TOML file as one mapping.
        ground: the markers of the inertial frame: three coordinates, m, or tables with the keys `at` and `rotation`.
        ground_visuals: what pictures show of the ground, such as {"box": [1, 1, 0.1]}.
        gravity: three components, m/s^2.
        start: "equilibrium", "steady", or None for the initial values of bodies and joints.
        lowering: "flat", "instances" or, by default, "auto".
        redundant: "auto", "resolve" or "error", the treatment of redundant joints.
        coordinates: "auto", "relative" or "absolute", those of rigid bodies that joints connect to bodies that move.
        bodies: rigid bodies with their tensors of inertia, and finite-element bodies.
        joints: such as {"hinge": {"kind": "revolute", "between": ["ground.pivot", "rod.left"]}}, about z of the first.
        drives: prescribed motions of joints.
        gears: ratios of the motions of two joints.
        forces: forces at markers or in joints.
        torques: torques at markers or in joints.
        springs: springs, dampers and bushings between markers.
        inputs: run-time inputs, which forces, torques and drives refer to.
        outputs: quantities that are computed from the state.
        parameters: run-time parameters that functions of time call by name.
        tables: tables of values that functions of time call by name.
        simulation: duration, output and tolerance of a simulation.
        plots: plots of a simulation.

    Raises:
        SpecError: with all faults of the arguments.
        TypeError: if the tables specify a single body, or a scene in the plane.

    Examples:
        >>> import derive
        >>> top = {"mass": 1, "inertia": [1, 1, 2, 0, 0, 0], "start": {"angular_velocity": [0, 0, 5]}}
        >>> scene = derive.spatial_scene("spinner", gravity=(0, 0, -10), bodies={"top": top})
        >>> scene.bodies[0].start.angular_velocity
        (0.0, 0.0, 5.0)
        >>> derive.simulate(scene, duration=1, output=0.5)["top_c3"].round(6) + 0.0
        array([ 0.  , -1.25, -5.  ])
    """
    return _scene(SpatialScene, locals())


def validated(spec: S) -> S:
    """A specification built of dataclasses, checked as a TOML file is; numbers and texts become exact values.

    The dataclasses themselves check nothing, so that `Scene(...)` built by hand goes through this function first.

    Arguments:
        spec: a scene or a body.

    Returns:
        A specification of the same type.

    Raises:
        SpecError: with all faults.
        TypeError: for anything but a specification.

    Examples:
        >>> import derive
        >>> import dataclasses
        >>> beam = derive.planar_beam("beam", mass=2)
        >>> derive.validated(dataclasses.replace(beam, mass="1/3")).mass
        Fraction(1, 3)
    """
    check_specification(spec)
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
