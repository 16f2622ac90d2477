"""`tisserand schema`: print the JSON schema of specifications, or the reference in Markdown that is made from it."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from derive.spec.tables.json_schema import json_schema

Schema = Mapping[str, Any]

INTRODUCTION = """\
# Reference of the TOML keys

This page is generated from the JSON schema of specifications by `tisserand schema --markdown`.

A specification is a TOML file with a `name` and either a planar beam, `[beam]`, or a body in space, `[body]`, or a
scene of bodies, `[bodies.NAME]`, with joints, drives and forces. A scene whose vectors have three components is one in
space; sections with two forms are then those in space. Where a *number* is expected, an exact number in quotation
marks, such as `"1/3"`, or a formula of numbers, such as `"pi/2"` or `"sqrt(2)/4"`, is accepted as well. A marker is
written `"body.marker"`. Units are SI units. Editors complete and check these keys if the first line of the file is
`#:schema schema.json`, with the path of `scenes/schema.json`.
"""
TITLES = {
    "NodalTable": "`[body]` given by nodes",
    "SymbolicTable": "`[body]` with symbolic integrals",
    "RigidTable": "`[bodies.NAME]`, a rigid body",
    "SpatialGroundTable": "`[ground]` in space",
    "SpatialSceneTable": "`[scene]` in space",
    "SpatialRigidTable": "`[bodies.NAME]`, a rigid body in space",
    "SpatialJointTable": "`[joints.NAME]` in space",
    "SpatialInitialValuesTable": "Initial values of a body in space",
    "SpatialBeamStartTable": "Initial values of a beam in space",
    "FrameMarkerTable": "Marker frame",
    "VisualTable": "Visual of a rigid body or of the ground",
    "UnitsTable": "Units of files of nodes",
    "ModeSelectionTable": "Error that selects the modes of a finite-element body",
    "BodyFrameTable": "Frame of a finite-element body",
    "DampingTable": "Damping of a finite-element body",
    "SpatialForceTable": "`[forces.NAME]` in space",
    "SpatialTorqueTable": "`[torques.NAME]` in space",
    "SpatialJointForceTable": "`[forces.NAME]` in a joint in space",
    "SpatialJointTorqueTable": "`[torques.NAME]` in a joint in space",
    "SpatialSpringTable": "`[springs.NAME]` in space",
    "SpatialBushingTable": "`[springs.NAME]`, a bushing in space",
    "SpatialOutputTable": "`[outputs.NAME]` in space",
    "FlexibleTable": "`[bodies.NAME]`, a finite-element body in space",
    "NodeFrameTable": "Marker at nodes",
    "NodalLoadTable": "Load on nodes of a finite-element body",
    "RotationTable": "Rotation about an axis",
    "AxesTable": "Rotation by axes",
    "AnglesTable": "Rotation by angles",
    "BeamBodyTable": "`[bodies.NAME]`, a beam",
    "FrameTable": "Frame of a beam",
    "ShapeFamilyTable": "Family of shape functions",
    "AxialTable": "Stretching of a beam",
    "BeamDampingTable": "Damping of a beam",
    "AttachedMassTable": "Attached mass",
    "StartTable": "Initial values of a body",
    "BeamStartTable": "Initial values of a beam",
    "JointStartTable": "Initial values of a joint or a drive",
    "SpatialJointStartTable": "Initial values of a joint in space",
    "PlotTable": "`[plots.NAME]` of a deflection",
    "ColumnPlotTable": "`[plots.NAME]` of columns",
    "ParameterTable": "Parameter",
    "SignedTable": "Signed parameter",
    "NotNegativeTable": "Non-negative parameter",
    "NonzeroTable": "Parameter that is not zero",
}
"""Headings of the definitions that several keys refer to, or that share a key with another definition."""


@dataclass
class KeySection:
    """A table of the specification: its schema, its heading, and the keys that hold it."""

    schema: Schema
    heading: str
    paths: list[str]

    @property
    def link(self) -> str:
        """A link to the section, as GitHub makes its anchor."""
        anchor = "".join(c for c in self.heading.lower().replace(" ", "-") if c.isalnum() or c in "-_")
        return f"[{self.heading[:1].lower() + self.heading[1:]}](#{anchor})"


def run(options: argparse.Namespace) -> int:
    """Print the schema as JSON or as Markdown."""
    print(markdown(json_schema()) if options.markdown else json_schema(), end="")
    return 0


def markdown(text: str) -> str:
    """Return the reference of a JSON schema, given as text."""
    schema = json.loads(text)
    sections = _sections(schema)
    parts = [INTRODUCTION, "## Top level\n", _table(schema, sections)]
    for section in sections.values():
        parts += [f"## {section.heading}\n", f"{section.schema['description']}\n"]
        if len(section.paths) > 1:
            parts.append(f"Used by {', '.join(f'`{path}`' for path in dict.fromkeys(section.paths))}.\n")
        parts.append(_table(section.schema, sections))
    return "\n".join(parts)


def _sections(schema: Schema) -> dict[str, KeySection]:
    """Return the definitions of a schema by their references, in the order in which the keys mention them."""
    sections: dict[str, KeySection] = {}
    pending = [("", schema)]
    while pending:
        path, table = pending.pop(0)
        for key, value in table.get("properties", {}).items():
            for reference, named in _references(value):
                name = reference.removeprefix("#/$defs/")
                here = ".".join(part for part in (path, key, "NAME" if named else "") if part)
                if reference not in sections:
                    sections[reference] = KeySection(schema["$defs"][name], TITLES.get(name, f"`[{here}]`"), [])
                    pending.append((here, schema["$defs"][name]))
                sections[reference].paths.append(here)
    shared = [s for s in sections.values() if len(set(s.paths)) > 1 and s.heading not in TITLES.values()]
    if shared:
        raise ValueError(f"add titles of these tables to {__name__}.TITLES: {[section.paths for section in shared]}")
    return sections


def _references(value: Any, named: bool = False) -> Iterator[tuple[str, bool]]:
    """Yield the definitions that a value refers to, and whether their names are free, as in `[joints.NAME]`."""
    if isinstance(value, list):
        for item in value:
            yield from _references(item, named)
    elif isinstance(value, dict):
        if "$ref" in value:
            yield value["$ref"], named
        for key, item in value.items():
            yield from _references(item, named or key == "patternProperties")


def _table(schema: Schema, sections: Mapping[str, KeySection]) -> str:
    """Return the keys of a table as a Markdown table."""
    rows = ["| key | value | default | meaning |", "|---|---|---|---|"]
    for key, value in schema["properties"].items():
        default = "required" if key in schema.get("required", ()) else _default(value)
        rows.append(f"| `{key}` | {_type(value, sections)} | {default} | {value.get('description', '')} |")
    return "\n".join(rows) + "\n"


def _default(value: Schema) -> str:
    """Return the default of a key as TOML, or nothing if omitting the key has a meaning of its own."""
    if "default" not in value or "$ref" in value or value["default"] == {}:
        return ""
    return f"`{_toml(value['default'])}`"


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value)


def _type(value: Schema, sections: Mapping[str, KeySection]) -> str:
    """Return what a value may be, in words, with links to the sections of tables."""
    if "$ref" in value:
        return sections[value["$ref"]].link
    if "enum" in value:
        return " or ".join(f"`{json.dumps(item)}`" for item in value["enum"])
    if "const" in value:
        return f"`{json.dumps(value['const'])}`"
    for union in ("anyOf", "oneOf"):
        if union in value and "type" not in value:
            options = list(dict.fromkeys(_type(option, sections) for option in value[union]))
            exact = any("exact number" in option.get("description", "") for option in value[union])
            return "number" if exact else " or ".join(options)
    if "patternProperties" in value:
        (item,) = value["patternProperties"].values()
        return f"by name: {_type(item, sections)}"
    match value["type"]:
        case "array" if "prefixItems" in value:
            items = [_type(item, sections) for item in value["prefixItems"]]
            return f"array of {len(items)}: {items[0]}"
        case "array":
            return f"array of {_type(value['items'], sections)}"
        case "object":
            return "table"
        case "boolean":
            return "`true` or `false`"
        case name:
            return str(name)
