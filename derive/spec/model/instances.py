"""Instances of a table with `count`: the key, their names, and the identifiers of names in generated code."""

from __future__ import annotations

from derive.spec.model.keys import KeyType, key

COUNTED = ("bodies", "joints", "forces", "torques", "springs", "outputs")
"""The sections whose tables may have a count."""

COUNT = key(
    KeyType.INSTANCE_COUNT,
    "Makes so many of them, NAME[0], NAME[1] and so on, with the index i in numbers and references of this table: "
    '"0.05 + 0.1*i", "link[i+1].left".',
    name="count",
    field="count",
)


def instance_name(table: str, index: int) -> str:
    """The name of an instance of a table."""
    return f"{table}[{index}]"


def identifier(*names: str) -> str:
    """The identifier of a name, or of several names that are joined: link_3 of link[3], link_3_left with a marker."""
    return "_".join(filter(None, names)).replace("[", "_").replace("]", "")
