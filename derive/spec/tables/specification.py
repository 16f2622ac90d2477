"""A whole specification as a pydantic model, which also makes the JSON schema for editors."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Annotated, Any

from pydantic import ConfigDict, Field

from derive.mechanics.multibody.forces.registry import DEFAULT_KINDS
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.spec.files.reference_curves import Rows
from derive.spec.model.joints import Joint
from derive.spec.model.plots import Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.scene import Scene
from derive.spec.tables.beam import BEAM
from derive.spec.tables.body import BodyInput
from derive.spec.tables.declared_tables import TABLES, DeclaredTable, keyed_model
from derive.spec.tables.scene_bodies import bodies_field, body_tables
from derive.spec.tables.scene_elements import ELEMENTS, force_table, joint_table, output_table, with_speed_units
from derive.spec.tables.sections import SCENE, described_scene, ground_and_scene, section_fields
from derive.spec.tables.shared import Name, TomlTable
from derive.spec.tables.simulation import PLOT

GROUND_TABLE, SCENE_TABLE = ground_and_scene(Scene, "", "a scene")


class SpecificationKeys(TomlTable):
    """The keys of a specification besides those of a scene."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [{"required": ["beam"]}, {"required": ["body"]}, {"required": ["bodies"]}],
            "dependentRequired": {key: ["bodies"] for key in SCENE if key != "bodies"},
        }
    )

    name: Annotated[Name, Field(description="Name of the model and its files, and prefix of all its functions.")]
    beam: BEAM.value | None = None  # type: ignore[name-defined]  # made of the declared keys
    body: BodyInput | None = None  # type: ignore[valid-type]  # made of the declared keys


def specification_table() -> type[TomlTable]:
    """The table of a whole specification, with the joints, bodies and forces that are registered now."""
    forces = tuple((ELEMENTS[section], force_table(section)) for section in DEFAULT_KINDS)
    elements = (
        (Joint, joint_table()),
        *forces,
        (SceneOutput, output_table()),
        (Plot, PLOT),
    )
    return _specification_table(elements, tuple(body_tables().items()))


@cache
def _specification_table(
    elements: tuple[tuple[type, DeclaredTable], ...], bodies: tuple[tuple[str, DeclaredTable], ...]
) -> type[TomlTable]:
    own = {"ground": GROUND_TABLE, "scene": SCENE_TABLE, "bodies": bodies_field(dict(bodies))}
    fields = section_fields(Scene, own, {**TABLES, **dict(elements)})
    doc = "A specification for Tisserand: a beam, a body in space, or a scene of planar bodies."
    return keyed_model("SpecificationTable", doc, (), SpecificationKeys, others=fields)


def scene(table: Any, references: Mapping[str, Rows]) -> Scene:
    """The scene that a table describes; `references` are the numbers of plots with a reference."""
    drives = with_speed_units(table.drives, table.joints, JOINTS)
    return described_scene(Scene, table, references, drives=drives)
