"""The place in a specification that an error of pydantic refers to: its path, its table and its key."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from derive.spec.parsing.faults import KeyPath


@dataclass(frozen=True)
class TablePlace:
    """A place in a specification.

    table: the model of the innermost table that holds it; field: the field of that table, if it is one; value: the
    model of the place itself, if it is a table.
    """

    path: KeyPath
    table: type[BaseModel]
    field: FieldInfo | None = None
    value: type[BaseModel] | None = None


def place(model: type[BaseModel], location: KeyPath) -> TablePlace:
    """The place at a location as pydantic gives it, which also names the alternatives of unions and ends in "[key]"."""
    definitions: dict[str, Any] = {}
    schema = _inner(model.__pydantic_core_schema__, definitions)
    path: KeyPath = ()
    table, field = model, None
    for part in location[:-1] if location[-1:] == ("[key]",) else location:
        if schema.get("type") == "tagged-union":
            schema = _inner(schema["choices"][part], definitions)
            continue
        path, field = (*path, part), None
        if schema.get("type") == "model":
            table, fields = schema["cls"], _inner(schema["schema"], definitions)["fields"]
            field = table.model_fields.get(str(part))
            schema = fields[part]["schema"] if part in fields else {}
        elif schema.get("type") == "dict":
            schema = schema["values_schema"]
        elif schema.get("type") == "tuple":
            items = schema["items_schema"]
            schema = items[min(int(part), len(items) - 1)]
        else:
            schema = {}
        schema = _inner(schema, definitions)
    return TablePlace(path, table, field, schema.get("cls"))


def _inner(schema: Mapping[str, Any], definitions: dict[str, Any]) -> Mapping[str, Any]:
    """The schema of a value without the functions around it, and with references replaced."""
    while schema.get("type") not in ("model", "model-fields", "dict", "tuple", "tagged-union"):
        if schema.get("type") == "definitions":
            definitions.update({definition["ref"]: definition for definition in schema["definitions"]})
        if schema.get("type") == "definition-ref":
            schema = definitions[schema["schema_ref"]]
        elif "schema" in schema:
            schema = schema["schema"]
        else:
            return schema
    return schema
