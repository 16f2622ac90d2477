"""The part of JSON Schema that the schema of specifications uses; an unknown word is an error."""

from __future__ import annotations

import re

_SAID = {"$schema", "$comment", "$defs", "description", "title", "default", "discriminator"}
_TYPES = {
    "object": lambda v: isinstance(v, dict),
    "array": lambda v: isinstance(v, list),
    "string": lambda v: isinstance(v, str),
    "boolean": lambda v: isinstance(v, bool),
    "number": lambda v: isinstance(v, (int, float)) and not isinstance(v, bool),
    "integer": lambda v: isinstance(v, int) and not isinstance(v, bool),
}


def problems(value, schema, root, path=""):
    """Yield the faults of a value, a line each."""
    if schema is True:
        return
    if schema is False:
        yield f"{path}: nothing is allowed here"
        return
    for word, of in schema.items():
        if word not in _SAID:
            yield from _WORDS[word](value, of, schema, root, path)


def _fits(value, schema, root):
    return not list(problems(value, schema, root))


def _reference(value, of, schema, root, path):
    node = root
    for part in of.removeprefix("#/").split("/"):
        node = node[part]
    yield from problems(value, node, root, path)


def _type(value, of, schema, root, path):
    if not _TYPES[of](value):
        yield f"{path}: {value!r} is no {of}"


def _count(least, most):
    def check(value, of, schema, root, path):
        count = sum(_fits(value, one, root) for one in of)
        if not least <= count <= (most or count):
            yield f"{path}: {value!r} fits {count} of {len(of)}"

    return check


def _properties(value, of, schema, root, path):
    if isinstance(value, dict):
        for key in of.keys() & value.keys():
            yield from problems(value[key], of[key], root, f"{path}.{key}")


def _patterns(value, of, schema, root, path):
    if isinstance(value, dict):
        for key, one in value.items():
            for pattern, inner in of.items():
                if re.search(pattern, key):
                    yield from problems(one, inner, root, f"{path}.{key}")


def _additional(value, of, schema, root, path):
    for key in value if isinstance(value, dict) else ():
        known = key in schema.get("properties", {})
        if not known and not any(re.search(p, key) for p in schema.get("patternProperties", {})):
            yield from problems(value[key], of, root, f"{path}.{key}")


def _names(value, of, schema, root, path):
    for key in value if isinstance(value, dict) else ():
        yield from problems(key, of, root, f"{path}.{key}")


def _required(value, of, schema, root, path):
    if isinstance(value, dict):
        yield from (f"{path}.{key}: missing" for key in of if key not in value)


def _dependent(value, of, schema, root, path):
    for key, needed in of.items() if isinstance(value, dict) else ():
        if key in value:
            yield from _required(value, needed, schema, root, path)


def _items(value, of, schema, root, path):
    if isinstance(value, list):
        for i, one in enumerate(value[len(schema.get("prefixItems", [])) :]):
            yield from problems(one, of, root, f"{path}[{i}]")


def _first_items(value, of, schema, root, path):
    if isinstance(value, list):
        for i, (one, inner) in enumerate(zip(value, of, strict=False)):
            yield from problems(one, inner, root, f"{path}[{i}]")


def _limit(kind, holds):
    def check(value, of, schema, root, path):
        if _TYPES[kind](value) and not holds(value, of):
            yield f"{path}: {value!r} is beyond {of!r}"

    return check


def _equal(value, of, schema, root, path):
    if value != of:
        yield f"{path}: {value!r} is not {of!r}"


def _among(value, of, schema, root, path):
    if value not in of:
        yield f"{path}: {value!r} is none of {of!r}"


_WORDS = {
    "$ref": _reference,
    "type": _type,
    "anyOf": _count(1, None),
    "oneOf": _count(1, 1),
    "properties": _properties,
    "patternProperties": _patterns,
    "additionalProperties": _additional,
    "propertyNames": _names,
    "required": _required,
    "dependentRequired": _dependent,
    "items": _items,
    "prefixItems": _first_items,
    "const": _equal,
    "enum": _among,
    "pattern": _limit("string", lambda v, of: re.search(of, v)),
    "minLength": _limit("string", lambda v, of: len(v) >= of),
    "maxLength": _limit("string", lambda v, of: len(v) <= of),
    "minimum": _limit("number", lambda v, of: v >= of),
    "maximum": _limit("number", lambda v, of: v <= of),
    "exclusiveMinimum": _limit("number", lambda v, of: v > of),
    "exclusiveMaximum": _limit("number", lambda v, of: v < of),
    "minItems": _limit("array", lambda v, of: len(v) >= of),
    "maxItems": _limit("array", lambda v, of: len(v) <= of),
    "minProperties": _limit("object", lambda v, of: len(v) >= of),
    "maxProperties": _limit("object", lambda v, of: len(v) <= of),
}
