"""A whole specification as a pydantic model, which also makes the JSON schema for editors."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from typing import Annotated, Any

from pydantic import ConfigDict, Field, create_model

from derive.mechanics.multibody.forces.registry import DEFAULT_KINDS
from derive.spec.files.reference_curves import Rows
from derive.spec.model.plots import Plot
from derive.spec.model.scene import Scene
from derive.spec.model.simulation import Simulation
from derive.spec.tables.body import BodyInput
from derive.spec.tables.drives import DriveTable
from derive.spec.tables.forces import AnyForceTable, force_table
from derive.spec.tables.free_beam import BeamTable
from derive.spec.tables.functions import FunctionParameterTable, ValuesTable
from derive.spec.tables.joints import JointTable, joint_table
from derive.spec.tables.markers import MAX_NAMED, few_named
from derive.spec.tables.ports import InputTable, OutputTable, output_table
from derive.spec.tables.scene_bodies import BodyTable, GroundTable, SceneTable, bodies_field, body_tables, scene_bodies
from derive.spec.tables.shared import Name, TomlTable, acceleration
from derive.spec.tables.simulation import PlotInput, SimulationTable

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

_FORCES = {
    "forces": ("[forces.load]", "Forces by name."),
    "torques": ("[torques.load]", "Torques by name."),
    "springs": ("[springs.mount]", "Springs and dampers by name."),
}
"""The example of a table of each section of forces, and its description."""

_NAMED: dict[str, Any] = {"maxProperties": MAX_NAMED, "additionalProperties": False}


class SpecificationTable(TomlTable):
    """A specification for Tisserand: a beam, a body in space, or a scene of planar bodies."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [{"required": ["beam"]}, {"required": ["body"]}, {"required": ["bodies"]}],
            "dependentRequired": {key: ["bodies"] for key in SCENE if key != "bodies"},
        }
    )

    name: Annotated[Name, Field(description="Name of the model and its files, and prefix of all its functions.")]
    beam: BeamTable | None = None
    body: BodyInput | None = None
    ground: GroundTable | None = None
    scene: SceneTable | None = None
    bodies: dict[str, Any] | None = None
    joints: dict[str, JointTable] = {}  # noqa: RUF012  pydantic copies it
    drives: Annotated[
        dict[Name, DriveTable],
        few_named("drives", "[drives.motor]"),
        Field(description="Prescribed motions of joints by name.", json_schema_extra=_NAMED),
    ] = {}  # noqa: RUF012
    forces: dict[str, AnyForceTable] = {}  # noqa: RUF012
    torques: dict[str, AnyForceTable] = {}  # noqa: RUF012
    springs: dict[str, AnyForceTable] = {}  # noqa: RUF012
    inputs: Annotated[
        dict[Name, InputTable],
        few_named("inputs", "[inputs.motor]"),
        Field(description="Run-time inputs by name.", json_schema_extra=_NAMED),
    ] = {}  # noqa: RUF012
    outputs: dict[str, OutputTable] = {}  # noqa: RUF012
    parameters: Annotated[
        dict[Name, FunctionParameterTable],
        few_named("parameters", "[parameters.amplitude]"),
        Field(description="Run-time parameters that functions of time call by name.", json_schema_extra=_NAMED),
    ] = {}  # noqa: RUF012
    tables: Annotated[
        dict[Name, ValuesTable],
        few_named("tables", "[tables.load]"),
        Field(description="Tables of values that functions of time call by name.", json_schema_extra=_NAMED),
    ] = {}  # noqa: RUF012
    simulation: SimulationTable | None = None
    plots: Annotated[
        dict[Name, PlotInput],
        few_named("plots", "[plots.deflection]"),
        Field(description="Plots of a simulation by name.", json_schema_extra=_NAMED),
    ] = {}  # noqa: RUF012

    def settings(self) -> Simulation | None:
        """The settings of the simulation, if there are any."""
        return None if self.simulation is None else self.simulation.simulation()

    def drawn(self, references: Mapping[str, Rows]) -> tuple[Plot, ...]:
        """The models of the plots; `references` are the numbers of those with a reference."""
        return tuple(table.plot(name, references.get(name, ())) for name, table in self.plots.items())

    def scene_of(self, references: Mapping[str, Rows]) -> Scene:
        """The model of the scene that the derivation takes; `references` are the numbers of plots with a reference."""
        gravity = None if self.scene is None else self.scene.gravity
        return Scene(
            name=self.name,
            ground=() if self.ground is None else self.ground.points(),
            gravity=gravity and (acceleration(gravity[0]), acceleration(gravity[1])),
            bodies=scene_bodies(self.bodies or {}),
            joints=tuple(table.joint(name) for name, table in self.joints.items()),
            drives=tuple(table.drive(name, self.joints) for name, table in self.drives.items()),
            forces=_forces(self.forces),
            torques=_forces(self.torques),
            springs=_forces(self.springs),
            inputs=tuple(table.input(name) for name, table in self.inputs.items()),
            outputs=tuple(table.output(name) for name, table in self.outputs.items()),
            simulation=self.settings(),
            plots=self.drawn(references),
            start=None if self.scene is None else self.scene.start,
        )


def _forces(tables: Mapping[str, AnyForceTable]) -> tuple[Any, ...]:
    """The models of the elements of a section of forces."""
    return tuple(table.force(name) for name, table in tables.items())


def specification_table() -> type[SpecificationTable]:
    """The table of a whole specification, with the joints, bodies and forces that are registered now."""
    forces = tuple((section, force_table(section)) for section in DEFAULT_KINDS)
    return _specification_table(joint_table(), forces, output_table(), tuple(body_tables().items()))


@cache
def _specification_table(
    joint: type[JointTable],
    forces: tuple[tuple[str, type[AnyForceTable]], ...],
    output: type[OutputTable],
    bodies: tuple[tuple[str, type[BodyTable]], ...],
) -> type[SpecificationTable]:
    fields: dict[str, Any] = {"joints": (_named(joint, "joints", "[joints.pin]", "Joints by name."), {})}
    for section, table in forces:
        example, description = _FORCES[section]
        fields[section] = (_named(table, section, example, description), {})
    fields["outputs"] = (_named(output, "outputs", "[outputs.tip]", "Outputs by name."), {})
    return create_model(
        "SpecificationTable",
        __base__=SpecificationTable,
        __doc__=SpecificationTable.__doc__,
        bodies=(bodies_field(dict(bodies)) | None, None),
        **fields,
    )


def _named(table: type[TomlTable], noun: str, example: str, description: str) -> Any:
    """The type of tables of one kind by their names."""
    field = Field(description=description, json_schema_extra=_NAMED)
    return Annotated[dict[Name, table], few_named(noun, example), field]  # type: ignore[valid-type]  # made of a registry


def json_schema() -> str:
    """The JSON schema of a specification, with which editors complete and check TOML files."""
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", **specification_table().model_json_schema()}
    return json.dumps(_plain(schema), indent=2, ensure_ascii=False) + "\n"


def _plain(node: Any) -> Any:
    """A schema without the titles that pydantic adds and without null for optional keys."""
    if isinstance(node, list):
        return [_plain(item) for item in node]
    if isinstance(node, dict):
        kept = {k: v for k, v in node.items() if k not in ("title", "anyOf") and not (k == "default" and v is None)}
        options = [option for option in node.get("anyOf", []) if option != {"type": "null"}]
        several = {"anyOf": options} if len(options) > 1 else dict(*options)
        return {key: _plain(value) for key, value in {**several, **kept}.items()}
    return node
