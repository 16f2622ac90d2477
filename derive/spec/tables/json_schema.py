"""The JSON schema of a specification, with which editors complete and check TOML files."""

from __future__ import annotations

import json
from typing import Any

from derive.artifacts import MARK
from derive.spec.tables.shared import TomlTable
from derive.spec.tables.spatial_scene import spatial_specification_table
from derive.spec.tables.specification import specification_table


def json_schema() -> str:
    """The JSON schema of all specifications: sections may have either form, and gears are of scenes in space alone."""
    planar, spatial = (schema_of(table) for table in (specification_table(), spatial_specification_table()))
    definitions = {**planar["$defs"], **spatial["$defs"]}
    for name, definition in spatial["$defs"].items():
        if planar["$defs"].get(name, definition) != definition:
            raise ValueError(f"two tables of the JSON schema are called {name}")
    properties = {name: _either(value, spatial["properties"].get(name)) for name, value in planar["properties"].items()}
    alone = {name: value for name, value in spatial["properties"].items() if name not in properties}
    needs = {**planar["dependentRequired"], **{name: ["bodies"] for name in alone}}
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$comment": f"{MARK}: the keys of specifications, for editors.",
        **planar,
        "dependentRequired": dict(sorted(needs.items())),
        "$defs": dict(sorted(definitions.items())),
        "properties": {**properties, **alone},
    }
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"


def schema_of(table: type[TomlTable]) -> Any:
    """The JSON schema of the specifications that one table describes, as plain data."""
    return _plain(table.model_json_schema())


SHARED = ("description", "default")
"""The keywords of a section that do not depend on its form."""


def _either(planar: Any, spatial: Any) -> Any:
    """The schema of a section in the plane or in space, with the description and the default of the first."""
    if spatial is None or spatial == planar:
        return planar
    shared = {key: planar[key] for key in SHARED if key in planar}
    forms = ({key: value for key, value in form.items() if key not in SHARED} for form in (planar, spatial))
    return {"anyOf": [*forms], **shared}


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
