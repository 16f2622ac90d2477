"""The keys that a joint or a body declares for its table in a specification, as plain data."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class KeyType(Enum):
    """What the value of a key is; the specification layer reads, checks and documents it accordingly."""

    FLOAT = "a number, kept as a double"
    DIRECTION = "two components of a direction, exact, not both zero"
    POSITIVE = "a positive number, exact"
    POSITIVE_QUANTITY = "a positive number, or a run-time parameter of the generated code"


@dataclass(frozen=True)
class Key:
    """A key of a table: its name, what its value is, its unit (that of a parameter), and what an editor shows of it.

    A key that is not `required` may be left out; then the element has no value of that name, or its own default.
    """

    name: str
    type: KeyType
    unit: str
    description: str
    required: bool = False


def quantities(keys: tuple[Key, ...]) -> dict[str, str]:
    """The keys that may be run-time parameters, with their units."""
    return {key.name: key.unit for key in keys if key.type is KeyType.POSITIVE_QUANTITY}
