"""Tables whose kinds are those of a registry, each with its own keys: one table for all kinds of a section."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Annotated, Any, Protocol

from pydantic import AfterValidator, Field, create_model

from derive.spec.model.keys import QUANTITIES, Key
from derive.spec.parsing import values
from derive.spec.tables.declared_tables import DeclaredTable, key_field, keyed_model
from derive.spec.tables.quantities import quantity
from derive.spec.tables.shared import Example, TomlTable, choice_type


class Declares(Protocol):
    """The declaration of the table of a registered type."""

    @property
    def doc(self) -> str:
        """The text that distinguishes the type from others of its section."""

    @property
    def keys(self) -> tuple[Key, ...]:
        """The keys that the type declares."""


Make = Callable[[str, Mapping[str, Any], dict[str, Any]], Any]
"""A function from the kind, the values of the keys of all kinds, and those of the keys of the kind to an element."""


@cache
def registered_table(
    title: str,
    doc: str,
    noun: str,
    types: tuple[tuple[str, Declares], ...],
    keys: tuple[Key, ...],
    make: Make,
    default: str | None = None,
) -> DeclaredTable:
    """The table of an element that has one of several kinds; `keys` are those of all kinds.

    noun: what an element is called in messages; default: the kind of an element that specifies none.
    """
    kinds = dict(types)
    described, example = Field(description=_kinds_text(kinds)), Example(f'kind = "{next(iter(kinds))}"')
    field: Any = Annotated[choice_type(tuple(kinds), f"the {noun}"), described, example]
    model = keyed_model(title, doc, keys, others={"kind": (field, ... if default is None else default)})
    model = create_model(title, __base__=model, __doc__=doc, **fields_of_kinds(kinds))

    def made(table: Any) -> Any:
        check_keys(table, table.kind, kinds, noun)
        own = {key.field: value for key in keys if (value := getattr(table, key.name)) is not None}
        return make(table.kind, own, key_values(kinds[table.kind].keys, table))

    return DeclaredTable(model, Annotated[model, AfterValidator(made)])


def key_values(keys: tuple[Key, ...], table: TomlTable) -> dict[str, Any]:
    """The values of those keys of a table that have one, in the form that the derivation takes."""
    given = ((key, value) for key in keys if (value := getattr(table, key.name)) is not None)
    return {key.name: quantity(value, key.unit) if key.type in QUANTITIES else value for key, value in given}


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
    every = dict.fromkeys(key.name for of in types.values() for key in of.keys)
    missing = [
        f"key `{key.name}`: {key.description[:1].lower()}{key.description[1:].rstrip('.')}"
        for key in types[kind].keys
        if key.required and getattr(table, key.name) is None
    ]
    for name in (name for name in every if name not in own):
        if name in table.model_fields_set and getattr(table, name) is not None:
            others = [f'"{other}"' for other, of in types.items() if name in {key.name for key in of.keys}]
            text = f"a {element} has no {name}; leave `{name}` out, or choose {_either(others)}"
            instead = f"; it needs the {missing[0]}" if missing else ""
            raise values.WrongValueError(text + instead)
    if missing:
        raise values.WrongValueError(f"a {element} needs the {missing[0]}")


def _kinds_text(types: Mapping[str, Declares]) -> str:
    """The description of all kinds, where kinds of the same type are listed together."""
    names: dict[Declares, list[str]] = {}
    for name, declaring in types.items():
        names.setdefault(declaring, []).append(name)
    return ", ".join(f"{' or '.join(of)} ({d.doc})" if d.doc else " or ".join(of) for d, of in names.items()) + "."


def _either(names: list[str]) -> str:
    return f"{', '.join(names[:-1])} or {names[-1]}" if len(names) > 1 else names[0]
