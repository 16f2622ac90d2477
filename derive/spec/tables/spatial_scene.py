"""The tables of a scene in space: joints, gears, forces, springs and outputs, and the scene itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.mechanics.multibody.space.outputs import SPATIAL_OUTPUTS
from derive.mechanics.multibody.space.springs import SPATIAL_BUSHINGS, SPATIAL_SPRINGS
from derive.spec.files.reference_curves import Rows
from derive.spec.model.documentation import purpose
from derive.spec.model.instances import COUNT
from derive.spec.model.keys import KeyType, declared_keys
from derive.spec.model.node_data import NodeData
from derive.spec.model.plots import Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.spatial_forces import (
    SpatialForce,
    SpatialJointForce,
    SpatialJointTorque,
    SpatialSpring,
    SpatialTorque,
)
from derive.spec.model.spatial_scene import Gear, SpatialJoint, SpatialJointInitialValues, SpatialScene
from derive.spec.tables.bushings import bushing_with_units
from derive.spec.tables.declared_tables import TABLES, DeclaredTable, declare, keyed_model
from derive.spec.tables.registered_tables import registered_table
from derive.spec.tables.scene_elements import output_table, with_speed_units
from derive.spec.tables.sections import described_scene, ground_and_scene, section_fields
from derive.spec.tables.shared import TomlTable, one_of
from derive.spec.tables.simulation import PLOT
from derive.spec.tables.spatial_bodies import bodies_in_space, flexible_body
from derive.spec.tables.specification import SpecificationKeys

declare(SpatialJointInitialValues, "SpatialJointStartTable")
OF_KIND = ("removes", "distance", "pitch", "limits")
"""The fields of a joint in space that are keys of some kinds alone."""


def spatial_joint_table() -> DeclaredTable:
    """The table of a joint in space, with the kinds and keys of all joints that are registered now."""
    keys = tuple(key for key in declared_keys(SpatialJoint) if key.field not in OF_KIND)
    types = (*SPATIAL_JOINTS.items(),)
    return registered_table("SpatialJointTable", purpose(SpatialJoint), "joint", types, (*keys, COUNT), _joint)


def _joint(kind: str, own: Mapping[str, Any], given: dict[str, Any]) -> SpatialJoint:
    first, second = own["first"]
    others = {field: value for field, value in own.items() if field not in ("first", "count")}
    return SpatialJoint("", kind, first, second, **others, **given)


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
    doc = purpose(SpatialSpring)
    springs = (*SPATIAL_SPRINGS.items(),)
    own = registered_table("SpatialSpringTable", doc, "spring", springs, (*keys, COUNT), _spring, "linear")
    bushings = (*SPATIAL_BUSHINGS.items(),)
    bushing = registered_table("SpatialBushingTable", doc, "bushing", bushings, (*keys, COUNT), _spring)
    return DeclaredTable(own.model, one_of(_kind_of_spring, spring=own.value, bushing=bushing.value))


def _kind_of_spring(value: Any) -> str:
    return "bushing" if isinstance(value, Mapping) and value.get("kind") in SPATIAL_BUSHINGS else "spring"


def _spring(kind: str, own: Mapping[str, Any], given: dict[str, Any]) -> SpatialSpring:
    first, second = own["first"]
    return SpatialSpring("", kind, first, second, bushing_with_units(given) if kind in SPATIAL_BUSHINGS else given)


SPATIAL_GROUND_TABLE, SPATIAL_SCENE_TABLE = ground_and_scene(SpatialScene, "Spatial", "a scene in space")


def spatial_specification_table() -> type[TomlTable]:
    """The table of a whole specification of a scene in space, with the joints that are registered now."""
    return _spatial_specification_table(
        (
            (SpatialJoint, spatial_joint_table()),
            (SpatialForce, SPATIAL_FORCE),
            (SpatialTorque, SPATIAL_TORQUE),
            (SpatialSpring, spatial_spring_table()),
            (SceneOutput, output_table("SpatialOutputTable", SPATIAL_OUTPUTS)),
            (Plot, PLOT),
        )
    )


@cache
def _spatial_specification_table(elements: tuple[tuple[type, DeclaredTable], ...]) -> type[TomlTable]:
    own = {"ground": SPATIAL_GROUND_TABLE, "scene": SPATIAL_SCENE_TABLE, "bodies": bodies_in_space()}
    fields = section_fields(SpatialScene, own, {**TABLES, **dict(elements)})
    doc = "A specification for Tisserand: a scene of bodies in space."
    return keyed_model("SpatialSpecificationTable", doc, (), SpecificationKeys, others=fields)


def spatial_scene(table: Any, references: Mapping[str, Rows], nodes: Mapping[str, NodeData]) -> SpatialScene:
    """The scene in space that a table describes.

    references: the numbers of plots with a reference. nodes: the data of finite-element bodies by their names.
    """
    bodies = tuple(
        flexible_body(name, body, nodes[name]) if name in nodes else replace(body, name=name)
        for name, body in table.bodies.items()
    )
    drives = with_speed_units(table.drives, table.joints, SPATIAL_JOINTS)
    others = {"ground_visuals": table.ground.visuals if table.ground else ()}
    return described_scene(SpatialScene, table, references, bodies=bodies, drives=drives, **others)
