"""Keys that the types of a registry declare, as fields of pydantic models: one table for all kinds of a section."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Protocol, assert_never

from pydantic import Field, PlainValidator, WithJsonSchema

from derive.mechanics.multibody.keys import QUANTITIES, Key, KeyType
from derive.spec.parsing import choices, values
from derive.spec.tables.markers import Axis, Float, MarkerInput, NameOf, Time, TwoMarkers
from derive.spec.tables.shared import (
    NotNegativeInput,
    Positive,
    QuantityInput,
    SignedInput,
    TomlTable,
    components,
    quantity,
)


class Declares(Protocol):
    """The declaration of the table of a registered type."""

    @property
    def doc(self) -> str:
        """The text that distinguishes the type from others of its section."""

    @property
    def keys(self) -> tuple[Key, ...]:
        """The keys that the type declares."""


def key_field(key: Key, required: bool = False) -> tuple[Any, Any]:
    """The annotation and the default of a key as a field of a pydantic model."""
    match key.type:
        case KeyType.FLOAT:
            annotation: Any = Float
        case KeyType.DIRECTION:
            annotation = Axis
        case KeyType.POSITIVE:
            annotation = Positive
        case KeyType.POSITIVE_QUANTITY:
            annotation = QuantityInput
        case KeyType.NOT_NEGATIVE_QUANTITY:
            annotation = NotNegativeInput
        case KeyType.QUANTITY:
            annotation = SignedInput
        case KeyType.FUNCTION:
            annotation = Time
        case KeyType.FUNCTION_PAIR:
            annotation = Annotated[tuple[Time, Time], components(("0", '"-10*sin(t)"'), "components")]
        case KeyType.MARKER | KeyType.BEAM_MARKER:
            annotation = MarkerInput
        case KeyType.MARKER_PAIR:
            annotation = TwoMarkers
        case KeyType.JOINT | KeyType.DRIVE | KeyType.SPRING:
            annotation = NameOf
        case KeyType.CHOICE:
            annotation = _choice(key)
        case _ as never:
            assert_never(never)
    field = Field(description=key.description)
    if required:
        return Annotated[annotation, field], ...
    if key.default is not None:
        return Annotated[annotation, field], key.default
    return Annotated[annotation | None, field], None


def _choice(key: Key) -> Any:
    return Annotated[
        str,
        PlainValidator(lambda value: choices.choice(value, key.choices, f"`{key.name}`")),
        WithJsonSchema({"enum": [*key.choices]}),
    ]


def key_value(key: Key, value: Any) -> Any:
    """The value of a key in the form that the derivation takes."""
    return quantity(value, key.unit) if key.type in QUANTITIES and value is not None else value


def key_values(keys: tuple[Key, ...], table: TomlTable) -> dict[str, Any]:
    """The values of those keys of a table that have one, in the form that the derivation takes."""
    of_keys = {key.name: key_value(key, getattr(table, key.name)) for key in keys}
    return {key: value for key, value in of_keys.items() if value is not None}


def kind_field(types: Mapping[str, Declares], element: str, default: Any = ...) -> tuple[Any, Any]:
    """The key `kind` of the table of an `element`, such as "the joint", with all kinds that are registered."""
    field = (
        PlainValidator(lambda value: choices.choice(value, tuple(types), element)),
        WithJsonSchema({"enum": [*types]}),
        Field(description=_kinds_text(types)),
    )
    return Annotated[(str, *field)], default


def fields_of_kinds(types: Mapping[str, Declares]) -> dict[str, Any]:
    """The keys of all kinds, each once; those that all kinds need are required.

    Raises ValueError where two kinds declare a key of one name with values of different types.
    """
    keys: dict[str, Key] = {}
    for kind, declaring in types.items():
        for key in declaring.keys:
            if keys.setdefault(key.name, key).type is not key.type:
                raise ValueError(f"{kind}: another kind declares the key {key.name} with values of another type")
    return {name: key_field(key, all(_needs(of, name) for of in types.values())) for name, key in keys.items()}


def _needs(declaring: Declares, name: str) -> bool:
    return any(key.name == name and key.required for key in declaring.keys)


def check_keys(table: TomlTable, kind: str, types: Mapping[str, Declares], noun: str) -> None:
    """Raise WrongValueError where the keys of a table do not go with its kind; `noun` is what an element is called."""
    own, element = {key.name for key in types[kind].keys}, noun if kind == noun else f"{kind} {noun}"
    for name in (name for name in fields_of_kinds(types) if name not in own):
        if name in table.model_fields_set and getattr(table, name) is not None:
            others = [f'"{other}"' for other, of in types.items() if name in {key.name for key in of.keys}]
            raise values.WrongValueError(f"a {element} has no {name}; leave `{name}` out, or choose {_either(others)}")
    for key in types[kind].keys:
        if key.required and getattr(table, key.name) is None:
            text = key.description[:1].lower() + key.description[1:].rstrip(".")
            raise values.WrongValueError(f"a {element} needs the key `{key.name}`: {text}")


def _kinds_text(types: Mapping[str, Declares]) -> str:
    """The description of all kinds, where kinds of the same type are listed together."""
    names: dict[Declares, list[str]] = {}
    for name, declaring in types.items():
        names.setdefault(declaring, []).append(name)
    return ", ".join(f"{' or '.join(of)} ({d.doc})" if d.doc else " or ".join(of) for d, of in names.items()) + "."


def _either(names: list[str]) -> str:
    return f"{', '.join(names[:-1])} or {names[-1]}" if len(names) > 1 else names[0]
