"""The tables of a scene in space: bodies, marker frames, joints, and the scene itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Annotated, Any

from pydantic import Field

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.spec.files.reference_curves import Rows
from derive.spec.model.instances import COUNT
from derive.spec.model.keys import KeyType, declared_keys
from derive.spec.model.plots import Plot
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene import NAMED, Drive
from derive.spec.model.spatial_scene import (
    FrameMarker,
    SpatialInitialValues,
    SpatialJoint,
    SpatialRigidBody,
    SpatialScene,
)
from derive.spec.parsing.values import WrongValueError
from derive.spec.tables.declared_tables import TABLES, DeclaredTable, declare, key_field, keyed_model, named
from derive.spec.tables.registered_tables import registered_table
from derive.spec.tables.shared import ElementName, TomlTable
from derive.spec.tables.simulation import PLOT, SIMULATION
from derive.spec.tables.specification import OTHER_SECTIONS, SCENE, SpecificationKeys, plots
from derive.spec.tables.value_types import COORDINATE_TRIPLE, VALUE_TYPES, markers_type

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


declare(SpatialInitialValues, "SpatialInitialValuesTable")
SPATIAL_RIGID = declare(
    SpatialRigidBody, "SpatialRigidTable", keys=(*declared_keys(SpatialRigidBody), COUNT), check=_check_inertia
)

OF_KIND = ("removes", "distance")
"""The fields of a joint in space that are keys of some kinds alone."""


def spatial_joint_table() -> DeclaredTable:
    """The table of a joint in space, with the kinds and keys of all joints that are registered now."""
    keys = tuple(key for key in declared_keys(SpatialJoint) if key.field not in OF_KIND)
    types = (*SPATIAL_JOINTS.items(),)
    return registered_table("SpatialJointTable", SpatialJoint.__doc__ or "", "joint", types, (*keys, COUNT), _joint)


def _joint(kind: str, own: Mapping[str, Any], given: dict[str, Any]) -> SpatialJoint:
    first, second = own["first"]
    return SpatialJoint("", kind, first, second, start=own["start"], **given)


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
    return _spatial_specification_table(((SpatialJoint, spatial_joint_table()), (Plot, PLOT)))


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

    names = (name for name in (*SCENE, "simulation", "plots") if name in _OF_SCENE or name in _WRITTEN)
    sections: dict[str, Any] = {name: section(name) for name in names}
    doc = "A specification for Tisserand: a scene of bodies in space."
    return keyed_model("SpatialSpecificationTable", doc, (), SpecificationKeys, others=sections)


_WRITTEN = ("ground", "scene", "bodies", "simulation", *OTHER_SECTIONS)


def _bodies() -> Any:
    bodies = named(SPATIAL_RIGID.value, "bodies", "[bodies.rod]", ElementName, minProperties=1)
    return Annotated[bodies, Field(description="Bodies of a scene in space by name.")]


def spatial_scene(table: Any, references: Mapping[str, Rows]) -> SpatialScene:
    """The scene in space that a table describes; `references` are the numbers of plots with a reference."""
    sections: dict[str, Any] = {section: getattr(table, section, ()) for section in NAMED}
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
