"""The base of all tables, names, and lists and tables of a limited length, as pydantic types."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import or_
from typing import Annotated, Any

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    GetJsonSchemaHandler,
    PlainValidator,
    Tag,
    WithJsonSchema,
)
from pydantic_core import CoreSchema

from derive.spec.parsing import choices, values
from derive.spec.parsing.names import INDEX_PATTERN
from derive.spec.parsing.names import MAX_LENGTH as MAX_NAME
from derive.spec.parsing.names import PATTERN as NAME_PATTERN
from derive.spec.parsing.polynomial import MAX_LENGTH
from derive.spec.parsing.scene_values import MAX_INSTANCES

MAX_MARKERS = 64
MAX_NAMED = MAX_INSTANCES


class TomlTable(BaseModel):
    """A table in which every key is known."""

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)


class SchemaExtra:
    """Entries that are added to the JSON schema of a value."""

    def __init__(self, **entries: Any) -> None:
        self.entries = entries

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """The JSON schema of the value with the entries."""
        return {**handler(core), **self.entries}


@dataclass(frozen=True)
class Example:
    """An example of a key that is missing, for messages; `value` is that of a table, also where the key is there."""

    text: str
    value: str = ""


Name = Annotated[
    str,
    PlainValidator(values.name),
    WithJsonSchema({"type": "string", "pattern": f"^{NAME_PATTERN}$", "maxLength": MAX_NAME}),
]


ElementName = Annotated[
    str,
    PlainValidator(values.element_name),
    WithJsonSchema({"type": "string", "pattern": f"^{NAME_PATTERN}({INDEX_PATTERN})?$"}),
]
"""The type of the name of an element of which there may be several instances."""


def few(count: int, least: int, most: int, noun: str) -> None:
    """Refuse a number of elements that is not allowed, before the elements are validated one by one."""
    if not least <= count <= most:
        raise values.WrongValueError(f"there are {count} {noun}, and {least} to {most} are allowed")


def by_name(table: Any, noun: str, example: str, names: Any = Name, **schema: Any) -> Any:
    """The type of a limited number of tables by their names; `example` is the header of one, for messages."""

    def check(value: object) -> object:
        if not isinstance(value, Mapping):
            raise values.WrongValueError(
                f"a table of {noun} by their names is needed, such as {example}, not {values.kind_of(value)}"
            )
        few(len(value), 0, MAX_NAMED, noun)
        return value

    limits = SchemaExtra(**schema, maxProperties=MAX_NAMED, additionalProperties=False)
    return Annotated[dict[names, table], BeforeValidator(check), limits]


def choice_type(words: tuple[str, ...], noun: str) -> Any:
    """The type of one of several words; `noun` names it in messages."""
    return Annotated[
        str,
        PlainValidator(lambda value: choices.choice(value, words, noun)),
        WithJsonSchema({"enum": [*words]}),
    ]


def components(example: Sequence[str], noun: str = "components") -> BeforeValidator:
    """A validator of a list with as many elements as the example."""

    def check(value: object) -> object:
        if not isinstance(value, (list, tuple)) or len(value) != len(example):
            given = f"{len(value)}" if isinstance(value, (list, tuple)) else values.kind_of(value)
            raise values.WrongValueError(
                f"a list of {len(example)} {noun} is needed, such as [{', '.join(example)}], not {given}"
            )
        return tuple(value)

    return BeforeValidator(check)


def number_schema(**limits: float) -> dict[str, Any]:
    """The JSON schema of a number."""
    exact = {"type": "string", "maxLength": MAX_LENGTH, "description": 'An exact number, such as "1/3".'}
    return {"anyOf": [{"type": "number", **limits}, exact]}


def one_of(kind: Callable[[Any], str], **types: Any) -> Any:
    """The type of a value of one of several types; `kind` is the function from a value to the name of its type."""
    options: list[Any] = [Annotated[of, Tag(name)] for name, of in types.items()]
    return Annotated[reduce(or_, options), Discriminator(kind)]


def plain_or_table(plain: Any, table: Any) -> Any:
    """The type of a value with two notations, of which one is a table."""
    return one_of(_notation, plain=plain, table=table)


def _notation(value: Any) -> str:
    return "table" if isinstance(value, Mapping) else "plain"
