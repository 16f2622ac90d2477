"""Which keys, words and forms of values the JSON schema of specifications has, and which of them a scene uses.

A feature is a text such as "BeamBodyTable.pieces" (a key), "FrameTable.kind = tangent" (a word), or "DriveTable.speed
as SignedTable" (a form of a value that may have several). The schema follows the registries, so that a new kind of
joint, force or output is a feature at once.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

Schema = dict[str, Any]
TYPES: dict[str, tuple[type, ...]] = {
    "object": (dict,),
    "array": (list,),
    "string": (str,),
    "boolean": (bool,),
    "number": (int, float),
    "integer": (int,),
}


def all_features(root: Schema) -> set[str]:
    """All features of the schema."""
    found: set[str] = set()
    _collect(root, root, "", found, set())
    return found


def features(tables: Any, root: Schema) -> Iterator[str]:
    """The features that a specification uses, some of them several times."""
    yield from _used(tables, root, root, "")


def _collect(schema: Any, root: Schema, path: str, found: set[str], seen: set[str]) -> None:
    if not isinstance(schema, dict):
        return
    if name := _reference(schema):
        if name not in seen:
            seen.add(name)
            _collect(root["$defs"][name], root, name, found, seen)
        return
    for key, inner in schema.get("properties", {}).items():
        found.add(_join(path, key))
        _collect(inner, root, _join(path, key), found, seen)
    found.update(f"{path} = {word}" for word in _words(schema))
    for branch in _branches(schema):
        found.add(f"{path} as {_label(branch)}")
        _collect(branch, root, path, found, seen)
    for inner in _members(schema):
        _collect(inner, root, path, found, seen)


def _used(value: Any, schema: Any, root: Schema, path: str) -> Iterator[str]:
    if not isinstance(schema, dict):
        return
    if name := _reference(schema):
        yield from _used(value, root["$defs"][name], root, name)
        return
    for key, inner in _own_children(value, schema):
        known = key in schema.get("properties", {})
        if known:
            yield _join(path, key)
        yield from _used(value[key], inner, root, _join(path, key) if known else path)
    yield from (f"{path} = {word}" for word in _words(schema) if word == _word(value))
    for branch in _branches(schema):
        if fits(value, branch, root):
            yield f"{path} as {_label(branch)}"
            yield from _used(value, branch, root, path)


def children(value: Any, schema: Any, root: Schema) -> Iterator[tuple[Any, Schema]]:
    """The keys of a table, or the indices of a list, with the schemas of what is there."""
    if not isinstance(schema, dict):
        return
    if name := _reference(schema):
        schema = root["$defs"][name]
    yield from _own_children(value, schema)
    for branch in _branches(schema):
        if fits(value, branch, root):
            yield from children(value, branch, root)


def _own_children(value: Any, schema: Schema) -> Iterator[tuple[Any, Schema]]:
    if isinstance(value, dict):
        known = schema.get("properties", {})
        named = [*schema.get("patternProperties", {}).values()]
        for key in value:
            for inner in [known[key]] if key in known else named:
                yield key, inner
    if isinstance(value, list):
        first = schema.get("prefixItems", [])
        for i in range(len(value)):
            if i < len(first) or "items" in schema:
                yield i, first[i] if i < len(first) else schema["items"]


def _reference(schema: Schema) -> str | None:
    reference = schema.get("$ref")
    return str(reference).rsplit("/", 1)[-1] if reference else None


def _join(path: str, key: str) -> str:
    return f"{path}.{key}" if path else key


def _word(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _words(schema: Schema) -> list[str]:
    """The values that are listed; both truths of a boolean."""
    words = [_word(word) for word in schema.get("enum", [schema["const"]] if "const" in schema else [])]
    return words + (["true", "false"] if schema.get("type") == "boolean" else [])


def _branches(schema: Schema) -> list[Schema]:
    """The forms that a value may have; lists of required keys are none."""
    options = [*schema.get("oneOf", []), *schema.get("anyOf", [])]
    return [option for option in options if "required" not in option]


def _members(schema: Schema) -> list[Any]:
    items = [schema["items"]] if "items" in schema else []
    return [*schema.get("prefixItems", []), *items, *schema.get("patternProperties", {}).values()]


def _label(branch: Schema) -> str:
    if name := _reference(branch):
        return name
    if "enum" in branch or "const" in branch:
        return "word"
    if inner := _branches(branch):
        return " or ".join(_label(each) for each in inner)
    return str(branch.get("type"))


def fits(value: Any, schema: Schema, root: Schema) -> bool:
    """Whether a value has the form that a schema describes, as far as that tells it from other forms."""
    if name := _reference(schema):
        schema = root["$defs"][name]
    if "enum" in schema or "const" in schema:
        return _word(value) in _words(schema)
    if inner := _branches(schema):
        return any(fits(value, branch, root) for branch in inner)
    of_type = isinstance(value, TYPES[schema["type"]]) and isinstance(value, bool) == (schema["type"] == "boolean")
    if not of_type or not isinstance(value, dict):
        return of_type
    known = value.keys() <= schema.get("properties", {}).keys()
    return known and {*schema.get("required", [])} <= value.keys()
