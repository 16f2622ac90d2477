"""Docstrings of frozen types: the keys that their fields declare are described once, where they are declared."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterable, Iterator
from dataclasses import fields
from itertools import takewhile
from textwrap import fill, indent
from typing import TypeVar

from derive.spec.model.keys import Key, declared_keys

T = TypeVar("T", bound=type)
WIDTH = 100
SECTIONS = ("Arguments", "Attributes", "Returns", "Raises", "Examples")
"""The sections of a docstring in their order."""


def documented(of: T) -> T:
    """A frozen type whose docstring describes its keys among the attributes, and whose signature does not repeat them.

    The docstring is made when it is read, so that an import does not pay for it.
    """
    setattr(of, "__doc__", _Documentation(of.__doc__ or ""))  # noqa: B010  its declared type is that of a text
    annotations = vars(of)["__init__"].__annotations__
    annotations.update({name: _without_key(annotation) for name, annotation in annotations.items()})
    return of


class _Documentation:
    """The docstring of a frozen type, with a line on each key in the section `Attributes`."""

    def __init__(self, text: str) -> None:
        self.text = text

    def __get__(self, instance: object, of: type) -> str:
        text = inspect.cleandoc(self.text)
        names = {field.name for field in fields(of)}
        keys = (key for key in declared_keys(of) if key.field in names and key.description)
        return with_entries(text, "Attributes", key_entries(keys, by_field=True))


def _without_key(annotation: object) -> object:
    """The type in an annotation such as "Annotated[Quantity, key(...)]"."""
    if isinstance(annotation, str) and annotation.startswith("Annotated["):
        match ast.parse(annotation, mode="eval").body:
            case ast.Subscript(slice=ast.Tuple([of, *_])):
                return ast.unparse(of)
    return annotation


def purpose(of: type) -> str:
    """The docstring of a frozen type before its sections, which describes its table in the schema as well."""
    text = of.__dict__["__doc__"]
    return _before_sections(inspect.cleandoc(text.text if isinstance(text, _Documentation) else text))


def _before_sections(docstring: str) -> str:
    heads = tuple(f"{name}:\n" for name in SECTIONS)
    blocks = docstring.split("\n\n")
    return "\n\n".join(takewhile(lambda block: not block.startswith(heads), blocks))


def key_entries(keys: Iterable[Key], by_field: bool = False) -> Iterator[tuple[str, str]]:
    """The name of each key, or of its field, and the lines that describe it."""
    for key in keys:
        name = key.field if by_field else key.name
        yield name, fill(f"{name}: {key.description}", WIDTH, subsequent_indent="    ")


def with_entries(docstring: str, section: str, entries: Iterable[tuple[str, str]]) -> str:
    """A docstring with entries at the end of a section, which is made if it is missing.

    docstring: without indentation. entries: names and lines; those whose names the section describes are left out.
    """
    blocks = docstring.split("\n\n")
    heads = [block.partition("\n")[0] for block in blocks]
    following = [f"{name}:" for name in SECTIONS[SECTIONS.index(section) + 1 :]]
    if f"{section}:" in heads:
        place = heads.index(f"{section}:")
        first = blocks.pop(place)
    else:
        place = next((i for i, head in enumerate(heads) if head in following), len(blocks))
        first = f"{section}:"
    described = {line.strip().partition(":")[0] for line in first.splitlines()[1:]}
    added = [indent(text, "    ") for name, text in entries if name not in described]
    if not added and first == f"{section}:":
        return docstring
    blocks.insert(place, "\n".join((first, *added)))
    return "\n\n".join(blocks)
