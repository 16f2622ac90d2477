"""Instances of a table with `count`: the key, their names, and the identifiers of names in generated code."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from derive.spec.model.keys import KeyType, key

COUNTED = ("bodies", "joints", "forces", "torques", "springs", "drives", "gears", "inputs", "outputs")
"""The sections whose tables may have a count."""

COUNT = key(
    KeyType.INSTANCE_COUNT,
    "Makes so many of them, NAME[0], NAME[1] and so on, with the index i in numbers and references of this table: "
    '"0.05 + 0.1*i", "link[i+1].left".',
    name="count",
    field="count",
)


def instance_name(table: str, index: int | str) -> str:
    """The name of an instance of a table."""
    return f"{table}[{index}]"


def identifier(*names: str) -> str:
    """The identifier of a name, or of several names that are joined: link_3 of link[3], link_3_left with a marker."""
    return joined(*names).replace("[", "_").replace("]", "")


def joined(*names: str) -> str:
    """A name for people, of several names: link[3]_phi of link[3] and phi. Empty names are left out."""
    return "_".join(filter(None, names))


def rate_name(name: str, dots: str) -> str:
    """The name of a time derivative for people: turndot of turn, turn[3]_dot of turn[3], with `dots` of dot."""
    return f"{name}{dots}" if instance_parts(name).index is None else joined(name, dots)


@dataclass(frozen=True)
class InstanceName:
    """A name in its parts: the table, the index, and what follows it; without an index all of it is `ending`."""

    table: str
    index: int | None
    ending: str


def instance_parts(name: str) -> InstanceName:
    """The parts of a name that a specification or `joined` gives an instance or a quantity of it."""
    match = INSTANCE.fullmatch(name)
    return InstanceName(match[1], int(match[2]), match[3] or "") if match else InstanceName("", None, name)


INSTANCE = re.compile(r"(\w+)\[(\d+)\](?:_(\w+))?")
NUMBER = re.compile(r"(\d+(?:\.\d+)?(?:e[+-]\d+)?)")


def skeleton(text: str) -> str:
    """A text without its numbers."""
    return NUMBER.sub("#", text)


def text_of_instances(texts: Sequence[str], first: int) -> str:
    """The text that describes those of successive instances, which differ in numbers: `link[i+1].left` of link[1].left.

    first: the index of the first instance. Numbers that the index does not give become dots.
    """
    split = [NUMBER.split(text) for text in texts]
    return "".join(_common([parts[k] for parts in split], first) for k in range(len(split[0])))


def _common(parts: Sequence[str], first: int) -> str:
    if all(part == parts[0] for part in parts):
        return parts[0]
    distances = {int(part) - index for index, part in enumerate(parts, first) if part.isdigit()}
    if len(distances) != 1 or not all(map(str.isdigit, parts)):  # also 1.1, 1.2 and 1.3, which are not 1.i
        return "..."
    (distance,) = distances
    return f"i{distance:+}" if distance else "i"
