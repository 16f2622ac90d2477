"""A whole specification as a pydantic model, which also makes the JSON schema for editors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Annotated, Any

from pydantic import ConfigDict, Field

from derive.mechanics.multibody.forces.registry import DEFAULT_KINDS
from derive.spec.files.reference_curves import Rows
from derive.spec.model.keys import KeyType, declared_keys, key
from derive.spec.model.plots import Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.quantity import UNIT
from derive.spec.model.scene import NAMED, Joint, Scene
from derive.spec.tables.beam import BEAM
from derive.spec.tables.body import BodyInput
from derive.spec.tables.declared_tables import TABLES, DeclaredTable, key_field, keyed_model
from derive.spec.tables.scene_bodies import bodies_field, body_tables
from derive.spec.tables.scene_elements import ELEMENTS, force_table, joint_table, output_table, with_speed_unit
from derive.spec.tables.shared import Name, TomlTable, by_name
from derive.spec.tables.simulation import PLOT, SIMULATION

SCENE = (
    "ground",
    "scene",
    "bodies",
    "joints",
    "drives",
    "forces",
    "torques",
    "springs",
    "inputs",
    "outputs",
    "parameters",
    "tables",
)
"""The keys of a specification that make it a scene."""

_OF_SCENE = {key.field: key for key in declared_keys(Scene)}
GROUND_TABLE = keyed_model(
    "GroundTable", "The inertial frame, which does not move.", (replace(_OF_SCENE["ground"], name="markers"),)
)
SCENE_TABLE = keyed_model(
    "SceneTable",
    "Gravity, initial state, lowering and redundant joints of a scene.",
    tuple(_OF_SCENE[name] for name in ("gravity", "start", "lowering", "redundant")),
)
FUNCTION_PARAMETER = keyed_model(
    "FunctionParameterTable",
    "A run-time parameter of the generated code that functions of time call by its name.",
    (key(KeyType.FLOAT, "Default value.", name="default", required=True, example="0.1"), replace(UNIT, name="unit")),
)
VALUES_TABLE = keyed_model(
    "ValuesTable",
    "A table of values, two columns of a CSV file, which functions of time call by its name.\n\n"
    "Between the rows it is a cubic spline with two continuous derivatives; outside them the value is constant.",
    tuple(
        key(KeyType.TEXT, description, name=name, required=True, example=example)
        for name, description, example in (
            ("file", "CSV file, relative to the specification.", '"load.csv"'),
            ("x", "Name of the column of the argument, which increases from row to row.", '"the name of a column"'),
            ("y", "Name of the column of the values.", '"the name of a column"'),
        )
    ),
)


OTHER_SECTIONS = {
    "parameters": Annotated[
        by_name(FUNCTION_PARAMETER, "parameters", "[parameters.amplitude]"),
        Field(description="Run-time parameters that functions of time call by name."),
    ],
    "tables": Annotated[
        by_name(VALUES_TABLE, "tables", "[tables.load]"),
        Field(description="Tables of values that functions of time call by name."),
    ],
}
"""The sections that functions of time call by name, and that are read before them."""


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
    tables = {**TABLES, **dict(elements)}

    def section(name: str) -> Any:
        match name:
            case "ground":
                return GROUND_TABLE | None, None
            case "scene":
                return SCENE_TABLE | None, None
            case "bodies":
                return bodies_field(dict(bodies)) | None, None
            case "simulation":
                return SIMULATION.value | None, None
            case _ if name in OTHER_SECTIONS:
                return OTHER_SECTIONS[name], {}
            case _:
                return key_field(_OF_SCENE[name], False, tables)

    sections: dict[str, Any] = {name: section(name) for name in (*SCENE, "simulation", "plots")}
    doc = "A specification for Tisserand: a beam, a body in space, or a scene of planar bodies."
    return keyed_model("SpecificationTable", doc, (), SpecificationKeys, others=sections)


def plots(table: Any, references: Mapping[str, Rows]) -> tuple[Plot, ...]:
    """The plots of a specification; `references` are the numbers of those with a reference."""
    return tuple(
        plot
        if plot.reference is None
        else replace(plot, reference=replace(plot.reference, rows=references.get(plot.name, ())))
        for plot in table.plots
    )


def scene(table: Any, references: Mapping[str, Rows]) -> Scene:
    """The scene that a table describes; `references` are the numbers of plots with a reference."""
    sections: dict[str, Any] = {section: getattr(table, section) for section in NAMED if section in (*SCENE, "plots")}
    sections["drives"] = tuple(with_speed_unit(drive, table.joints) for drive in table.drives)
    sections["plots"] = plots(table, references)
    return Scene(
        name=table.name,
        ground=() if table.ground is None else table.ground.markers,
        gravity=None if table.scene is None else table.scene.gravity,
        start=None if table.scene is None else table.scene.start,
        lowering="auto" if table.scene is None else table.scene.lowering,
        redundant="auto" if table.scene is None else table.scene.redundant,
        simulation=table.simulation,
        **sections,
    )
