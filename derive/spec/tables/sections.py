"""The sections of a scene, in the plane or in space: the fields of its table, and the scene that a table describes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any, TypeVar

from pydantic import Field

from derive.spec.files.reference_curves import Rows
from derive.spec.model.keys import Key, KeyType, declared_keys, key
from derive.spec.model.plots import Plot
from derive.spec.model.quantity import UNIT
from derive.spec.model.scene import NAMED, Scene
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.tables.declared_tables import DeclaredTable, key_field, keyed_model
from derive.spec.tables.shared import TomlTable, by_name
from derive.spec.tables.simulation import SIMULATION

AnyScene = TypeVar("AnyScene", Scene, SpatialScene)

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

OF_SCENE = ("gravity", "start", "lowering", "redundant", "coordinates")
"""The keys of the section `scene`, as far as a type of scene has them."""
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


FUNCTION_SECTIONS = {
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


def _keys(of: type) -> dict[str, Key]:
    return {key.field: key for key in declared_keys(of)}


def ground_and_scene(of: type[AnyScene], prefix: str, noun: str) -> tuple[type[TomlTable], type[TomlTable]]:
    """The tables of the sections `ground` and `scene` of a type of scene; `prefix` begins their names in the schema."""
    keys = _keys(of)
    markers = (replace(keys["ground"], name="markers"), *(keys[name] for name in ("ground_visuals",) if name in keys))
    doc = f"Gravity, initial state, lowering and redundant joints of {noun}."
    return (
        keyed_model(f"{prefix}GroundTable", "The inertial frame, which does not move.", markers),
        keyed_model(f"{prefix}SceneTable", doc, tuple(keys[name] for name in OF_SCENE if name in keys)),
    )


def section_fields(
    of: type[AnyScene], own: Mapping[str, Any], tables: Mapping[type, DeclaredTable]
) -> dict[str, tuple[Any, Any]]:
    """The fields of the sections of a type of scene, in their order: annotation and default.

    own: the types of the sections that are not keys of the scene as they are, by name. tables: those of the elements.
    """
    keys = _keys(of)
    written: dict[str, tuple[Any, Any]] = {
        **{name: (section | None, None) for name, section in (*own.items(), ("simulation", SIMULATION.value))},
        **{name: (section, {}) for name, section in FUNCTION_SECTIONS.items()},
    }
    names = (name for name in (*SCENE, "gears", "simulation", "plots") if name in written or name in keys)
    return {name: written[name] if name in written else key_field(keys[name], False, tables) for name in names}


def plots(table: Any, references: Mapping[str, Rows]) -> tuple[Plot, ...]:
    """The plots of a specification; `references` are the numbers of those with a reference."""
    return tuple(
        plot
        if plot.reference is None
        else replace(plot, reference=replace(plot.reference, rows=references.get(plot.name, ())))
        for plot in table.plots
    )


def described_scene(of: type[AnyScene], table: Any, references: Mapping[str, Rows], **sections: Any) -> AnyScene:
    """The scene of a type that a table describes.

    references: the numbers of plots with a reference. sections: values in place of those of the table.
    """
    named = {section: getattr(table, section) for section in NAMED if section in type(table).model_fields}
    chosen = {} if table.scene is None else {k: v for k in OF_SCENE if (v := getattr(table.scene, k, None)) is not None}
    return of(
        name=table.name,
        ground=() if table.ground is None else table.ground.markers,
        simulation=table.simulation,
        **{"gravity": None, **chosen},
        **{**named, "plots": plots(table, references), **sections},
    )
