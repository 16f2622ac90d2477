"""Tables of frozen types that declare their keys: pydantic models that read, check and document them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, fields, replace
from functools import partial
from types import MappingProxyType
from typing import Annotated, Any

from pydantic import AfterValidator, Field, create_model

from derive.spec.model.documentation import purpose
from derive.spec.model.instances import COUNT
from derive.spec.model.keys import QUANTITIES, Key, KeyType, declared_keys, has_name
from derive.spec.tables.quantities import quantity
from derive.spec.tables.shared import ElementName, Example, Name, TomlTable, by_name, choice_type, plain_or_table
from derive.spec.tables.value_types import VALUE_TYPES


@dataclass(frozen=True)
class DeclaredTable:
    """The table of a frozen type: its pydantic model, and the pydantic type of a value that such a table describes."""

    model: type[TomlTable]
    value: Any


TABLES: dict[type, DeclaredTable] = {}
"""The tables of the frozen types that are values of keys."""


def declare(
    of: type,
    title: str,
    *,
    keys: tuple[Key, ...] | None = None,
    make: Callable[..., Any] | None = None,
    check: Callable[[Any], None] | None = None,
    plain: Any = None,
    doc: str | None = None,
    base: type[TomlTable] = TomlTable,
    tables: Mapping[type, DeclaredTable] = TABLES,
) -> DeclaredTable:
    """The table of a frozen type, which is named `title` in the JSON schema.

    keys: by default those that the type declares. make: the function from the values of keys to the type, in place of
    the type itself. check: a function that raises WrongValueError where values do not go together. plain: the type of
    another notation than a table. doc: the description, by default the docstring of the type. base: the model with
    another configuration. tables: those of the frozen types that are values of keys; the first table that is declared
    of a type is in TABLES. A value with a name gets it from the key under which its table stands, see `named`.
    """
    own = declared_keys(of) if keys is None else keys
    model = keyed_model(title, doc or purpose(of), own, base, tables)
    unnamed = {"name": ""} if has_name(of) else {}
    names = {field.name for field in fields(of)}
    without_default = {field.name for field in fields(of) if field.default is MISSING}

    def made(table: TomlTable) -> Any:
        values = {key.field: getattr(table, key.name) for key in own if make or key.field in names}
        given = {name: value for name, value in values.items() if value is not None or name in without_default}
        result = (make or of)(**unnamed, **given)
        if check is not None:
            check(result)
        return result

    value: Any = Annotated[model, AfterValidator(made)]
    if plain is not None:
        value = plain_or_table(plain, value)
    table = DeclaredTable(model, value)
    TABLES.setdefault(of, table)
    return table


def keyed_model(
    title: str,
    doc: str | None,
    keys: tuple[Key, ...],
    base: type[TomlTable] = TomlTable,
    tables: Mapping[type, DeclaredTable] = TABLES,
    others: Mapping[str, Any] = MappingProxyType({}),
) -> type[TomlTable]:
    """The pydantic model of a table with some keys, behind `others`, which are fields with annotations and defaults."""
    fields: dict[str, Any] = {**others, **{key.name: key_field(key, key.required, tables) for key in keys}}
    return create_model(title, __base__=base, __doc__=doc, **fields)


def named(table: Any, noun: str, example: str, names: Any = Name, **schema: Any) -> Any:
    """The type of values by their names, as a sequence of values with names."""

    def made(values: Mapping[str, Any]) -> tuple[Any, ...]:
        return tuple(replace(value, name=name) for name, value in values.items())

    return Annotated[by_name(table, noun, example, names, **schema), AfterValidator(made)]


def key_field(key: Key, required: bool = False, tables: Mapping[type, DeclaredTable] | None = None) -> tuple[Any, Any]:
    """The annotation and the default of a key as a field of a pydantic model.

    tables: those of frozen types, for a key of such a type; the value of its field is then read to the last, so that
    a parameter has the unit of the key.
    """
    value = value_type(key, tables or {})
    if tables is not None and key.type in QUANTITIES:
        value = Annotated[value, AfterValidator(partial(quantity, unit=key.unit))]
    if not required and key.default is None:
        value = value | None
    field = Field(description=key.description or None, json_schema_extra=_shown(key))
    example = Example(f"{key.name} = {key.example or '1.0'}", key.example if isinstance(key.type, type) else "")
    return Annotated[value, field, example], ... if required else key.default


def _shown(key: Key) -> dict[str, Any] | None:
    """The default in the JSON schema, if it is not the value as it is; tables are empty by default."""
    if key.shown is not None:
        return {"default": key.shown}
    return {"default": {}} if (key.has_names or isinstance(key.type, type)) and key.default is not None else None


def value_type(key: Key, tables: Mapping[type, DeclaredTable]) -> Any:
    """The pydantic type of the value of a key."""
    if key.type is KeyType.CHOICE:
        return choice_type(key.choices, key.choice_of or f"`{key.name}`")
    if isinstance(key.type, KeyType):
        return VALUE_TYPES[key.type]
    table = tables[key.type]
    if not has_name(key.type):
        return table.value
    names = ElementName if COUNT.name in table.model.model_fields else Name
    return named(table.value, key.name, key.example, names)
