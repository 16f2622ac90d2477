"""Scenes built in Python, in the plane and in space."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

from derive.spec.as_tables import as_table, named, without_none
from derive.spec.construction.bodies import Constant, Table, documented_keys
from derive.spec.construction.validated import validated_data
from derive.spec.model.forces import Bushing, CustomForce, Force, Spring, Torque
from derive.spec.model.joints import Drive, Joint
from derive.spec.model.markers import PointMarker
from derive.spec.model.planar_bodies import SceneBody
from derive.spec.model.plots import Plot
from derive.spec.model.ports import SceneOutput
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
from derive.spec.model.visuals import Visual
from derive.spec.tables.sections import OF_SCENE

Element = TypeVar("Element")


Named = Mapping[str, Element | Table] | Sequence[Element]
"""The type of elements with names: a mapping from names to tables or typed values, or a sequence of typed values."""


AnyOf = TypeVar("AnyOf", Scene, SpatialScene)


@documented_keys(Scene)
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
        bodies: rigid bodies and beams, such as {"rod": {"length": 1, "frame": "mean"}}.
        parameters: run-time parameters that functions of time call by name.
        tables: tables of values that functions of time call by name.
        simulation: duration, output and tolerance of a simulation.

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
    result = validated_data(data)
    if not isinstance(result, of):
        raise TypeError(f"these tables specify a {type(result).__name__}, not a {of.__name__}")
    return result


@documented_keys(SpatialScene)
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
        ground_visuals: what pictures show of the ground, such as {"box": [1, 1, 0.1]}.
        bodies: rigid bodies with their tensors of inertia, and finite-element bodies.
        parameters: run-time parameters that functions of time call by name.
        tables: tables of values that functions of time call by name.
        simulation: duration, output and tolerance of a simulation.

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
